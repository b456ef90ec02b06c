"""Local crowded horizon (LCH): a step towards all others, of which, as printed, the farther pull the more.

Source: Viscido, Miller and Wethey 2002, "The dilemma of the selfish herd"; Fine 2015, table A.1, Viscido et al. (2002)
(LCH), the rule that its authors validated. The unit is the body-length, one metre here.

    step = the unit vector along the sum over all members j of d_j / (1 + w distance_j), times one body-length

with d_j the vector to member j (not of unit length: the table marks unit vectors with a hat, and these have none) and
w in 1 / distance. As printed, members farther away count more: one at 1 m pulls by 0.73, one at 100 m by 2.6, and none
by more than 1 / w. With `unit_vectors` nearer ones do, by 1 / (1 + w distance): 0.73 and 0.026.

Needs positions. No neighbours, or a sum of zero: no direction is given; without neighbours the member keeps its
motion, in the midst of them it stands still. The law has no repulsion: steps of fixed length pass the centre.
The four other readings of LCH (chapter 4) are `lch_group_pose`, `lch_member_pose`, `lch_group_bearing` and
`lch_member_bearing`.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.laws._selfish_herd import NOBODY, UnitVectorM
from flocking.parameters import Parameter
from flocking.steps import step_along
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import count, unit
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions"})
RULES = ("none", "crowd")
SETS = {"neighbours": "all"}
TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "-", False, True, False, False)
VALIDATION = Validation("S", True, "global", "-", "-", "bounded free")
FILLED = (
    NOBODY,
    Filled("motion computation", "a sum of zero, which has no direction", "the member stands still"),
    Filled(
        "motion computation",
        "the horizon is to fade with distance, but weights on whole vectors, as printed, let the farther count more",
        "as printed; the parameter unit_vectors makes nearer members count more",
    ),
    Filled("neighbour selection", "whether all members or those of the densest horizon count", "all, as table A.1"),
)
HERD = Herd(spacing_m=4.0, speed_m_s=1.0, dt_s=1.0, space="bounded")
CREATE = {"step_m": 0.33}


class Parameters(NamedTuple):
    """Of the local crowded horizon as validated."""

    step_m: UnitVectorM = 1.0
    nearness_per_m: Annotated[
        float,
        Parameter("1/m", "w1 of table A.1, no value there; 0.375 is what later literature quotes of it", low=0.0),
    ] = 0.375
    unit_vectors: Annotated[
        bool,
        Parameter("", "our reading: whole vectors, as table A.1 prints; true: unit vectors, so that nearer ones win"),
    ] = False


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Way-point: one step along the weighted sum."""
    if count(sets[0]) == 0:
        return Motion(Kind.HOLD, math.nan, math.nan, 0)
    x, y = 0.0, 0.0
    for j in range(len(sets[0])):
        if sets[0, j]:
            jx, jy = members.positions[j, 0], members.positions[j, 1]
            weight = 1.0 / (1.0 + parameters.nearness_per_m * math.hypot(jx, jy))
            if parameters.unit_vectors:
                jx, jy = unit(jx, jy)
            x += weight * jx
            y += weight * jy
    return step_along(x, y, parameters.step_m, 1)
