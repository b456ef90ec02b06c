"""Member-extrapolated detection (Fine 2015, section 2.5): the test of member-based detection without its average.

Every foreground reading of a recognised member is an input of its own: a point on the surface that faces the laser.
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
    """One row a reading of a recognised member, in the order of the beams; obstacles are all other segments."""
    assert senses.scan is not None
    return recognise(senses.scan.ranges, state, False), state
