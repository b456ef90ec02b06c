"""Simple nearest neighbour (SNN) as a step of one body-length, of Viscido et al.

Source: Viscido, Miller and Wethey 2002, "The dilemma of the selfish herd"; Fine 2015, table A.1, Viscido et al. (2002)
(SNN). The publication counts in body-lengths; one body-length is one metre here.

    new position = position + the unit vector towards the nearest neighbour, if that is farther than the repulsion
    distance; else the position as it is.

Needs positions. No neighbours: undefined in the publication (section 3.2.2 names this very law); the member keeps its
motion, as in section 2.1.2. The law `snn` has the same rule with the neighbour itself as the way-point, for robots that
go on towards it until the next update.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from flocking.geometry import NOT_FOUND, nearest
from flocking.laws._selfish_herd import NOBODY, RepulsionM, UnitVectorM
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions"})
RULES = ("none", "snn")
SETS = {"nearest": "nearest"}
TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "-", False, True, False, False)
VALIDATION = Validation("S", True, "global", "-", "-", "bounded free")
FILLED = (
    NOBODY,
    Filled("motion computation", "the repulsion distance", "two body-lengths, as in section 2.1.1"),
)
HERD = Herd(spacing_m=4.0, speed_m_s=1.0, dt_s=1.0, space="bounded")
CREATE = {"step_m": 0.33, "repulsion_m": 0.66}


class Parameters(NamedTuple):
    """Of SNN as a step."""

    step_m: UnitVectorM = 1.0
    repulsion_m: RepulsionM = 2.0


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Way-point: one step towards the nearest neighbour."""
    k = nearest(members.positions, sets[0])
    if k == NOT_FOUND:
        return Motion(Kind.HOLD, math.nan, math.nan, 0)
    x, y = members.positions[k, 0], members.positions[k, 1]
    distance = math.hypot(x, y)
    if distance <= parameters.repulsion_m or distance == 0.0:
        return Motion(Kind.STOP, math.nan, math.nan, 1)
    return Motion(Kind.WAY_POINT, x / distance * parameters.step_m, y / distance * parameters.step_m, 1)
