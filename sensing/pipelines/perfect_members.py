"""Member-based input in the ideal case: the mean of each member's readings, every reading correctly classified.

Fine 2015, section 2.2.1. Neither false negatives nor false positives: a member counts from one reading on. With
perfect classification member-extrapolated and sensor-based detection are the same, the readings themselves.
"""

from __future__ import annotations

from typing import NamedTuple

import mujoco

from flocking.types import Floats, Own
from sensing import labelled
from sensing.types import Detection, Senses

READS = labelled.READS
GIVES = frozenset({"positions", "bearings"})


class Parameters(NamedTuple):
    """There are none."""


def start(
    parameters: Parameters, member_model: mujoco.MjModel, member_height_m: float, angles: Floats
) -> labelled.State:
    """Only the laser's place on the robot is taken from the model."""
    return labelled.begun(member_model, angles)


def detect(senses: Senses, own: Own, state: labelled.State) -> tuple[Detection, labelled.State]:
    """The inputs, in the order of the beams."""
    return labelled.classified(senses, state, average=True), state
