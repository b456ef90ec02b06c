"""Members recognised by their shape: what the member-based and the member-extrapolated pipeline share.

Fine 2015, section 2.3.1: the scan is split into segments by the distance between consecutive readings, each is
time-warped to an equal number of readings and compared with the database of members. The readings of an accepted
segment are the foreground; every other segment is background, and its nearest point an obstacle.

Where it must fail: members that touch side by side or stand in front of a wall nearer than the splitting
distance are one segment with it and rejected (false negatives); a piece of wall, box or post of a member's width is
accepted (false positives), the more so the farther it stands, where noise is as large as the arc is deep.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Annotated, Any, NamedTuple

import mujoco
import numpy as np

from flocking.compilation import borrowing
from flocking.parameters import Parameter
from flocking.types import Floats, Ints, Members, Obstacles, unknown
from sensing.shapes.segments import beam_directions, laser_mount, shape_of, split
from sensing.shapes.templates import group_at, make_templates
from sensing.shapes.warping import nearest_shape, warp_rows
from sensing.types import NOBODY, Detection

SAMPLES, BAND = 8, 1
"""Samples to which each segment is resampled, and samples by which the warping may run ahead. Neither is published;
`python -m scripts.calibrate_detection` compares some. The fewer samples, the more readings each of them averages, and
the less of their noise remains; after even resampling there is little left to warp."""

FINE_RAD = 0.005
"""Angle between the beams of which the templates are made where a scan has but one beam."""


class Parameters(NamedTuple):
    """What decides which segments are members; not published, so chosen on data of our own.

    The defaults belong to the data-sheet setting of the laser. The same script gives 0.03 and 0.024 m for the ideal
    one, and 0.15 and 0.041 m for the harsh one, where the defaults would let whole members fall to pieces.
    """

    # plausible: what the calibration gives from the ideal laser to the harsh one
    split_m: Annotated[
        float, Parameter("m", "chosen: python -m scripts.calibrate_detection", low=0.0, plausible=(0.03, 0.15))
    ] = 0.05
    """Consecutive readings further apart than this belong to different segments; beyond 1 m in proportion to range."""
    threshold_m: Annotated[
        float, Parameter("m", "chosen: python -m scripts.calibrate_detection", low=0.0, plausible=(0.024, 0.041))
    ] = 0.0305
    """A segment is a member if its warping cost is at most this."""


class Scratch(NamedTuple):
    """Arrays that every scan of B beams writes over, of whichever robot."""

    points: Floats
    """(B, 2) this and the next two as `segments.split` fills them."""
    readings: Ints
    """(B,)."""
    starts: Ints
    """(B + 1,)."""
    kept: Ints
    """(B + 1,) segments that are members from its start on, those that are obstacles from its end backwards."""
    shape: Floats
    """(S, 2) of the segment at hand, m."""
    rows: Floats
    """Of the warping."""
    positions: Floats
    """(B, 2) of the inputs, m."""
    bearings: Floats
    """(B,) of the inputs, rad."""
    obstacles: Floats
    """(B, 2) m."""


class Recogniser(NamedTuple):
    """The parameters, the database, and the arrays of `Scratch`.

    Compiled code takes it as a plain tuple and names its fields again: from Python a named tuple takes Numba longer.
    """

    split_m: float
    threshold_m: float
    band: int
    mount_x: float
    mount_y: float
    directions: Floats
    """(B, 2) of the beams."""
    templates: Floats
    """(K, S, 2) m; these and the next two as in `Templates`."""
    groups: Ints
    """(D + 1,)."""
    limits_m: Floats
    """(D − 1,)."""
    points: Floats
    """This and what follows as in `Scratch`."""
    readings: Ints
    starts: Ints
    kept: Ints
    shape: Floats
    rows: Floats
    positions: Floats
    bearings: Floats
    obstacles: Floats


def recogniser(
    parameters: Parameters,
    member_model: mujoco.MjModel,
    member_height_m: float,
    angles: Floats,
    samples: int = SAMPLES,
    band: int = BAND,
) -> Recogniser:
    """For scans with beams at `angles` (B,) rad and members like the robot in `member_model`.

    Raises InputError where that robot has no laser, or nothing at the laser's height.
    """
    beams = len(angles)
    mount_x, mount_y, yaw = laser_mount(member_model)
    step_rad = float(np.median(np.diff(angles))) if beams > 1 else FINE_RAD
    templates = make_templates(member_model, member_height_m, step_rad, samples, band)
    return Recogniser(
        float(parameters.split_m),
        float(parameters.threshold_m),
        band,
        mount_x,
        mount_y,
        beam_directions(angles, yaw),
        templates.shapes,
        templates.starts,
        templates.limits_m,
        **_scratch(beams, samples)._asdict(),
    )


@cache
def _scratch(beams: int, samples: int) -> Scratch:
    """One for all robots of a process, so that it stays in the processor's cache."""
    return Scratch(
        points=np.zeros((beams, 2)),
        readings=np.zeros(beams, np.int64),
        starts=np.zeros(beams + 1, np.int64),
        kept=np.zeros(beams + 1, np.int64),
        shape=np.zeros((samples, 2)),
        rows=warp_rows(samples),
        positions=np.zeros((beams, 2)),
        bearings=np.zeros(beams),
        obstacles=np.zeros((beams, 2)),
    )


def recognise(ranges: Floats, state: Recogniser, average: bool) -> Detection:
    """The members in `ranges` (B,) m: one input each (`average`), or one for each of their readings."""
    beams = np.empty(len(ranges), np.int64)
    inputs, obstacles = _recognise(tuple(state), ranges, average, beams)
    positions, bearings = state.positions[:inputs].copy(), state.bearings[:inputs].copy()
    points = state.obstacles[:obstacles].copy()
    return Detection(Members(positions, bearings, *unknown(inputs)), Obstacles(points), beams)


@borrowing
def _recognise(recogniser: tuple[Any, ...], ranges: Floats, average: bool, beams: Ints) -> tuple[int, int]:
    """How many inputs and obstacles there are: fills their rows of the scratch arrays, and `beams` (B,)."""
    the = Recogniser(*recogniser)
    points, readings, starts, kept = the.points, the.readings, the.starts, the.kept
    segments, _ = split(ranges, the.directions, the.mount_x, the.mount_y, the.split_m, points, readings, starts)
    members, foreground = 0, 0
    for s in range(segments):
        start, end = starts[s], starts[s + 1]
        distance = shape_of(points, readings, start, end, the.mount_x, the.mount_y, the.shape)
        group = group_at(distance, the.limits_m)
        alike = the.templates[the.groups[group] : the.groups[group + 1]]
        if nearest_shape(the.shape, alike, the.band, the.threshold_m, the.threshold_m, the.rows) <= the.threshold_m:
            kept[members] = s
            members += 1
            foreground += end - start
        else:
            kept[len(kept) - 1 - (s - members)] = s

    inputs = members if average else foreground
    positions, bearings, obstacles = the.positions, the.bearings, the.obstacles
    positions[:inputs] = 0.0
    beams[:] = NOBODY
    row = 0
    for m in range(members):
        start, end = starts[kept[m]], starts[kept[m] + 1]
        for k in range(start, end):
            beam = readings[k]
            positions[row, 0] += points[beam, 0]
            positions[row, 1] += points[beam, 1]
            beams[beam] = row
            if not average:
                row += 1
        if average:
            positions[row, 0] /= end - start
            positions[row, 1] /= end - start
            row += 1
    for row in range(inputs):
        bearings[row] = math.atan2(positions[row, 1], positions[row, 0])

    for k in range(segments - members):
        s = kept[len(kept) - 1 - k]
        nearest = readings[starts[s]]
        for i in range(starts[s], starts[s + 1]):
            if ranges[readings[i]] < ranges[nearest]:
                nearest = readings[i]
        obstacles[k, 0] = points[nearest, 0]
        obstacles[k, 1] = points[nearest, 1]
    return inputs, segments - members
