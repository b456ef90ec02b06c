"""Member-based detection of cones: the centre of the longest run of both images is one member, the closest cone.

Kirchner 2006, sections 3.6.4 to 3.6.6: the thesis's own. The input lies on the cone's near side, at the distance |d| of
equation 3.5. With several colours the member's id is the number of its colour. Of the other image's longest run, where
that is another cone's, only the sonar makes use: its cone is no obstacle either.
"""

from __future__ import annotations

from typing import NamedTuple

import mujoco
import numpy as np

from flocking.types import Floats, Own
from sensing.camera import looking
from sensing.camera.colours import HSV
from sensing.camera.cones import RADIUS_M
from sensing.camera.runs import LARGEST_HOLE_PX, ROW, longest
from sensing.types import NOBODY, Detection, Senses

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
    """One row, or none where no pixel of either image is a cone's."""
    if senses.images is None:
        members, columns = looking.nothing_seen(state)
        return Detection(members, looking.obstacles(senses, members.positions, state), columns), state
    state = looking.labelled(senses.images, state)
    left, right = (longest(labels, state.colours, state.largest_hole_px) for labels in state.labels)
    seen = looking.sighted(left[left[:, ROW] >= 0], right[right[:, ROW] >= 0], state.eyes)
    cones = looking.cones(seen, state, 2)
    members = looking.members_of(cones.positions[:1], cones.colours[:1], state.colours > 1)
    closest = np.where(cones.columns == 0, 0, NOBODY)
    return Detection(members, looking.obstacles(senses, cones.positions, state), closest), state
