"""Levine's self-propelled particles: thrust along the neighbours' mean direction, drag, repulsion and attraction.

Source: Levine, Rappel and Cohen 2000 (Physical Review E 63); Fine 2015, table A.1.
mass * acceleration = thrust * f - drag * v - gradient of U, with f the unit vector along the sum of the unit
velocities v_j, each weighted by exp(-distance / alignment length), and U the sum over the neighbours of
repulsion * exp(-distance / repulsion length) - attraction * exp(-distance / attraction length). Metres, seconds,
kilograms.

The sum for f takes in the member itself, with weight one: so a member alone keeps its direction and reaches the speed
thrust / drag, like a group that moves as one. At rest the body's axis stands in for its velocity's direction.

Needs positions and velocities, its own and the neighbours'. No neighbours: thrust and drag alone. A neighbour at
distance zero has no direction and neither attracts nor repels. There is no noise.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import unit, unit_or_ahead
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "velocities"})
RULES = ("forces",)
SETS = {"neighbours": "distance-based(0, range_m)"}

TAXONOMY = Taxonomy("homogeneous", "idealized", "continuous", "member", False, True, False, False)
VALIDATION = Validation("S", False, "global", "constant", "global", "periodic free")
FILLED = (
    Filled(
        "sensing",
        "table 3.2 does not ask for the neighbours' velocities, but the formula of table A.1 contains them",
        "they are needed",
    ),
    Filled(
        "motion computation",
        "table A.1 writes the thrust's direction as a unit vector and sets it equal to a sum",
        "the sum is brought to length one: the publication's thrust has a fixed magnitude",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "whether the member itself belongs to the sum of directions",
        "it does: without it a member alone would stop",
    ),
    Filled("motion computation", "the direction of a member at rest", "its body's axis"),
    Filled(
        "motion computation",
        "table A.1 has the acceleration as a velocity with a tilde",
        "an acceleration: forces over mass",
        misprint=True,
    ),
)
HERD = Herd(spacing_m=2.0, speed_m_s=1.0, dt_s=0.05, space="periodic")
CREATE = {
    "range_m": 5.6,
    "thrust_n": 0.25,
    "drag_kg_s": 1.0,
    "alignment_m": 1.0,
    "repulsion_j": 0.2,
    "repulsion_m": 0.4,
    "attraction_j": 0.1,
    "attraction_m": 0.8,
}


class Parameters(NamedTuple):
    """Of Levine's forces; two members balance where their attraction equals their repulsion: at 2.08 m by default."""

    range_m: Annotated[float, Parameter("m", "our choice: ten attraction lengths", low=0.0)] = 10.0
    mass_kg: Annotated[float, Parameter("kg", "our choice", low=1e-6)] = 1.0
    thrust_n: Annotated[float, Parameter("N", "our choice", low=0.0)] = 0.5
    drag_kg_s: Annotated[float, Parameter("kg/s", "our choice", low=0.0)] = 0.5
    alignment_m: Annotated[float, Parameter("m", "our choice", low=1e-6)] = 1.0
    repulsion_j: Annotated[
        float,
        Parameter("J", "our choice: stronger and shorter than attraction, so that groups do not collapse", low=0.0),
    ] = 4.0
    repulsion_m: Annotated[float, Parameter("m", "our choice", low=1e-6)] = 0.5
    attraction_j: Annotated[float, Parameter("J", "our choice", low=0.0)] = 1.0
    attraction_m: Annotated[float, Parameter("m", "our choice", low=1e-6)] = 1.0


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Acceleration: all forces over the mass."""
    vx, vy = own.velocity[0], own.velocity[1]
    along_x, along_y = unit_or_ahead(vx, vy)
    force_x, force_y = -parameters.drag_kg_s * vx, -parameters.drag_kg_s * vy
    for j in range(len(members.ids)):
        if not sets[0, j]:
            continue
        x, y = members.positions[j, 0], members.positions[j, 1]
        distance = math.hypot(x, y)
        weight = math.exp(-distance / parameters.alignment_m)
        heading_x, heading_y = unit(members.velocities[j, 0], members.velocities[j, 1])
        along_x += weight * heading_x
        along_y += weight * heading_y
        repulsion = parameters.repulsion_j / parameters.repulsion_m * math.exp(-distance / parameters.repulsion_m)
        attraction = parameters.attraction_j / parameters.attraction_m * math.exp(-distance / parameters.attraction_m)
        towards_x, towards_y = unit(x, y)
        force_x += (attraction - repulsion) * towards_x
        force_y += (attraction - repulsion) * towards_y
    along_x, along_y = unit(along_x, along_y)
    force_x += parameters.thrust_n * along_x
    force_y += parameters.thrust_n * along_y
    return Motion(Kind.ACCELERATION, force_x / parameters.mass_kg, force_y / parameters.mass_kg, 0)
