"""Member-based detection (Fine 2015, sections 2.2 and 2.3.1): one input for each member recognised by its shape.

The input is the average of the member's foreground readings, as published. They lie on the side that faces the laser,
so the input stands before the member's centre: by 0.80 radii far away, 0.92 where the two touch (0.13 to 0.15 m for
Creates; the mean over equal steps of bearing).
"""

from __future__ import annotations

import mujoco

from flocking.types import Floats, Own
from sensing.shapes.recognition import Parameters, Recogniser, recognise, recogniser
from sensing.types import Detection, Senses

__all__ = ["READS", "Parameters", "detect", "start"]

READS = frozenset({"scan"})


def start(parameters: Parameters, member_model: mujoco.MjModel, member_height_m: float, angles: Floats) -> Recogniser:
    """Make the database of members; nothing is remembered between scans."""
    return recogniser(parameters, member_model, member_height_m, angles)


def detect(senses: Senses, own: Own, state: Recogniser) -> tuple[Detection, Recogniser]:
    """One row a recognised member, in the order of the beams; obstacles are all other segments."""
    assert senses.scan is not None
    return recognise(senses.scan.ranges, state, True), state
