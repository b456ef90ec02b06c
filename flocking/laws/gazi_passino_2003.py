"""Swarm aggregation: every member attracts every other from afar and repels it from close by.

Source: Gazi and Passino 2003, "Stability analysis of swarms"; Fine 2015, table A.1. Metres and seconds, which the
publication leaves open.

Velocity = the sum over all other members j of f(r_i - r_j), with f(y) = -y (a - b exp(-|y|²/c)) and b > a > 0.
A pair rests at the distance sqrt(c ln(b/a)). The centre of the swarm never moves, and all members end up within
(b/a) sqrt(c/2) exp(-1/2) of it, whatever their number.

Needs positions. No neighbours: the sum is empty and the member stands still. In time steps, dt must be small against
1 / (b M) for M members.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

SOURCE = "Gazi and Passino 2003"

NEEDS = frozenset({"positions"})
RULES = ("none", "aggregate")
SETS = {"neighbours": "all"}
RELATIONS = ("attraction_per_s above 0", "attraction_per_s below repulsion_per_s")
TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "member", False, True, True, True)
VALIDATION = Validation("M", True, "global", "-", "-", "-")
FILLED = (
    Filled(
        "sensing",
        "how a member comes to know the positions of all others",
        "they are known without error; velocities and headings, which table 3.2 lists, are not read",
    ),
    Filled(
        "motion computation",
        "table A.1 prints a new position that leaves the old one out, and an exponent that is not real",
        "the sum is a velocity in continuous time and the exponent -|y|²/c, as in the original",
        misprint=True,
    ),
)
HERD = Herd(spacing_m=0.5, speed_m_s=0.0, dt_s=0.001)
CREATE = {"attraction_per_s": 0.05, "repulsion_per_s": 1.0, "reach_m2": 0.15}


class Parameters(NamedTuple):
    """Of Gazi and Passino's swarm."""

    attraction_per_s: Annotated[float, Parameter("1/s", f"{SOURCE}: a", published=True, low=0.0)] = 1.0
    repulsion_per_s: Annotated[float, Parameter("1/s", f"{SOURCE}: b", published=True, low=0.0)] = 20.0
    reach_m2: Annotated[float, Parameter("m²", f"{SOURCE}: c", published=True, low=1e-6)] = 0.2


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Velocity: the sum of attractions and repulsions."""
    a, b, c = parameters.attraction_per_s, parameters.repulsion_per_s, parameters.reach_m2
    found, vx, vy = 0, 0.0, 0.0
    for j in range(len(members.ids)):
        if sets[0, j]:
            found += 1
            x, y = members.positions[j, 0], members.positions[j, 1]
            pull = a - b * math.exp(-(x * x + y * y) / c)
            vx += pull * x
            vy += pull * y
    if found == 0:
        return Motion(Kind.STOP, math.nan, math.nan, 0)
    return Motion(Kind.VELOCITY, vx, vy, 1)
