"""Kirchner 2006, figure 4.3: a robot follows another along a meandering path with a larger turn at its end.

The meanders are a choice: arcs of 20, 40, 40 and 20 degrees to the left and right by turns, 14 feet along x.
"""

from __future__ import annotations

import math

from trials.studies.monocular.claims import following_claims as claims
from trials.studies.monocular.design import BODIES, BODY, KEY_MEASURES, SOURCES, Leg, arc_to, finish, following
from trials.studies.monocular.figures import figures
from trials.types import Trial

REPEATS = 20
RECORD = "first"
CONDITIONS = {BODY: BODIES}
START_FT, MEANDER_FT, SWING = 6.0, 14.0, math.radians(20.0)
RADIUS_FT = MEANDER_FT / (6.0 * math.sin(SWING))
ASIDE_FT = 2.0 * RADIUS_FT * (1.0 - math.cos(SWING))
"""How far to the left the meanders lead."""
LEGS = (
    Leg(RADIUS_FT * SWING, SWING),
    Leg(2.0 * RADIUS_FT * SWING, -2.0 * SWING),
    Leg(2.0 * RADIUS_FT * SWING, 2.0 * SWING),
    Leg(RADIUS_FT * SWING, -SWING),
    arc_to(29.0 - START_FT - MEANDER_FT, -5.0),
)


def base(repeat: int) -> Trial:
    """The lead robot along its meanders, and one that follows."""
    return following("follow-3", repeat, LEGS, START_FT)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures", "finish"]
