"""Sensor-based detection (Fine 2015, section 2.2): every reading above a threshold of intensity is an input.

Nothing is known of a member's shape. A reading without a range gives no input: there is no place to put it. One
without an intensity is neither foreground nor background. (Where the laser tells bright from dark by code 18 alone,
nothing is detected at all: its bright readings have no range.) Runs of background readings, split as segments are, give
the obstacles. Inputs are points on the surface, up to one body radius before the member's centre.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Annotated, Any, NamedTuple

import mujoco
import numpy as np

from flocking.compilation import borrowing
from flocking.parameters import Parameter
from flocking.types import Floats, Ints, Members, Obstacles, Own, unknown
from sensing.shapes import recognition
from sensing.shapes.segments import beam_directions, laser_mount, split
from sensing.types import NOBODY, Detection, Senses

READS = frozenset({"scan", "intensity"})


class Parameters(NamedTuple):
    """What is bright; not published, so chosen on data of our own."""

    threshold: Annotated[float, Parameter("", "chosen: python -m scripts.calibrate_detection", low=0.0)] = 17.0
    """Least intensity of the foreground, relative to white paper seen head-on at 1 m."""
    split_m: Annotated[
        float, Parameter("m", "as in member-based detection; for obstacles only", low=0.0, plausible=())
    ] = recognition.Parameters().split_m
    """Consecutive background readings further apart than this belong to different obstacles."""


class State(NamedTuple):
    """The parameters, and arrays that every scan of B beams writes over.

    Compiled code takes it as a plain tuple and names its fields again: from Python a named tuple takes Numba longer.
    """

    threshold: float
    split_m: float
    mount_x: float
    mount_y: float
    directions: Floats
    """(B, 2) of the beams."""
    points: Floats
    """(B, 2) this and the next two as `segments.split` fills them."""
    readings: Ints
    """(B,)."""
    starts: Ints
    """(B + 1,)."""
    nearest: Ints
    """(B,) the nearest beam of each obstacle."""
    positions: Floats
    """(B, 2) of the inputs, m."""
    bearings: Floats
    """(B,) of the inputs, rad."""
    obstacles: Floats
    """(B, 2) m."""


def start(parameters: Parameters, member_model: mujoco.MjModel, member_height_m: float, angles: Floats) -> State:
    """Only the laser's place on the robot is taken from the model."""
    mount_x, mount_y, yaw = laser_mount(member_model)
    return State(
        float(parameters.threshold),
        float(parameters.split_m),
        mount_x,
        mount_y,
        beam_directions(angles, yaw),
        *_scratch(len(angles)),
    )


@cache
def _scratch(beams: int) -> tuple[Floats, Ints, Ints, Ints, Floats, Floats, Floats]:
    """One for all robots of a process, so that it stays in the processor's cache."""
    readings, nearest = np.zeros((2, beams), np.int64)
    points, positions, obstacles = np.zeros((3, beams, 2))
    return points, readings, np.zeros(beams + 1, np.int64), nearest, positions, np.zeros(beams), obstacles


def detect(senses: Senses, own: Own, state: State) -> tuple[Detection, State]:
    """One row a bright reading, in the order of the beams."""
    scan = senses.scan
    assert scan is not None
    beams = np.empty(len(scan.ranges), np.int64)
    inputs, obstacles = _detect(tuple(state), scan.ranges, scan.intensities, beams)
    positions, bearings = state.positions[:inputs].copy(), state.bearings[:inputs].copy()
    points = state.obstacles[:obstacles].copy()
    return Detection(Members(positions, bearings, *unknown(inputs)), Obstacles(points), beams), state


@borrowing
def _detect(state: tuple[Any, ...], ranges: Floats, intensities: Floats, beams: Ints) -> tuple[int, int]:
    """How many inputs and obstacles there are: fills their rows of the state's arrays, and `beams` (B,)."""
    the = State(*state)
    points, readings, starts, nearest = the.points, the.readings, the.starts, the.nearest
    segments, kept = split(ranges, the.directions, the.mount_x, the.mount_y, the.split_m, points, readings, starts)
    beams[:] = NOBODY
    inputs, obstacles = 0, 0
    for k in range(kept):
        if intensities[readings[k]] >= the.threshold:
            beams[readings[k]] = inputs
            inputs += 1
    for s in range(segments):
        background = False
        for k in range(starts[s], starts[s + 1]):
            beam = readings[k]
            row = beams[beam]
            if row >= 0:
                the.positions[row, 0] = points[beam, 0]
                the.positions[row, 1] = points[beam, 1]
                the.bearings[row] = math.atan2(points[beam, 1], points[beam, 0])
                background = False
            elif math.isnan(intensities[beam]):
                continue
            elif not background:
                nearest[obstacles] = beam
                obstacles += 1
                background = True
            elif ranges[beam] < ranges[nearest[obstacles - 1]]:
                nearest[obstacles - 1] = beam
    for k in range(obstacles):
        the.obstacles[k, 0] = points[nearest[k], 0]
        the.obstacles[k, 1] = points[nearest[k], 1]
    return inputs, obstacles
