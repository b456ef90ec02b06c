"""Camperi's flock: velocities of the neighbours, cohesion and noise as three vectors, at a constant speed.

Source: Camperi, Cavagna, Giardina, Parisi and Silvestri 2012 (Interface Focus 2); Fine 2015, table A.1.
v(t + dt) = speed * the unit vector along (alignment * sum of v_j + cohesion * sum of f_j + number * noise * e), over
the neighbours without the member itself, with e a unit vector drawn evenly from all directions and f_j the pair force
of `flocking.cohesion`. The publication is in three dimensions; here there are two. Metres, seconds; one step is one
second.

The publication compares neighbours within a distance, the nearest few, and few that are evenly spread around, and finds
the last most stable. Here they are those within a distance whose Voronoi cells touch the member's own; another
selection may be set in their place. With all within the distance, as table A.1 has it, the many that attract from
beyond the nearest ones press a herd into its hard cores.

Neighbours within the hard core outweigh everything. Needs positions and velocities. No neighbours: velocity is kept.
In a kinematic herd members move by the old velocity (`forward`), as in the publication.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.cohesion import BRACKET, FOR_CREATES, ORDER, pair_forces
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import mean_vector, unit
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "velocities"})
RULES = ("alone", "flock", "hard core")
SETS = {"neighbours": "voronoi & distance-based(0, range_m)"}
RELATIONS = ORDER
DRAWS = 1

TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "member", False, True, True, False)
VALIDATION = Validation("S", True, "global", "global", "-", "unbounded free")
FILLED = (
    Filled(
        "neighbour selection",
        "table A.1 has all members within a distance; the publication prefers some that are evenly spread around",
        "of those within the distance the ones whose Voronoi cells touch the member's own; others can be set instead",
    ),
    Filled(
        "motion computation",
        "what becomes of an infinite force among finite ones, and of several infinite ones",
        "the member turns straight away from those within the core, each weighing alike; no noise acts",
    ),
    BRACKET,
    Filled("motion computation", "the formula is undefined without neighbours", "velocity is kept"),
)
HERD = Herd(spacing_m=0.5, speed_m_s=0.05, dt_s=1.0, space="unbounded", updating="forward")
CREATE = {**FOR_CREATES, "noise": 0.5}

SAME_AUTHORS = "our choice: as in Bialek et al. 2012 (PNAS 109), some of the same authors, the same equation"


class Parameters(NamedTuple):
    """Of Camperi's rule."""

    range_m: Annotated[float, Parameter("m", SAME_AUTHORS, low=0.0)] = 1.0
    core_m: Annotated[float, Parameter("m", SAME_AUTHORS, low=0.0)] = 0.2
    equilibrium_m: Annotated[float, Parameter("m", SAME_AUTHORS, low=0.0)] = 0.5
    attraction_m: Annotated[float, Parameter("m", f"{SAME_AUTHORS}; above the equilibrium distance", low=0.0)] = 0.8
    speed_m_s: Annotated[float, Parameter("m/s", SAME_AUTHORS, low=0.0)] = 0.05
    alignment_s_m: Annotated[float, Parameter("s/m", SAME_AUTHORS, low=0.0)] = 35.0
    cohesion: Annotated[float, Parameter("", SAME_AUTHORS, low=0.0)] = 5.0
    noise: Annotated[float, Parameter("", SAME_AUTHORS, low=0.0)] = 1.0


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Velocity: the constant speed along the weighted sum."""
    found, mean_x, mean_y = mean_vector(members.velocities, sets[0])
    if found == 0:
        return Motion(Kind.HOLD, math.nan, math.nan, 0)
    x, y, force_x, force_y = pair_forces(
        members.positions, sets[0], parameters.core_m, parameters.equilibrium_m, parameters.attraction_m
    )
    rule = 2
    if x == 0.0 and y == 0.0:
        rule = 1
        angle = 2.0 * math.pi * u[0]
        x = parameters.alignment_s_m * found * mean_x + parameters.cohesion * force_x
        y = parameters.alignment_s_m * found * mean_y + parameters.cohesion * force_y
        x += found * parameters.noise * math.cos(angle)
        y += found * parameters.noise * math.sin(angle)
    x, y = unit(x, y)
    if x == 0.0 and y == 0.0:
        return Motion(Kind.HOLD, math.nan, math.nan, 0)
    return Motion(Kind.VELOCITY, parameters.speed_m_s * x, parameters.speed_m_s * y, rule)
