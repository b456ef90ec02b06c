"""Kirchner 2006, figure 4.4: the lead robot begins three feet ahead and turns sharply, so that the other must avoid it.

Of the two places of section 4.4 the farther one is the lead robot's.
"""

from __future__ import annotations

from trials.studies.monocular.claims import following_claims as claims
from trials.studies.monocular.design import BODIES, BODY, KEY_MEASURES, SOURCES, arc_to, finish, following
from trials.studies.monocular.figures import figures
from trials.types import Trial

REPEATS = 20
RECORD = "first"
CONDITIONS = {BODY: BODIES}
START_FT = 3.0
LEGS = (arc_to(4.7 - START_FT, -2.5),)


def base(repeat: int) -> Trial:
    """The lead robot along its sharp arc, and one close behind."""
    return following("avoidance", repeat, LEGS, START_FT)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures", "finish"]
