"""Simple nearest neighbour (SNN): move directly towards the nearest neighbour.

Source: Hamilton 1971 as told by Fine 2015, section 2.1.1. Metres, body frame.
No neighbours: the publication says nothing; the last command is kept, as in the extended rule of section 2.1.2.
Within the repulsion distance of the nearest neighbour the member does not move.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.geometry import NOT_FOUND, nearest
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions"})
RULES = ("none", "snn")
SETS = {"neighbours": "all"}
TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "-", False, True, False, False)
VALIDATION = Validation("S", True, "global", "-", "-", "unbounded free")
FILLED = (
    Filled("motion computation", "what a member does that detects nobody", "it keeps its command, as in section 2.1.2"),
)
HERD = Herd(spacing_m=1.3, speed_m_s=0.33, dt_s=1.0)
CREATE: dict[str, float] = {}


class Parameters(NamedTuple):
    """Of SNN."""

    repulsion_m: Annotated[
        float,
        Parameter("m", "Fine 2015, section 2.1.1: two body-lengths; body-length = the Create's diameter", low=0.0),
    ] = 0.66


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Way-point: the nearest neighbour itself."""
    a1 = nearest(members.positions, sets[0])
    if a1 == NOT_FOUND:
        return Motion(Kind.HOLD, math.nan, math.nan, 0)
    x, y = members.positions[a1, 0], members.positions[a1, 1]
    if math.hypot(x, y) <= parameters.repulsion_m:
        return Motion(Kind.STOP, math.nan, math.nan, 1)
    return Motion(Kind.WAY_POINT, x, y, 1)
