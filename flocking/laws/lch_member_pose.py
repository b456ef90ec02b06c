"""Local crowded horizon, variation 2: a step towards the mean position of all detected members.

Source: Fine and Shell 2012, "Examining the information requirements for flocking motion"; Fine 2015, section 4.1, LCH
variation 2 (member-centric pose). The document gives distances in units; they are metres here.

    step = d times the unit vector towards the mean of the members' positions, the focal member not among them

The step is not shortened near the mean, so that a compact group keeps an extent of about d. Needs positions.
No neighbours: the printed variation returns the member's own place, so it stands still; section 4.2 says of the robots
that they continue in their direction: with `keeps_direction` it takes its step straight ahead. A mean at the member's
own place: it stands still.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import mean_vector, unit
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions"})
RULES = ("none", "mean")
SETS = {"neighbours": "all"}
TAXONOMY = Taxonomy("homogeneous", "constrained", "discrete", "-", False, True, False, False)
VALIDATION = Validation("SP", True, "global", "-", "-", "unbounded free")
FILLED = (
    Filled("motion computation", "the step d", "0.1, which gives the published spread of a single group"),
    Filled(
        "motion computation",
        "the way-point is printed with a vector as its components",
        "the components of the unit vector, times d",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "a member that sees nobody stays (section 4.1) or keeps its direction (section 4.2)",
        "it stays; with the parameter keeps_direction its step leads straight ahead",
    ),
)
HERD = Herd(spacing_m=0.5, speed_m_s=0.1, dt_s=1.0)
CREATE = {"step_m": 0.33, "keeps_direction": True}


class Parameters(NamedTuple):
    """Of LCH variation 2."""

    step_m: Annotated[
        float,
        Parameter("m", "d of Fine 2015, section 4.1; our choice, which gives table 4.1's spread of 0.05", low=0.0),
    ] = 0.1
    keeps_direction: Annotated[
        bool, Parameter("", "Fine 2015, section 4.2: a robot that sees nobody goes on; as printed it stays")
    ] = False


NEGLIGIBLE_M = 1e-12
"""A mean this near is at the member's own place but for rounding."""


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Way-point: one step towards the mean position."""
    found, x, y = mean_vector(members.positions, sets[0])
    if found == 0:
        if parameters.keeps_direction:
            return Motion(Kind.WAY_POINT, parameters.step_m, 0.0, 0)
        return Motion(Kind.STOP, math.nan, math.nan, 0)
    if math.hypot(x, y) <= NEGLIGIBLE_M:
        return Motion(Kind.STOP, math.nan, math.nan, 1)
    x, y = unit(x, y)
    return Motion(Kind.WAY_POINT, x * parameters.step_m, y * parameters.step_m, 1)
