"""Readings that carry the name of whoever made them: what the two pipelines of perfect classification share.

Fine 2015, section 2.2.1: in the ideal case "every pixel in the raw sensor data will be correctly identified as either
foreground or background", with neither false negatives nor false positives. What is left to compare is what the
detections do with the foreground: average it to one point a member, or pass it on.
"""

from __future__ import annotations

from typing import NamedTuple

import mujoco
import numpy as np

from flocking.compilation import compiled
from flocking.types import NO_OBSTACLES, Floats, Ints, Members, unknown
from sensing.shapes.segments import beam_directions, laser_mount
from sensing.types import NOBODY, Detection, Senses

READS = frozenset({"scan", "owners"})


class State(NamedTuple):
    """Where the laser stands and looks."""

    mount_x: float
    mount_y: float
    directions: Floats
    """(B, 2) of the beams."""


def begun(member_model: mujoco.MjModel, angles: Floats) -> State:
    """For lasers mounted as on the robot in `member_model`, with beams at `angles` (B,) rad."""
    mount_x, mount_y, yaw = laser_mount(member_model)
    return State(mount_x, mount_y, beam_directions(angles, yaw))


def classified(senses: Senses, state: State, average: bool) -> Detection:
    """One input for each reading that a member made, or (`average`) one for each member that made any.

    No obstacles are given: the publication's laws use none.
    """
    scan, owners = senses.scan, senses.owners
    assert scan is not None
    assert owners is not None
    positions, beams = _classified(scan.ranges, owners, *state, average)
    bearings = np.arctan2(positions[:, 1], positions[:, 0])
    return Detection(Members(positions, bearings, *unknown(len(positions))), NO_OBSTACLES, beams)


@compiled
def _classified(
    ranges: Floats, owners: Ints, mount_x: float, mount_y: float, directions: Floats, average: bool
) -> tuple[Floats, Ints]:
    """Positions of the inputs, in the order of their first beams, and the row that each beam made."""
    beams = np.full(len(ranges), NOBODY, np.int64)
    row_of = np.full(max(owners.max() + 1, 1), NOBODY, np.int64)
    inputs = 0
    for i in range(len(ranges)):
        if owners[i] < 0 or not np.isfinite(ranges[i]):
            continue
        if average and row_of[owners[i]] != NOBODY:
            beams[i] = row_of[owners[i]]
            continue
        beams[i] = row_of[owners[i]] = inputs
        inputs += 1
    positions, counts = np.zeros((inputs, 2)), np.zeros(inputs)
    for i in range(len(ranges)):
        row = beams[i]
        if row != NOBODY:
            positions[row, 0] += mount_x + ranges[i] * directions[i, 0]
            positions[row, 1] += mount_y + ranges[i] * directions[i, 1]
            counts[row] += 1.0
    for row in range(inputs):
        positions[row] /= counts[row]
    return positions, beams
