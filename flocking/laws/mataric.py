"""Flocking out of basic behaviours: avoid first, else follow, aggregate, disperse, home and wander, weighted.

Source: Mataric 1993; Fine 2015, section 3.4.1, which does not formalise it. Metres and seconds, body frame.

Safe-wandering: an obstacle or a member ahead and near on one side: turn to the other side and go. On both sides, or
dead ahead: back up and turn, to the side whose nearest thing is farther, to a drawn side where they are equally far.
With the way free: turn to the weighted sum of unit vectors towards the member followed, towards the centre of all
members if it is farther than a distance, away from the centre of those too near, towards home, and straight ahead but
for a drawn turn (wandering); go at the cruising speed.

Reads positions, obstacles and the goal (home). No neighbours: wandering, and homing where there is a home.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.compilation import compiled
from flocking.geometry import NOT_FOUND, nearest
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import mean_vector, towards_goal, unit
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "goal", "obstacles"})
RULES = ("wander", "avoid", "back up", "flock")
SETS = {
    "near": "distance-based(0, avoid_m) & angle(90)",
    "follow": "distance-based(0, follow_m) & angle(follow_angle_deg) & nearest",
    "aggregate": "distance-based(0, sight_m)",
    "disperse": "distance-based(0, disperse_m)",
}
NEAR, FOLLOW, AGGREGATE, DISPERSE = range(4)
WANDERING, AVOIDING, BACKING, FLOCKING = range(4)
DRAWS = 2

OURS = "our choice: the publication's words give no number"


class Parameters(NamedTuple):
    """Of the basic behaviours."""

    speed_m_s: Annotated[float, Parameter("m/s", OURS, low=0.0)] = 0.2
    avoid_m: Annotated[float, Parameter("m", f"{OURS}; what is nearer and ahead is avoided", low=0.0)] = 0.45
    avoid_turn_rad: Annotated[float, Parameter("rad", f"{OURS}; turn of avoiding", low=0.0, high=math.pi)] = 0.6
    back_turn_rad: Annotated[float, Parameter("rad", f"{OURS}; turn of backing up", low=0.0, high=math.pi)] = 0.9
    back_speed_m_s: Annotated[float, Parameter("m/s", f"{OURS}; 0 = turn on the spot", low=0.0)] = 0.05
    follow_m: Annotated[float, Parameter("m", f"{OURS}; reach of following", low=0.0)] = 1.5
    follow_angle_deg: Annotated[
        float, Parameter("deg", f"{OURS}; following looks ahead by this to either side", low=0.0, high=180.0)
    ] = 60.0
    follow_weight: Annotated[float, Parameter("", OURS, low=0.0)] = 0.5
    sight_m: Annotated[float, Parameter("m", f"{OURS}; reach of aggregating", low=0.0)] = 4.0
    aggregate_m: Annotated[float, Parameter("m", f"{OURS}; a centre nearer than this is near enough", low=0.0)] = 0.8
    aggregate_weight: Annotated[float, Parameter("", OURS, low=0.0)] = 1.0
    disperse_m: Annotated[float, Parameter("m", f"{OURS}; members nearer than this are left", low=0.0)] = 0.7
    disperse_weight: Annotated[float, Parameter("", OURS, low=0.0)] = 1.0
    home_weight: Annotated[float, Parameter("", OURS, low=0.0)] = 1.0
    wander_weight: Annotated[float, Parameter("", OURS, low=0.0)] = 0.5
    wander_turn_rad: Annotated[float, Parameter("rad", f"{OURS}; the largest drawn turn", low=0.0, high=math.pi)] = 0.4


TAXONOMY = Taxonomy("homogeneous", "constrained", "continuous", "all", False, True, False, False)
VALIDATION = Validation("P", False, "local", "-", "local", "bounded free")
FILLED = (
    Filled(
        "motion computation",
        "turn, go and back up have no angle and no speed",
        "a turn, a speed and a backward speed as parameters; a whole turn is decided at each computation",
    ),
    Filled(
        "motion computation",
        "an obstacle on one side and a member on the other: both rules of avoidance apply and disagree",
        "obstacles and members count alike; with things on both sides the robot backs up and turns to the freer side",
    ),
    Filled(
        "motion computation",
        "how the outputs of the basic behaviours are combined",
        "avoidance takes precedence; the others are unit vectors, weighted and added",
    ),
    Filled(
        "motion computation",
        "what following follows, and what aggregation and dispersion measure",
        "the nearest member in a sector ahead; the distance of the centre of all; the centre of those too near",
    ),
    Filled("neighbour selection", "no reach is given for any behaviour", "one reach each, in metres"),
)
HERD = Herd(1.0, 0.2, 0.1, "bounded")
CREATE: dict[str, float] = {}


@compiled
def on_sides(x: float, y: float, left: float, right: float) -> tuple[float, float]:
    """The smaller of the given distances and that of (x, y), on the side where it is; dead ahead it is on both."""
    distance = math.hypot(x, y)
    if distance > 0.0:
        if y >= 0.0:
            left = min(left, distance)
        if y <= 0.0:
            right = min(right, distance)
    return left, right


@compiled
def sides(members: Members, near: Bools, obstacles: Obstacles, reach: float) -> tuple[float, float]:
    """Distance of the nearest thing ahead on the left and on the right, inf where there is none."""
    left, right = math.inf, math.inf
    for k in range(len(obstacles.points)):
        x, y = obstacles.points[k, 0], obstacles.points[k, 1]
        if x > 0.0 and x * x + y * y < reach * reach:
            left, right = on_sides(x, y, left, right)
    for j in range(len(near)):
        if near[j]:
            left, right = on_sides(members.positions[j, 0], members.positions[j, 1], left, right)
    return left, right


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: away from what is near, else along the weighted sum."""
    left, right = sides(members, sets[NEAR], obstacles, parameters.avoid_m)
    if left < math.inf and right < math.inf:
        turn = parameters.back_turn_rad
        if left < right or (left == right and u[1] < 0.5):
            turn = -turn
        return Motion(Kind.HEADING, turn, -parameters.back_speed_m_s, BACKING)
    if left < math.inf:
        return Motion(Kind.HEADING, -parameters.avoid_turn_rad, parameters.speed_m_s, AVOIDING)
    if right < math.inf:
        return Motion(Kind.HEADING, parameters.avoid_turn_rad, parameters.speed_m_s, AVOIDING)

    turn = parameters.wander_turn_rad * (2.0 * u[0] - 1.0)
    sum_x, sum_y = parameters.wander_weight * math.cos(turn), parameters.wander_weight * math.sin(turn)
    rule = WANDERING
    leader = nearest(members.positions, sets[FOLLOW])
    if leader != NOT_FOUND:
        ex, ey = unit(members.positions[leader, 0], members.positions[leader, 1])
        sum_x, sum_y, rule = sum_x + parameters.follow_weight * ex, sum_y + parameters.follow_weight * ey, FLOCKING
    found, cx, cy = mean_vector(members.positions, sets[AGGREGATE])
    if found > 0 and math.hypot(cx, cy) > parameters.aggregate_m:
        ex, ey = unit(cx, cy)
        sum_x, sum_y, rule = (
            sum_x + parameters.aggregate_weight * ex,
            sum_y + parameters.aggregate_weight * ey,
            FLOCKING,
        )
    found, cx, cy = mean_vector(members.positions, sets[DISPERSE])
    if found > 0:
        ex, ey = unit(cx, cy)
        sum_x, sum_y, rule = sum_x - parameters.disperse_weight * ex, sum_y - parameters.disperse_weight * ey, FLOCKING
    has_home, ex, ey = towards_goal(own.goal)
    if has_home:
        sum_x, sum_y = sum_x + parameters.home_weight * ex, sum_y + parameters.home_weight * ey
    if sum_x == 0.0 and sum_y == 0.0:
        return Motion(Kind.HOLD, math.nan, math.nan, rule)
    return Motion(Kind.HEADING, math.atan2(sum_y, sum_x), parameters.speed_m_s, rule)
