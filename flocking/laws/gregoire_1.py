"""Gregoire's first model: alignment and cohesion, and noise on the angle.

Source: Gregoire, Chate and Tu 2003 (Physica D 181); Fine 2015, table A.1, "Model 1". Heading(t + dt) = direction of
(alignment * sum of v_j + cohesion * sum of f_j) + noise * xi, with xi drawn evenly from [-pi, pi]; the speed is
constant, so that v_j is the speed along the heading of j. The pair force f_j is that of `flocking.cohesion`: hard
core, spring about the equilibrium distance, constant attraction. Metres, seconds; one step is one second.

Neighbours are those within the radius whose Voronoi cells touch the member's own, as in the publication. With all
within the radius, as table A.1 has it, the many that attract from beyond the nearest ones press a herd into its hard
cores, where nobody aligns.

Neighbours within the hard core outweigh everything: the member turns straight away from them. The sum of the v_j takes
in the member itself.

Needs positions and headings. No neighbours: straight on, with noise alone. Sums that cancel out exactly: the member's
own heading is kept.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.angles import wrap
from flocking.cohesion import ORDER, pair_forces
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
    Filled(
        "motion computation",
        "table A.1 closes the bracket of the distance in the wrong place and calls the member's position a region",
        "a condition on the distance between the two",
        misprint=True,
    ),
    Filled("motion computation", "whether the member itself belongs to the sum of velocities", "it does"),
)
HERD = Herd(spacing_m=0.5, speed_m_s=0.05, dt_s=1.0, space="periodic")
CREATE = {
    "range_m": 2.5,
    "core_m": 0.4,
    "equilibrium_m": 0.9,
    "attraction_m": 1.4,
    "speed_m_s": 0.25,
    "alignment_s_m": 7.0,
    "noise": 0.1,
}

PUBLICATION = "Gregoire, Chate and Tu 2003"
SAME_GROUP = "our choice: as in Bialek et al. 2012 (PNAS 109), who use this model; swept in the publication"


class Parameters(NamedTuple):
    """Of Gregoire's first model."""

    range_m: Annotated[float, Parameter("m", f"{PUBLICATION}: the unit of length", published=True, low=0.0)] = 1.0
    core_m: Annotated[float, Parameter("m", PUBLICATION, published=True, low=0.0)] = 0.2
    equilibrium_m: Annotated[float, Parameter("m", PUBLICATION, published=True, low=0.0)] = 0.5
    attraction_m: Annotated[
        float, Parameter("m", f"{PUBLICATION}; above the equilibrium distance", published=True, low=0.0)
    ] = 0.8
    speed_m_s: Annotated[float, Parameter("m/s", PUBLICATION, published=True, low=0.0)] = 0.05
    alignment_s_m: Annotated[float, Parameter("s/m", SAME_GROUP, low=0.0)] = 35.0
    cohesion: Annotated[float, Parameter("", SAME_GROUP, low=0.0)] = 5.0
    noise: Annotated[float, Parameter("", "our choice: a share of half a turn", low=0.0, high=1.0)] = 0.1


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: of the weighted sum, turned by uniform noise."""
    x, y, force_x, force_y = pair_forces(
        members.positions, sets[0], parameters.core_m, parameters.equilibrium_m, parameters.attraction_m
    )
    rule = 1
    if x == 0.0 and y == 0.0:
        rule = 0
        found, mean_x, mean_y = mean_direction(members.headings, sets[0])
        weight = parameters.alignment_s_m * parameters.speed_m_s
        x = weight * (found * mean_x + 1.0) + parameters.cohesion * force_x
        y = weight * found * mean_y + parameters.cohesion * force_y
    noise = parameters.noise * 2.0 * math.pi * (u[0] - 0.5)
    return Motion(Kind.HEADING, wrap(math.atan2(y, x) + noise), parameters.speed_m_s, rule)
