"""Shimoyama's motile elements: thrust along a heading of their own, which the velocity turns only slowly.

Source: Shimoyama, Sugawara, Mizuguchi, Hayakawa and Sano 1996 (Physical Review Letters 76); Fine 2015, table A.1.
mass * acceleration = thrust * n - drag * v + sum over the neighbours of a_j f_j + g, where n is the heading, a unit
vector with dn/dt = (v' - (n.v') n) / relaxation time, v' the unit vector along v; a_j = 1 + anisotropy * (n.r'_j);
f_j = interaction * (x^-2 - x^-3) exp(-x) r_j / spacing with x = distance / spacing: attraction beyond the spacing,
repulsion within; and g a pull of constant size, gravity over the number of neighbours, towards their middle. Metres,
seconds, kilograms.

The heading is no part of the body: it is kept in memory as an angle from the member's own velocity, of which a member
needs no compass to know it. What is written down is the angle from the velocity that this acceleration leads to, so
that a body that turns, or does not turn, with its velocity makes no difference. A body that cannot follow the
acceleration takes its heading with it. The heading's equation is solved exactly for the present velocity, so that no
step is too long for it. At first the heading is along the velocity; at rest the body's axis stands in for it.

Needs positions. No neighbours: thrust and drag alone. A neighbour at distance zero has no direction and exerts
nothing. There is no noise.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.angles import wrap
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import direction, mean_vector, unit
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions"})
RULES = ("forces",)
SETS = {"neighbours": "distance-based(0, range_m)"}
MEMORY = 1

TAXONOMY = Taxonomy("homogeneous", "idealized", "continuous", "member", False, True, True, True)
VALIDATION = Validation("S", True, "global", "global", "global", "unbounded free")
FILLED = (
    Filled(
        "sensing",
        "table 3.2 asks for the neighbours' velocities and orientations; the formula of table A.1 has neither",
        "they are not needed: velocity and heading are the member's own",
    ),
    Filled(
        "motion computation",
        "table A.1 prints the double cross product without brackets and the heading's derivative without a dot",
        "the part of the velocity's direction across the heading, over the relaxation time",
        misprint=True,
    ),
    Filled("motion computation", "the heading at the start", "along the velocity"),
    Filled(
        "motion computation",
        "table A.1 takes the middle and the number of the neighbours, the publication of the whole group",
        "the neighbours', as in the table",
    ),
)
HERD = Herd(spacing_m=1.5, speed_m_s=1.0, dt_s=0.01, space="unbounded")
CREATE = {
    "range_m": 5.6,
    "thrust_n": 0.25,
    "interaction_n": 1.0,
    "gravity_n": 0.5,
}


class Parameters(NamedTuple):
    """Of Shimoyama's forces."""

    range_m: Annotated[float, Parameter("m", "our choice: ten spacings", low=0.0)] = 10.0
    mass_kg: Annotated[float, Parameter("kg", "our choice", low=1e-6)] = 1.0
    drag_kg_s: Annotated[float, Parameter("kg/s", "our choice", low=0.0)] = 1.0
    thrust_n: Annotated[float, Parameter("N", "our choice", low=0.0)] = 1.0
    relaxation_s: Annotated[float, Parameter("s", "our choice", low=1e-6)] = 0.5
    interaction_n: Annotated[float, Parameter("N", "our choice", low=0.0)] = 5.0
    spacing_m: Annotated[float, Parameter("m", "our choice", low=1e-6)] = 1.0
    anisotropy: Annotated[
        float, Parameter("", "our choice; from 0 to 1 as in Fine 2015, table A.1", low=0.0, high=1.0)
    ] = 0.5
    gravity_n: Annotated[float, Parameter("N", "our choice: enough to keep 50 members in one cluster", low=0.0)] = 5.0


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Acceleration: all forces over the mass; the heading goes on in memory."""
    vx, vy = own.velocity[0], own.velocity[1]
    course = direction(vx, vy)
    heading = course + memory[0]
    nx, ny = math.cos(heading), math.sin(heading)
    force_x = parameters.thrust_n * nx - parameters.drag_kg_s * vx
    force_y = parameters.thrust_n * ny - parameters.drag_kg_s * vy
    for j in range(len(members.ids)):
        x, y = members.positions[j, 0], members.positions[j, 1]
        distance = math.hypot(x, y)
        if not sets[0, j] or distance == 0.0:
            continue
        ratio = distance / parameters.spacing_m
        ahead = (nx * x + ny * y) / distance
        pull = parameters.interaction_n * (1.0 - 1.0 / ratio) / ratio * math.exp(-ratio)
        pull *= 1.0 + parameters.anisotropy * ahead
        force_x += pull * x / distance
        force_y += pull * y / distance
    found, x, y = mean_vector(members.positions, sets[0])
    if found > 0:
        middle_x, middle_y = unit(x, y)
        force_x += parameters.gravity_n / found * middle_x
        force_y += parameters.gravity_n / found * middle_y
    accelerate_x, accelerate_y = force_x / parameters.mass_kg, force_y / parameters.mass_kg
    if vx != 0.0 or vy != 0.0:
        decay = math.exp(-own.dt / parameters.relaxation_s)
        heading = course + 2.0 * math.atan(math.tan(0.5 * wrap(memory[0])) * decay)
    memory[0] = wrap(heading - direction(vx + accelerate_x * own.dt, vy + accelerate_y * own.dt))
    return Motion(Kind.ACCELERATION, accelerate_x, accelerate_y, 0)
