"""Kirchner 2006, figure 4.2: a robot follows another that goes straight for 4.5 feet and then turns right."""

from __future__ import annotations

from trials.studies.monocular.claims import following_claims as claims
from trials.studies.monocular.design import BODIES, BODY, KEY_MEASURES, SOURCES, Leg, arc_to, finish, following
from trials.studies.monocular.figures import figures
from trials.types import Trial

REPEATS = 20
RECORD = "first"
CONDITIONS = {BODY: BODIES}
START_FT, STRAIGHT_FT = 6.0, 4.5
LEGS = (Leg(STRAIGHT_FT), arc_to(17.8 - START_FT - STRAIGHT_FT, -3.1))


def base(repeat: int) -> Trial:
    """The lead robot straight ahead and along its arc, and one that follows."""
    return following("follow-2", repeat, LEGS, START_FT)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures", "finish"]
