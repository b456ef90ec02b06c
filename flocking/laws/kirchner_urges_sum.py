"""Five urges, weighted and added: centring, separation, matching of velocities, the nearest obstacle, migration.

Source: Kirchner 2006, section 2.4.6, equation 2.5, of the urges in `_kirchner_urges`. Metres and seconds, body frame.

Acceleration = Σ w_k urge_k, cut at the physical limit. Equation 2.5 has no weights; the urgency values that the text
names for the other way to combine the urges (`lorek_white`) are its weights here. Urges that point apart cancel out,
which is why the text prefers the other.

Reads positions, velocities, obstacles and the goal, if it has one. Nobody and nothing in view and no goal: it keeps
its motion.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from flocking.laws._kirchner_urges import (
    FOR_CREATES,
    HERD,
    LEFT_OPEN,
    NEEDS,
    NO_ROW,
    SETS,
    Decay,
    Influence,
    MatchingUrgency,
    MatchSpeeds,
    MatesAreObstacles,
    ObstacleAsPrinted,
    RangeM,
    SeparationUrgency,
    TopAcceleration,
    TopSpeed,
    Urgency,
    ViewDeg,
    accelerated,
    avoidance,
    centring,
    matching,
    separation,
)
from flocking.taxonomy import Filled, Taxonomy, Validation
from flocking.terms import count, towards_goal
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

__all__ = ["HERD", "NEEDS", "NO_ROW", "SETS"]

RULES = ("alone", "urges")
ALONE, URGES = range(2)
TAXONOMY = Taxonomy("homogeneous", "constrained", "discrete", "all", False, True, True, False)
VALIDATION = Validation("-", True, "-", "-", "-", "-")
FILLED = (
    *LEFT_OPEN,
    Filled("motion computation", "equation 2.5 has no weights", "urgencies, as of the other way to combine the urges"),
)
CREATE = FOR_CREATES


class Parameters(NamedTuple):
    """Of the weighted sum."""

    range_m: RangeM = 2.4384
    view_deg: ViewDeg = 220.0
    influence: Influence = 1.0
    decay: Decay = 0.5
    centring_weight: Urgency = 0.3
    separation_weight: SeparationUrgency = 0.084
    matching_weight: MatchingUrgency = 0.5
    obstacle_weight: Urgency = 0.2
    migration_weight: Urgency = 0.1
    match_speeds: MatchSpeeds = True
    mates_are_obstacles: MatesAreObstacles = True
    obstacle_as_printed: ObstacleAsPrinted = False
    top_acceleration_m_s2: TopAcceleration = 0.5
    top_speed_m_s: TopSpeed = 0.8


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Acceleration: the sum of all urges."""
    p = parameters
    flockmates = sets[0]
    near, away_x, away_y = avoidance(members, flockmates, obstacles, p)
    bound, to_x, to_y = towards_goal(own.goal)
    if not (near or bound or count(flockmates) > 0):
        return Motion(Kind.HOLD, math.nan, math.nan, ALONE)
    in_x, in_y = centring(members, flockmates, p)
    apart_x, apart_y = separation(members, flockmates, p)
    with_x, with_y = matching(own, members, flockmates, p)
    x = p.centring_weight * in_x + p.separation_weight * apart_x + p.matching_weight * with_x
    y = p.centring_weight * in_y + p.separation_weight * apart_y + p.matching_weight * with_y
    x += p.obstacle_weight * away_x + p.migration_weight * to_x
    y += p.obstacle_weight * away_y + p.migration_weight * to_y
    return accelerated(own, x, y, p, URGES)
