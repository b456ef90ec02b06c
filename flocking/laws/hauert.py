"""Reynolds flocking of fixed-wing robots: separation, alignment, cohesion and migration at a fixed speed.

Source: Hauert et al. 2011, "Reynolds flocking in reality with fixed-wing robots: communication range vs. maximum
turning rate"; Fine 2015, table A.1. Metres and seconds.

The desired heading is that of w1 s + w2 a + w3 c + w4 m: the unit vectors of separation s = the mean over the
neighbours j of (r_i - r_j)/|r_i - r_j|², of alignment a = their mean velocity, of cohesion c = their mean position less
r_i; and m, the whole vector to the migration point, the goal. With the published w4 of 1/500 a goal 500 m away weighs
as much as cohesion, and one kilometres away outweighs all else. The turn of one update is at most the turning rate
times the time since the last one.

Needs positions and velocities; a member without a goal does not migrate. No neighbours: migration alone, or the heading
stays. The robot never stops. The weights are quoted from public replications, which agree on them.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import mean_vector, unit
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

SOURCE = "Hauert et al. 2011"
TOO_SHORT = 1e-12

NEEDS = frozenset({"positions", "velocities", "goal"})
RULES = ("alone", "flock", "migrate", "flock and migrate")
SETS = {"neighbours": "distance-based(0, range_m)"}
TAXONOMY = Taxonomy("homogeneous", "constrained", "discrete", "member", False, True, True, False)
VALIDATION = Validation("SP", False, "local", "local", "-", "unbounded free")
FILLED = (
    Filled(
        "motion computation",
        "table A.1 adds vectors to an angle",
        "the weighted sum of the vectors is the desired heading, as in the original",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "table A.1 prints separation as a sum of inverse lengths, without direction, and cohesion towards the mean "
        "position as if the member stood at the origin",
        "away from each neighbour, in inverse proportion to its distance, and from the member to the mean position",
        misprint=True,
    ),
    Filled(
        "physical motion",
        "table A.1 leaves out the turning rate, of which the publication's title speaks",
        "each turn is cut to what the rate allows",
    ),
)
HERD = Herd(spacing_m=30.0, speed_m_s=10.0, dt_s=0.1)
CREATE = {"range_m": 5.6, "speed_m_s": 0.25, "turn_rate_rad_s": 1.0, "migration_per_m": 0.1}
"""A goal ten metres away weighs as much as cohesion."""


class Parameters(NamedTuple):
    """Of Reynolds flocking with fixed wings."""

    range_m: Annotated[float, Parameter("m", "our choice: communication range, which is varied", low=0.0)] = 100.0
    speed_m_s: Annotated[float, Parameter("m/s", "our choice: of a small fixed-wing robot", low=0.0)] = 10.0
    turn_rate_rad_s: Annotated[float, Parameter("rad/s", "our choice: largest turning rate, varied", low=0.0)] = 0.8
    separation: Annotated[float, Parameter("", f"{SOURCE}: w1", published=True, low=0.0)] = 1.2
    alignment: Annotated[float, Parameter("", f"{SOURCE}: w2", published=True, low=0.0)] = 1.0
    cohesion: Annotated[float, Parameter("", f"{SOURCE}: w3", published=True, low=0.0)] = 1.0
    migration_per_m: Annotated[
        float, Parameter("1/m", f"{SOURCE}: w4, on the whole vector to the migration point", published=True, low=0.0)
    ] = 1.0 / 500.0


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: the weighted sum, as far as the turning rate allows; the speed is fixed."""
    away_x = away_y = 0.0
    for j in range(len(members.ids)):
        if sets[0, j]:
            x, y = members.positions[j, 0], members.positions[j, 1]
            ux, uy = unit(x, y)
            distance = max(math.hypot(x, y), TOO_SHORT)
            away_x -= ux / distance
            away_y -= uy / distance
    found, mean_vx, mean_vy = mean_vector(members.velocities, sets[0])
    found, mean_x, mean_y = mean_vector(members.positions, sets[0])
    sx, sy = unit(away_x, away_y)
    ax, ay = unit(mean_vx, mean_vy)
    cx, cy = unit(mean_x, mean_y)
    x = parameters.separation * sx + parameters.alignment * ax + parameters.cohesion * cx
    y = parameters.separation * sy + parameters.alignment * ay + parameters.cohesion * cy
    rule = 1 if found > 0 else 0
    if not math.isnan(own.goal[0]):
        x += parameters.migration_per_m * own.goal[0]
        y += parameters.migration_per_m * own.goal[1]
        rule += 2
    if math.hypot(x, y) < TOO_SHORT:
        return Motion(Kind.HEADING, 0.0, parameters.speed_m_s, rule)
    most = parameters.turn_rate_rad_s * own.dt
    bearing = min(max(math.atan2(y, x), -most), most)
    return Motion(Kind.HEADING, bearing, parameters.speed_m_s, rule)
