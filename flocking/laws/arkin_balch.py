"""Formation by motor schemas: goal, obstacles, robots, noise and a place in the formation as vectors that add up.

Source: Balch and Arkin 1998 (cited by Fine 2015 as Arkin and Balch 1999); Fine 2015, section 3.4.1, which does not
formalise it. Metres and seconds, body frame. Gains and radii are those of its simulations.

Velocity = speed · Σ gain · vector, no longer than the speed. Vectors: towards the goal, length 1; away from each
obstacle and each robot nearer than its sphere of influence S, length (S − d) / (S − M); a drawn direction, held for
some updates, length 1; towards the own place in the formation, length 0 within the dead zone, 1 beyond the controlled
zone and linear in between. An obstacle or robot nearer than its minimum range M repels without bound: then only flight
from those counts, at full speed.

The formation (0 line, 1 column, 2 wedge, 3 diamond) is centred on the mean position of all members and the focal one,
points from there to the goal, and gives its places in the order of ids. Reads positions, ids, obstacles and the goal;
without a goal the formation points where the member does. No neighbours: its place is where it is; goal, obstacles and
noise remain.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.compilation import compiled
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import limited, rotated, towards_goal, unit
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "ids", "goal", "obstacles"})
RULES = ("schemas", "flight")
SETS = {"team": "all", "near": "distance-based(0, robot_sphere_m)"}
TEAM, NEAR = range(2)
MEMORY = 2
DIRECTION, UPDATES_LEFT = range(2)
DRAWS = 1
CHIRAL = True
RELATIONS = (
    "obstacle_least_m at most obstacle_sphere_m",
    "robot_least_m at most robot_sphere_m",
    "dead_m at most controlled_m",
)

LINE, COLUMN, WEDGE, DIAMOND = range(4)
TABLE = "Balch and Arkin 1998, parameters of the simulations"


class Parameters(NamedTuple):
    """Of the motor schemas."""

    formation: Annotated[int, Parameter("", "our choice: 0 line, 1 column, 2 wedge, 3 diamond", low=0, high=3)] = WEDGE
    speed_m_s: Annotated[float, Parameter("m/s", "our choice: speed of a vector of length 1", low=0.0)] = 1.0
    goal_gain: Annotated[float, Parameter("", TABLE, published=True, low=0.0)] = 0.8
    obstacle_gain: Annotated[float, Parameter("", TABLE, published=True, low=0.0)] = 1.5
    obstacle_sphere_m: Annotated[float, Parameter("m", TABLE, published=True, low=0.0)] = 50.0
    obstacle_least_m: Annotated[float, Parameter("m", TABLE, published=True, low=0.0)] = 5.0
    robot_gain: Annotated[float, Parameter("", TABLE, published=True, low=0.0)] = 2.0
    robot_sphere_m: Annotated[float, Parameter("m", TABLE, published=True, low=0.0)] = 20.0
    robot_least_m: Annotated[float, Parameter("m", TABLE, published=True, low=0.0)] = 5.0
    noise_gain: Annotated[float, Parameter("", TABLE, published=True, low=0.0)] = 0.1
    noise_updates: Annotated[int, Parameter("", f"{TABLE}: persistence", published=True, low=1)] = 6
    formation_gain: Annotated[float, Parameter("", TABLE, published=True, low=0.0)] = 1.0
    spacing_m: Annotated[float, Parameter("m", TABLE, published=True, low=0.0)] = 50.0
    controlled_m: Annotated[
        float, Parameter("m", f"{TABLE}: radius of the controlled zone", published=True, low=0.0)
    ] = 25.0
    dead_m: Annotated[float, Parameter("m", f"{TABLE}: radius of the dead zone", published=True, low=0.0)] = 0.0


TAXONOMY = Taxonomy("homogeneous", "constrained", "continuous", "all", True, True, False, False)
VALIDATION = Validation("SP", False, "global", "-", "-", "unbounded obstacles")
FILLED = (
    Filled(
        "motion computation",
        "the gain of the attraction to the goal is variable, high when heading for the goal",
        "one constant gain, that of the simulations",
    ),
    Filled(
        "motion computation",
        "within the minimum range the repulsion is infinite",
        "the other schemas are dropped and the member flees from what is so near at full speed",
    ),
    Filled(
        "motion computation",
        "the way from the sum of the vectors to a speed",
        "a length of 1 is the full speed, longer sums are cut",
    ),
    Filled(
        "motion computation",
        "formations are drawn for four robots, their places by id",
        "any number: places by the order of the ids; wedges grow backwards, further diamonds stand behind the first",
    ),
    Filled(
        "motion computation",
        "which way the formation points",
        "from its centre to the goal; without one where the member points",
    ),
    Filled("motion computation", "in what frame the noise persists", "in the body's"),
)
HERD = Herd(50.0, 1.0, 0.5)
CREATE = {
    "speed_m_s": 0.25,
    "obstacle_sphere_m": 0.8,
    "obstacle_least_m": 0.25,
    "robot_sphere_m": 0.7,
    "robot_least_m": 0.4,
    "spacing_m": 0.9,
    "controlled_m": 0.5,
    "dead_m": 0.05,
}


@compiled
def place(formation: int, rank: int) -> tuple[float, float]:
    """Where the member of that rank stands, in spacings, x forward and y left; not centred."""
    if formation == LINE:
        return 0.0, -1.0 * rank
    if formation == COLUMN:
        return -1.0 * rank, 0.0
    if formation == WEDGE:
        row = (rank + 1) // 2
        return -1.0 * row, 1.0 * row if rank % 2 == 1 else -1.0 * row
    half, corner = math.sqrt(0.5), rank % 4
    centre = -3.0 * (rank // 4)
    if corner == 0:
        return centre + half, 0.0
    if corner == 3:
        return centre - half, 0.0
    return centre, half if corner == 1 else -half


@compiled
def centred_place(formation: int, rank: int, count: int) -> tuple[float, float]:
    """The same with the mean of the places of all `count` members at (0, 0)."""
    mean_x, mean_y = 0.0, 0.0
    for other in range(count):
        x, y = place(formation, other)
        mean_x, mean_y = mean_x + x / count, mean_y + y / count
    x, y = place(formation, rank)
    return x - mean_x, y - mean_y


@compiled
def to_place(own: Own, members: Members, team: Bools, formation: int, spacing: float) -> tuple[float, float]:
    """The vector from the member to its place in the formation, m."""
    count, rank, centre_x, centre_y = 1, 0, 0.0, 0.0
    for j in range(len(team)):
        if team[j]:
            count += 1
            rank += members.ids[j] < own.id
            centre_x += members.positions[j, 0]
            centre_y += members.positions[j, 1]
    centre_x, centre_y = centre_x / count, centre_y / count
    course = 0.0
    if not math.isnan(own.goal[0]):
        course = math.atan2(own.goal[1] - centre_y, own.goal[0] - centre_x)
    x, y = centred_place(formation, rank, count)
    x, y = rotated(spacing * x, spacing * y, course)
    return centre_x + x, centre_y + y


@compiled
def strength_away(x: float, y: float, sphere: float, least: float) -> float:
    """Length of the vector away from an obstacle or robot at (x, y); inf within the minimum range."""
    distance = math.hypot(x, y)
    if distance == 0.0 or distance >= sphere:
        return 0.0
    return math.inf if distance <= least else (sphere - distance) / (sphere - least)


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Velocity along the sum of the schemas' vectors."""
    if memory[UPDATES_LEFT] <= 0.0:
        memory[DIRECTION] = 2.0 * math.pi * u[0]
        memory[UPDATES_LEFT] = parameters.noise_updates
    memory[UPDATES_LEFT] -= 1.0
    x = parameters.noise_gain * math.cos(memory[DIRECTION])
    y = parameters.noise_gain * math.sin(memory[DIRECTION])

    flight_x, flight_y = 0.0, 0.0
    for k in range(len(obstacles.points)):
        px, py = obstacles.points[k, 0], obstacles.points[k, 1]
        strength = strength_away(px, py, parameters.obstacle_sphere_m, parameters.obstacle_least_m)
        away_x, away_y = unit(-px, -py)
        if strength == math.inf:
            flight_x, flight_y = flight_x + away_x, flight_y + away_y
        else:
            x += parameters.obstacle_gain * strength * away_x
            y += parameters.obstacle_gain * strength * away_y
    for j in range(len(members.ids)):
        px, py = members.positions[j, 0], members.positions[j, 1]
        strength = strength_away(px, py, parameters.robot_sphere_m, parameters.robot_least_m)
        away_x, away_y = unit(-px, -py)
        if sets[NEAR, j] and strength == math.inf:
            flight_x, flight_y = flight_x + away_x, flight_y + away_y
        elif sets[NEAR, j]:
            x += parameters.robot_gain * strength * away_x
            y += parameters.robot_gain * strength * away_y
    flight_x, flight_y = unit(flight_x, flight_y)
    if flight_x != 0.0 or flight_y != 0.0:
        return Motion(Kind.VELOCITY, parameters.speed_m_s * flight_x, parameters.speed_m_s * flight_y, 1)
    has_goal, goal_x, goal_y = towards_goal(own.goal)
    if has_goal:
        x, y = x + parameters.goal_gain * goal_x, y + parameters.goal_gain * goal_y

    place_x, place_y = to_place(own, members, sets[TEAM], parameters.formation, parameters.spacing_m)
    distance = math.hypot(place_x, place_y)
    if distance > parameters.dead_m:
        strength = 1.0
        if distance < parameters.controlled_m:
            strength = (distance - parameters.dead_m) / (parameters.controlled_m - parameters.dead_m)
        x += parameters.formation_gain * strength * place_x / distance
        y += parameters.formation_gain * strength * place_y / distance
    x, y = limited(x, y, 1.0)
    return Motion(Kind.VELOCITY, parameters.speed_m_s * x, parameters.speed_m_s * y, 0)
