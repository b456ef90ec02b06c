"""Kirchner 2006, figure 4.1: a robot follows another that makes a wide left turn, by its cameras alone.

The lead robot begins 6.28 feet ahead and turns from the start on, along one arc to where it ends. Section 4.4 gives two
places; the one that takes the longer way round is the lead robot's, for the other one turns inside and closes in.
"""

from __future__ import annotations

from trials.studies.monocular.claims import following_claims as claims
from trials.studies.monocular.design import BODIES, BODY, KEY_MEASURES, SOURCES, arc_to, finish, following
from trials.studies.monocular.figures import figures
from trials.types import Trial

REPEATS = 20
RECORD = "first"
CONDITIONS = {BODY: BODIES}
START_FT = 6.28
LEGS = (arc_to(8.0 - START_FT, 7.5),)


def base(repeat: int) -> Trial:
    """The lead robot along its arc, and one that follows."""
    return following("follow-1", repeat, LEGS, START_FT)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures", "finish"]
