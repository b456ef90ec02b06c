"""Local crowded horizon, variation 4: a step along the mean bearing of all detected members.

Source: Fine and Shell 2012, "Examining the information requirements for flocking motion"; Fine 2015, section 4.1, LCH
variation 4 (member-centric bearing). The document gives distances in units; they are metres here.

    step = d times (cos, sin) of the direction of the mean of the unit vectors towards the members

The step has one length whatever the distances, which are not known. Needs bearings alone.
No neighbours: the printed variation returns the member's own place, so it stands still; section 4.2 says of the robots
that they continue in their direction: with `keeps_direction` it takes its step straight ahead. Unit vectors that cancel
out: it stands still.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import mean_direction, unit
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"bearings"})
RULES = ("none", "mean")
SETS = {"neighbours": "all"}
TAXONOMY = Taxonomy("homogeneous", "constrained", "discrete", "-", False, False, False, False)
VALIDATION = Validation("SP", True, "global", "-", "-", "unbounded free")
FILLED = (
    Filled("motion computation", "the step d", "0.1, which gives the published spread of a single group"),
    Filled("motion computation", "bearings that cancel out", "the member stands still"),
    Filled(
        "motion computation",
        "a member that sees nobody stays (section 4.1) or keeps its direction (section 4.2)",
        "it stays; with the parameter keeps_direction its step leads straight ahead",
    ),
)
HERD = Herd(spacing_m=0.5, speed_m_s=0.1, dt_s=1.0)
CREATE = {"step_m": 0.33, "keeps_direction": True}


class Parameters(NamedTuple):
    """Of LCH variation 4."""

    step_m: Annotated[
        float,
        Parameter("m", "d of Fine 2015, section 4.1; our choice, which gives table 4.1's spread of 0.05", low=0.0),
    ] = 0.1
    keeps_direction: Annotated[
        bool, Parameter("", "Fine 2015, section 4.2: a robot that sees nobody goes on; as printed it stays")
    ] = False


NEGLIGIBLE = 1e-12
"""A mean of unit vectors shorter than this is zero but for rounding."""


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Way-point: one step along the mean bearing."""
    found, x, y = mean_direction(members.bearings, sets[0])
    if found == 0:
        if parameters.keeps_direction:
            return Motion(Kind.WAY_POINT, parameters.step_m, 0.0, 0)
        return Motion(Kind.STOP, math.nan, math.nan, 0)
    if math.hypot(x, y) <= NEGLIGIBLE:
        return Motion(Kind.STOP, math.nan, math.nan, 1)
    x, y = unit(x, y)
    return Motion(Kind.WAY_POINT, x * parameters.step_m, y * parameters.step_m, 1)
