"""Member-extrapolated detection of cones: each column of each accepted run is an input, at its run's distance.

The counterpart, in images, of Fine 2015, section 2.5: the test of a member without its average. A run is accepted if it
is long enough and shares no column with a longer one: the widest row of each cone. A cone in both images gives the
columns of the wider run alone.
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
from sensing.camera.runs import LARGEST_HOLE_PX, accepted
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
    minimum_run_px: looking.MinimumRun = 4
    """Shorter runs are no cone's."""
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
    left, right = (
        accepted(labels, state.colours, state.largest_hole_px, state.minimum_run_px) for labels in state.labels
    )
    cones = looking.cones(looking.sighted(left, right, state.eyes), state, len(left) + len(right))
    kept = _kept(cones.columns, len(cones.colours))
    positions, ids, columns = looking.spread(kept, cones.distances, cones.colours, *state.eyes)
    members = looking.members_of(positions, ids, state.colours > 1)
    return Detection(members, looking.obstacles(senses, positions, state), columns), state


@compiled
def _kept(owners: Ints, cones: int) -> Ints:
    """The owners (2W,) of the columns, without those of the image in which a cone has fewer (as many: the right)."""
    width = len(owners) // 2
    counts = np.zeros((cones, 2), np.int64)
    for j in range(len(owners)):
        if owners[j] >= 0:
            counts[owners[j], j // width] += 1
    kept = owners.copy()
    for j in range(len(owners)):
        if owners[j] >= 0 and counts[owners[j], j // width] < counts[owners[j], 1 - j // width] + j // width:
            kept[j] = -1
    return kept
