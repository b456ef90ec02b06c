"""Stable flocking over a graph that switches with distance: the law of part I among the members within a range.

Source: Tanner, Jadbabaie and Pappas 2003, "Stable flocking of mobile agents, part II: dynamic topology"; Fine 2015,
table A.1. Point masses of unit mass; metres and seconds, which the publication leaves open.

Acceleration and potential are those of `tanner_fixed`; the potential is constant beyond the range, where it exerts no
force. It is continuous at the range but its slope is not: a pair that parts feels its attraction until it is lost.
A pair that comes into range brings no energy along, and one that leaves it takes none.

Needs positions and velocities. No neighbours: the member keeps its velocity.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from flocking.laws.tanner_fixed import BOUNDED, SIGN, ClosestM, law
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation

__all__ = ["law"]

SOURCE = "Tanner, Jadbabaie and Pappas 2003, part II"

NEEDS = frozenset({"positions", "velocities"})
RULES = ("none", "flock")
SETS = {"neighbours": "distance-based(0, range_m)"}
RELATIONS = ("closest_m below spacing_m", "spacing_m at most range_m")
TAXONOMY = Taxonomy("homogeneous", "idealized", "continuous", "member", False, True, True, True)
VALIDATION = Validation("MS", True, "global", "global", "global", "unbounded free")
FILLED = (
    Filled(
        "sensing",
        "how a member comes to know positions and velocities",
        "they are known without error within the range; headings, which table 3.2 lists, are not read",
    ),
    SIGN,
    Filled(
        "motion computation",
        "table A.1 prints i / (d² + log d²), which has no minimum at which to flock",
        "1/d² + log d² up to the range and its value there beyond, as in the original",
        misprint=True,
    ),
    BOUNDED,
)
HERD = Herd(spacing_m=1.0, speed_m_s=0.5, dt_s=0.01)
CREATE = {"range_m": 2.5, "spacing_m": 0.8, "strength_m2_s2": 0.05, "alignment_per_s": 0.5, "closest_m": 0.4}


class Parameters(NamedTuple):
    """Of Tanner's law over a switching graph."""

    range_m: Annotated[float, Parameter("m", "our choice: twice the spacing", low=0.0)] = 2.0
    spacing_m: Annotated[float, Parameter("m", f"{SOURCE}: where the potential is least", published=True, low=1e-3)] = (
        1.0
    )
    strength_m2_s2: Annotated[
        float, Parameter("m²/s²", f"{SOURCE}: the potential has no factor", published=True, low=0.0)
    ] = 1.0
    alignment_per_s: Annotated[float, Parameter("1/s", f"{SOURCE}: the sum has no factor", published=True, low=0.0)] = (
        1.0
    )
    closest_m: ClosestM = 0.25
