"""Sensor-based detection of cones: every column with an orange pixel is an input.

The counterpart, in images, of Fine 2015, section 2.2: nothing is known of a member's shape, and nothing is tested. A
column has a bearing but no distance of its own: it takes that of the longest run through one of its orange pixels, of
whatever length: a lone pixel is an input 98 ft (30 m) away. Where both cameras see, each column's bearing counts once:
the left camera gives what is left of the middle between them, the right one the rest.
"""

from __future__ import annotations

from typing import NamedTuple

import mujoco
import numpy as np

from flocking.compilation import compiled
from flocking.types import Floats, Ints, Own
from sensing.camera import looking
from sensing.camera.colours import HSV
from sensing.camera.cones import RADIUS_M
from sensing.camera.runs import COLOUR, END, LARGEST_HOLE_PX, ROW, START, widest_at_columns
from sensing.types import Detection, Senses

READS = frozenset({"images", "echoes"})
GIVES = frozenset({"positions", "bearings"})


class Parameters(NamedTuple):
    """Which pixels are a cone's, and what a run of them means."""

    segmentation: looking.SegmentationKind = HSV
    ranges: looking.Ranges = "calibrated"
    """`calibrated` on the rendered cone, or as `published`."""
    colours: looking.Colours = 1
    """1: all cones are orange. More: one a robot, and ids are the colours' numbers."""
    largest_hole_px: looking.LargestHole = LARGEST_HOLE_PX
    """Consecutive pixels of another colour that a run may hold."""
    cone_radius_m: looking.ConeRadius = RADIUS_M
    """At the base."""
    pixels_per_degree: looking.Assumption = looking.EQUAL_ANGLE
    """`equal-angle`: the same for all columns, whatever the lens (5.12); `lens`: each column's own bearing."""
    offset: looking.Offset = looking.CAMERA
    """Where places are told from (`looking.OFFSETS`)."""


def start(parameters: Parameters, member_model: mujoco.MjModel, member_height_m: float, angles: Floats) -> looking.Gaze:
    """The cameras' places are taken from the model; `angles` (2, W) are the columns' true bearings in each camera."""
    return looking.gaze(**parameters._asdict(), member_model=member_model, angles=angles)


def detect(senses: Senses, own: Own, state: looking.Gaze) -> tuple[Detection, looking.Gaze]:
    """One row a column, in the order of the columns, those of the left image first."""
    if senses.images is None:
        members, columns = looking.nothing_seen(state)
        return Detection(members, looking.obstacles(senses, members.positions, state), columns), state
    state = looking.labelled(senses.images, state)
    runs = np.concatenate([widest_at_columns(each, state.colours, state.largest_hole_px) for each in state.labels])
    owners, distances = _ranged(runs, *state.eyes, state.radius_m)
    positions, ids, columns = looking.spread(owners, distances, runs[:, COLOUR].copy(), *state.eyes)
    members = looking.members_of(positions, ids, state.colours > 1)
    return Detection(members, looking.obstacles(senses, positions, state), columns), state


@compiled
def _ranged(runs: Ints, edges: Floats, mounts: Floats, radius: float) -> tuple[Ints, Floats]:
    """For each column (2W,) itself, or −1 where it gives no input, and its distance (m) by its run (2W, 4)."""
    width = len(runs) // 2
    middle = (mounts[0, 2] + mounts[1, 2]) / 2.0
    owners, distances = np.full(len(runs), -1, np.int64), np.empty(len(runs))
    for j in range(len(runs)):
        side, column = j // width, j % width
        bearing = (edges[side, column] + edges[side, column + 1]) / 2.0 + mounts[side, 2]
        if runs[j, ROW] >= 0 and (bearing >= middle) == (side == 0):
            owners[j] = j
            start, end = edges[side, runs[j, START]], edges[side, runs[j, END] + 1]
            distances[j] = looking.seen_at(start, end, mounts[side], radius)[2]
    return owners, distances
