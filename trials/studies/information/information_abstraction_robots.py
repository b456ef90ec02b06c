"""A few laws on Creates as information is taken away: the four LCH variations, and three that read poses or velocities.

Five Creates on the open floor. What the kinematic herd of `information-abstraction` has without noise is sensed here:
global knowledge, or a laser's 240 degrees through each of the three detections. Bearings alone are those of the LCH
variations that read nothing else; the group's view of the other laws is a selection before theirs.
"""

from __future__ import annotations

from flocking.parameters import Parameter
from trials.simulations.robots.fields import group, trial
from trials.studies.information.abstraction_robots import (
    CONTROL,
    DETAIL,
    DETECTION,
    DETECTIONS,
    GROUP_CENTRIC,
    LAW,
    LAWS,
    MEMBER_CENTRIC,
    cells,
    claims,
    figures,
)
from trials.types import Trial

REPEATS = 20
RECORD = "first"
CONDITIONS = {LAW: LAWS, DETAIL: (MEMBER_CENTRIC, GROUP_CENTRIC), DETECTION: DETECTIONS}
KEY_MEASURES = ("largest_share", "mmd", "polarization", "none_share")
SOURCES = {
    "world": Parameter("", "a choice: as in section 4.2 of Fine 2015"),
    "formation": Parameter("", "a choice: as in section 4.2 of Fine 2015"),
    "herd.count": Parameter("robots", "a choice"),
    "herd.law": Parameter("", "a choice: laws that run on what a laser gives"),
    "herd.pipeline": Parameter("", "Fine 2015, section 2.2, and global knowledge"),
}


def base(repeat: int) -> Trial:
    """Five robots on the open floor."""
    return trial("information-abstraction-robots", repeat, [group(CONTROL, 5)], world="open-floor", duration_s=60.0)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "cells", "claims", "figures"]
