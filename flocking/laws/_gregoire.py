"""What Gregoire's two models share: the sum of alignment and cohesion, and the parameters of both.

Source: Gregoire, Chate and Tu 2003 (Physica D 181); Fine 2015, table A.1. The models differ in how noise acts: on the
angle of the sum (model 1), or as one more vector in it (model 2).
"""

from __future__ import annotations

from typing import Annotated, Any

from flocking.cohesion import BRACKET, pair_forces
from flocking.compilation import compiled
from flocking.parameters import Parameter
from flocking.taxonomy import Filled
from flocking.terms import mean_direction
from flocking.types import Bools, Members

PUBLICATION = "Gregoire, Chate and Tu 2003"
SAME_MODEL = "our choice: as in Bialek et al. 2012 (PNAS 109), who use this model; swept in the publication"

RangeM = Annotated[float, Parameter("m", f"{PUBLICATION}: the unit of length", published=True, low=0.0)]
CoreM = Annotated[float, Parameter("m", PUBLICATION, published=True, low=0.0)]
EquilibriumM = Annotated[float, Parameter("m", PUBLICATION, published=True, low=0.0)]
AttractionM = Annotated[
    float, Parameter("m", f"{PUBLICATION}; above the equilibrium distance", published=True, low=0.0)
]
SpeedMS = Annotated[float, Parameter("m/s", PUBLICATION, published=True, low=0.0)]
AlignmentSM = Annotated[float, Parameter("s/m", SAME_MODEL, low=0.0)]
Cohesion = Annotated[float, Parameter("", SAME_MODEL, low=0.0)]

FILLED = (
    Filled(
        "neighbour selection",
        "table A.1 has all members within the distance",
        "of these the ones whose Voronoi cells touch the member's own, as in the publication: else herds collapse",
    ),
    Filled(
        "motion computation",
        "what becomes of an infinite force among finite ones, and of several infinite ones",
        "the member turns straight away from those within the core, each weighing alike",
    ),
    BRACKET,
    Filled("motion computation", "whether the member itself belongs to the sum of velocities", "it does"),
)

FLOCK, HARD_CORE = range(2)
"""Indices into RULES of both models."""


@compiled
def without_noise(members: Members, chosen: Bools, parameters: Any) -> tuple[int, int, float, float]:
    """The rule, the number of neighbours, and the vector whose direction is the new heading but for noise.

    FLOCK: the alignment times the sum of the v_j, the member's own velocity included, and the cohesion times the sum
    of the pair forces. HARD_CORE: the unit vector away from the neighbours within the core; their number, which then
    does not matter, is given as 0. `parameters` are those of either model.
    """
    x, y, force_x, force_y = pair_forces(
        members.positions, chosen, parameters.core_m, parameters.equilibrium_m, parameters.attraction_m
    )
    if x != 0.0 or y != 0.0:
        return HARD_CORE, 0, x, y
    found, mean_x, mean_y = mean_direction(members.headings, chosen)
    weight = parameters.alignment_s_m * parameters.speed_m_s
    x = weight * (found * mean_x + 1.0) + parameters.cohesion * force_x
    y = weight * found * mean_y + parameters.cohesion * force_y
    return FLOCK, found, x, y
