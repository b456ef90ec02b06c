"""Five urges by priority: the nearest obstacle, separation, matching of velocities, centring, migration.

Source: Lorek and White 1993, as Kirchner 2006 has it in section 2.4.6, of the urges in `_kirchner_urges`. Metres and
seconds, body frame.

The urges, each times its urgency, are added in that order. As soon as the sum exceeds the physical limit of
acceleration the rest is left out, and the member accelerates at the limit in the direction reached: a strong urge to
avoid cannot be balanced by migration or centring, as it can in `kirchner_urges_sum`.

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
from flocking.terms import count, length_of, towards_goal
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

__all__ = ["HERD", "NEEDS", "NO_ROW", "SETS"]

RULES = ("alone", "obstacle", "separation", "matching", "centring", "all urges")
"""The urge after which the rest was left out."""
ALONE, OBSTACLE, SEPARATION, MATCHING, CENTRING, ALL = range(6)
TAXONOMY = Taxonomy("homogeneous", "constrained", "discrete", "all", False, True, True, False)
VALIDATION = Validation("S", True, "global", "global", "-", "-")
FILLED = (
    *LEFT_OPEN,
    Filled(
        "motion computation",
        "the order: avoidance of flockmates and of obstacles first, the figure with the rest is lost",
        "obstacle, separation, then matching, centring and migration, as in Reynolds 1987",
    ),
)
CREATE = FOR_CREATES


class Parameters(NamedTuple):
    """Of the hierarchy."""

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
    """Acceleration: the urges one after the other, until their sum exceeds the limit."""
    p, top = parameters, parameters.top_acceleration_m_s2
    flockmates = sets[0]
    near, x, y = avoidance(members, flockmates, obstacles, p)
    bound, to_x, to_y = towards_goal(own.goal)
    if not (near or bound or count(flockmates) > 0):
        return Motion(Kind.HOLD, math.nan, math.nan, ALONE)
    x, y = p.obstacle_weight * x, p.obstacle_weight * y
    if length_of(x, y) > top:
        return accelerated(own, x, y, p, OBSTACLE)
    add_x, add_y = separation(members, flockmates, p)
    x, y = x + p.separation_weight * add_x, y + p.separation_weight * add_y
    if length_of(x, y) > top:
        return accelerated(own, x, y, p, SEPARATION)
    add_x, add_y = matching(own, members, flockmates, p)
    x, y = x + p.matching_weight * add_x, y + p.matching_weight * add_y
    if length_of(x, y) > top:
        return accelerated(own, x, y, p, MATCHING)
    add_x, add_y = centring(members, flockmates, p)
    x, y = x + p.centring_weight * add_x, y + p.centring_weight * add_y
    if length_of(x, y) > top:
        return accelerated(own, x, y, p, CENTRING)
    return accelerated(own, x + p.migration_weight * to_x, y + p.migration_weight * to_y, p, ALL)
