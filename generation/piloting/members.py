"""The kinematic members that plans are validated with: Creates as points of their size, in a street 1.5 m wide.

Fine 2015, section 8.2, has four robots under BOIDS. Their numbers are not published: these are choices.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from flocking import lawentry, lawsource
from generation.validation.kinematic import KinematicGroup, kinematic

LAW = "reynolds-boids"
COUNT = 4
"""Fine 2015, section 8.2."""
SEPARATION_M = 0.6
"""Distance below which BOIDS keep apart: two abreast in a street of 1.5 m; Creates usually take 0.9 m."""
SPEED_M_S = 0.25
"""Half of a Create's top speed."""
DT_S = 0.2
"""Of an iteration: 50 mm at that speed."""
STEP_M = SPEED_M_S * DT_S
SEES_M = 1.03
"""Farthest that a wall matters to a member, m: the look-ahead of the avoidance that all laws share, and its margin."""


def of_law(law: str) -> dict[str, Any]:
    """What a law's parameters are for these members, where they are not the law's own for Creates."""
    return {"separation_m": SEPARATION_M} if law == LAW else {}


def group(law: str = LAW, count: int = COUNT, law_parameters: Mapping[str, Any] | None = None) -> KinematicGroup:
    """So many members of a law, by its name or the path of a user's own file. Raises `InputError`."""
    source = lawsource.read_source(law) if lawentry.is_path(law) else ""
    creates = getattr(lawentry.module_of(law, source), "CREATE", {})
    return kinematic(
        law,
        count,
        DT_S,
        law_parameters={**creates, **of_law(law), **(law_parameters or {})},
        speed_m_s=SPEED_M_S,
        max_turn_rate_rad_s=2.0,
        radius_m=0.165,
        look_ahead_m=0.75,
        margin_m=0.28,
    )
