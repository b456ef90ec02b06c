"""Gregoire's second model: alignment, cohesion and noise as three vectors, of which the sum is the heading.

Source: Gregoire, Chate and Tu 2003 (Physica D 181); Fine 2015, table A.1, "Model 2". Heading(t + dt) = direction of
(alignment * sum of v_j + cohesion * sum of f_j + number * noise * e), with e a unit vector drawn evenly from all
directions: whoever has neighbours that agree feels it less. Neighbours, speed, v_j, f_j and hard core are those of
Gregoire's first model. Metres, seconds; one step is one second.

The sum of the v_j, and the number, take in the member itself. Needs positions and headings. No neighbours: the
member's own velocity and noise.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.cohesion import ORDER, pair_forces
from flocking.laws.gregoire_1 import FILLED as FORCE_FILLED
from flocking.laws.gregoire_1 import PUBLICATION, SAME_GROUP
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import mean_direction
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "headings"})
RULES = ("flock", "hard core")
SETS = {"neighbours": "voronoi & distance-based(0, range_m)"}
RELATIONS = ORDER
DRAWS = 1

TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "member", False, True, False, True)
VALIDATION = Validation("S", True, "global", "constant", "global", "periodic free")
FILLED = (
    *FORCE_FILLED,
    Filled(
        "motion computation",
        "whether noise acts beside an infinite force",
        "it does not: it is finite",
    ),
)
HERD = Herd(spacing_m=0.5, speed_m_s=0.05, dt_s=1.0, space="periodic")
CREATE = {
    "range_m": 2.5,
    "core_m": 0.4,
    "equilibrium_m": 0.9,
    "attraction_m": 1.4,
    "speed_m_s": 0.25,
    "alignment_s_m": 7.0,
    "noise": 0.5,
}


class Parameters(NamedTuple):
    """Of Gregoire's second model."""

    range_m: Annotated[float, Parameter("m", f"{PUBLICATION}: the unit of length", published=True, low=0.0)] = 1.0
    core_m: Annotated[float, Parameter("m", PUBLICATION, published=True, low=0.0)] = 0.2
    equilibrium_m: Annotated[float, Parameter("m", PUBLICATION, published=True, low=0.0)] = 0.5
    attraction_m: Annotated[
        float, Parameter("m", f"{PUBLICATION}; above the equilibrium distance", published=True, low=0.0)
    ] = 0.8
    speed_m_s: Annotated[float, Parameter("m/s", PUBLICATION, published=True, low=0.0)] = 0.05
    alignment_s_m: Annotated[float, Parameter("s/m", SAME_GROUP, low=0.0)] = 35.0
    cohesion: Annotated[float, Parameter("", SAME_GROUP, low=0.0)] = 5.0
    noise: Annotated[float, Parameter("", SAME_GROUP, low=0.0)] = 1.0


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: of the weighted sum, noise in it."""
    x, y, force_x, force_y = pair_forces(
        members.positions, sets[0], parameters.core_m, parameters.equilibrium_m, parameters.attraction_m
    )
    rule = 1
    if x == 0.0 and y == 0.0:
        rule = 0
        found, mean_x, mean_y = mean_direction(members.headings, sets[0])
        weight = parameters.alignment_s_m * parameters.speed_m_s
        noise = parameters.noise * (found + 1)
        angle = 2.0 * math.pi * u[0]
        x = weight * (found * mean_x + 1.0) + parameters.cohesion * force_x + noise * math.cos(angle)
        y = weight * found * mean_y + parameters.cohesion * force_y + noise * math.sin(angle)
    return Motion(Kind.HEADING, math.atan2(y, x), parameters.speed_m_s, rule)
