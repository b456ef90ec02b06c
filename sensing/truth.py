"""What a pipeline missed and what it made up, against what really stood there. For measures only: no robot knows.

A member is HIDDEN while no beam falls on it, DETECTED if at least one input is its own, else MISSED (a false negative).
An input is owned by whoever made most of its beams; by nobody (a false positive) if most of them belong to nobody: to
a wall, or to a reading between two surfaces. Beams likewise: `lit` fell on members, `missed` are those of them that
made no input (those lost in the sensor, too), `made_up` made an input but belong to nobody. At an edge a reading can be
a member's though the middle of its beam fell beside it; so the beams that fell on a member and those that made inputs
of it are compared for each member by itself.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from flocking.compilation import compiled
from flocking.types import Ints
from sensing.types import NOBODY, Detection, ScanTruth

HIDDEN = np.int8(0)
DETECTED = np.int8(1)
MISSED = np.int8(2)


class Judgement(NamedTuple):
    """One update's detection held against the truth; N robots, M inputs."""

    owners: NDArray[np.int16]
    """(M,) index of the robot each input belongs to; −1 = nobody."""
    states: NDArray[np.int8]
    """(N,) HIDDEN, DETECTED or MISSED; the focal member is HIDDEN."""
    lit: int
    missed: int
    made_up: int


def judge(detection: Detection, truth: ScanTruth | None, focal: int, robots: int) -> Judgement:
    """Hold `detection` against `truth`; `focal` is the index of the robot that sensed, of `robots` in all.

    Where the pipeline read no scan (`truth` None, or no beams in the detection), the owners are the members'
    ids: it knows everybody in its view, so nobody is missed, and no beam counts.
    """
    ids = detection.members.ids
    owners, states = np.empty(len(ids), np.int16), np.empty(robots, np.int8)
    if truth is None or not len(detection.beams):
        _judge_ids(ids, focal, owners, states)
        return Judgement(owners, states, 0, 0, 0)
    return Judgement(owners, states, *_judge(detection.beams, truth.owners, truth.lit, focal, owners, states))


@compiled
def _judge_ids(ids: Ints, focal: int, owners: NDArray[np.int16], states: NDArray[np.int8]) -> None:
    """Fill `owners` (M,) and `states` (N,) by the members' ids."""
    states[:] = HIDDEN
    for row in range(len(ids)):
        owners[row] = ids[row]
        if 0 <= ids[row] < len(states) and ids[row] != focal:
            states[ids[row]] = DETECTED


@compiled
def _judge(
    beams: Ints,
    beam_owners: Ints,
    lit: Ints,
    focal: int,
    owners: NDArray[np.int16],
    states: NDArray[np.int8],
) -> tuple[int, int, int]:
    """Fill `owners` (M,) and `states` (N,) by the beams; return how many were lit, missed and made up."""
    inputs, robots = len(owners), len(states)
    counts = np.zeros((inputs, robots + 1), np.int16)
    most = np.zeros(inputs, np.int16)
    owners[:] = NOBODY
    states[:] = HIDDEN
    found, made_up = np.zeros(robots, np.int64), 0
    for beam in range(len(beams)):
        row = beams[beam]
        if row < 0:
            continue
        owner = beam_owners[beam]
        if owner < 0:
            made_up += 1
        else:
            found[owner] += 1
        counts[row, owner + 1] += 1
        count = counts[row, owner + 1]
        # Equal shares go to a member before nobody, then to the lower index: whatever the order of the beams.
        preferred = owner >= 0 and (owners[row] < 0 or owner < owners[row])
        if count > most[row] or (count == most[row] and preferred):
            most[row] = count
            owners[row] = owner
    all_lit, missed = 0, 0
    for robot in range(robots):
        if robot != focal and lit[robot] > 0:
            states[robot] = MISSED
            all_lit += lit[robot]
            missed += max(0, lit[robot] - found[robot])
    for row in range(inputs):
        if owners[row] >= 0 and owners[row] != focal:
            states[owners[row]] = DETECTED
    return all_lit, missed, made_up
