"""Stable flocking over a fixed graph: each member matches the velocities of its neighbours and keeps its distance.

Source: Tanner, Jadbabaie and Pappas 2003, "Stable flocking of mobile agents, part I: fixed topology"; Fine 2015,
table A.1. Point masses of unit mass; metres and seconds, which the publication leaves open.

Acceleration = sum over the neighbours j of w (v_j - v_i), less the gradient of K (s²/d² + log(d²/s²)), where d is the
distance to j, s the distance of least potential and K the potential's strength. With K = s = w = 1 it is the
publication's. The sum of the potentials and the kinetic energy never grows, and while the graph is connected all
velocities become equal.

Needs positions and velocities; the selection needs ids. No neighbours: both sums are empty, so the member keeps its
velocity. The graph is to be undirected: if i has the neighbour j, j has the neighbour i.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.compilation import compiled
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import unit
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

SOURCE = "Tanner, Jadbabaie and Pappas 2003, part I"

NEEDS = frozenset({"positions", "velocities"})
RULES = ("none", "flock")
SETS = {"neighbours": "fixed-set"}
RELATIONS = ("closest_m below spacing_m",)
TAXONOMY = Taxonomy("homogeneous", "idealized", "continuous", "member", True, True, True, True)
VALIDATION = Validation("MS", True, "global", "global", "global", "bounded free")
SIGN = Filled(
    "motion computation",
    "table A.1 prints v_i - v_j, which drives velocities apart",
    "v_j - v_i, as in the original",
    misprint=True,
)
BOUNDED = Filled(
    "physical motion",
    "continuous time, in which a repulsion without bound prevents collisions",
    "nearer than closest_m the repulsion stays as it is there, so that a time step cannot throw a member away",
)
FILLED = (
    Filled(
        "sensing",
        "how a member comes to know positions and velocities",
        "they are known without error; headings, which table 3.2 lists, are not read",
    ),
    SIGN,
    Filled(
        "motion computation",
        "table A.1 prints 1 / (d² + log d²), constant beyond a range, which has no minimum at which to flock",
        "1/d² + log d², as in the original; over a fixed graph it has no range",
        misprint=True,
    ),
    BOUNDED,
)
HERD = Herd(spacing_m=1.0, speed_m_s=0.5, dt_s=0.01)
CREATE = {"spacing_m": 0.8, "strength_m2_s2": 0.05, "alignment_per_s": 0.5, "closest_m": 0.4}

ClosestM = Annotated[float, Parameter("m", "our choice: a quarter of the spacing", low=1e-6)]


class Parameters(NamedTuple):
    """Of Tanner's law over a fixed graph."""

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


@compiled
def attraction(distance: float, spacing_m: float, strength_m2_s2: float, closest_m: float) -> float:
    """Slope of the potential, m/s²: above 0 the pair attracts, below it repels."""
    gap = max(distance, closest_m)
    ratio = spacing_m / gap
    return 2.0 * strength_m2_s2 / gap * (1.0 - ratio * ratio)


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Acceleration by the potential's gradient and by the differences of velocity."""
    weight = parameters.alignment_per_s
    found, ax, ay = 0, 0.0, 0.0
    for j in range(len(members.ids)):
        if not sets[0, j]:
            continue
        found += 1
        x, y = members.positions[j, 0], members.positions[j, 1]
        ux, uy = unit(x, y)
        pull = attraction(math.hypot(x, y), parameters.spacing_m, parameters.strength_m2_s2, parameters.closest_m)
        ax += weight * (members.velocities[j, 0] - own.velocity[0]) + pull * ux
        ay += weight * (members.velocities[j, 1] - own.velocity[1]) + pull * uy
    if found == 0:
        return Motion(Kind.HOLD, math.nan, math.nan, 0)
    return Motion(Kind.ACCELERATION, ax, ay, 1)
