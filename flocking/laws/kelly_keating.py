"""A hierarchy of behaviours in which whoever sees nobody ahead leads: avoid, lead, keep position, catch up.

Source: Kelly and Keating 1996; Fine 2015, section 3.4.1, which does not formalise it. Metres and seconds, body frame.

The first that applies: (1) an obstacle or a member near and ahead: turn away from the nearest; (2) nobody to follow:
lead, straight ahead but for a drawn turn; (3) in a flock: keep position, that is move with the mean velocity of the
members of the flock to be followed, corrected towards the spacing from the nearest of them; (4) a flock in the
distance: head for its nearest member, faster.

Leaders are elected at each computation: a member ahead is followed unless each of the two is ahead of the other; then
the one with the larger id follows. So two that meet do not chase each other, and a leader that turns into the flock
hands over to who is then ahead.

Reads positions, headings, velocities, ids and obstacles. No neighbours: it leads.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.angles import wrap
from flocking.compilation import compiled
from flocking.geometry import NOT_FOUND, before, nearest
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import limited
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "headings", "velocities", "ids", "obstacles"})
RULES = ("lead", "avoid", "keep position", "catch up")
SETS = {
    "near": "distance-based(0, avoid_m) & angle(90)",
    "flock": "distance-based(0, flock_m) & angle(ahead_deg)",
    "distant": "distance-based(flock_m, sight_m) & angle(ahead_deg)",
}
NEAR, FLOCK, DISTANT = range(3)
RELATIONS = ("flock_m at most sight_m", "speed_m_s at most fast_m_s")
LEADING, AVOIDING, KEEPING, CATCHING_UP = range(4)
DRAWS = 2

OURS = "our choice: the publication's words give no number"


class Parameters(NamedTuple):
    """Of the hierarchy."""

    speed_m_s: Annotated[float, Parameter("m/s", f"{OURS}; of a leader", low=0.0)] = 0.2
    fast_m_s: Annotated[float, Parameter("m/s", f"{OURS}; to speed up is this, and nobody is faster", low=0.0)] = 0.35
    avoid_m: Annotated[float, Parameter("m", f"{OURS}; what is nearer and ahead is avoided", low=0.0)] = 0.4
    avoid_turn_rad: Annotated[float, Parameter("rad", OURS, low=0.0, high=math.pi)] = 0.6
    wander_turn_rad: Annotated[float, Parameter("rad", f"{OURS}; the largest drawn turn", low=0.0, high=math.pi)] = 0.1
    ahead_deg: Annotated[float, Parameter("deg", f"{OURS}; ahead is this to either side", low=0.0, high=180.0)] = 60.0
    flock_m: Annotated[float, Parameter("m", f"{OURS}; a flock nearer is one's own", low=0.0)] = 1.5
    sight_m: Annotated[float, Parameter("m", f"{OURS}; reach of the infrared", low=0.0)] = 5.0
    spacing_m: Annotated[float, Parameter("m", f"{OURS}; kept from the nearest one followed", low=0.0)] = 0.8
    spacing_gain: Annotated[float, Parameter("1/s", OURS, low=0.0)] = 0.5


TAXONOMY = Taxonomy("homogeneous", "constrained", "continuous", "all", True, True, True, True)
VALIDATION = Validation("P", False, "local", "inferred", "inferred", "bounded free")
FILLED = (
    Filled(
        "motion computation",
        "to try to maintain position in a flock",
        "the mean velocity of those followed, and a correction towards a spacing from the nearest of them",
    ),
    Filled("motion computation", "to speed up towards a flock in the distance", "a faster speed, straight for it"),
    Filled(
        "motion computation",
        "who leads, when two see each other ahead",
        "the smaller id; anybody who has nobody to follow leads too",
    ),
    Filled(
        "neighbour selection", "what is ahead, near, a flock and a flock in the distance", "an angle and three reaches"
    ),
    Filled(
        "motion computation", "the turn of avoiding", "a fixed one, away from the nearest; a drawn side if dead ahead"
    ),
)
HERD = Herd(1.0, 0.2, 0.1, "bounded")
CREATE: dict[str, float] = {}


@compiled
def followed(own: Own, members: Members, j: int, ahead: float) -> bool:
    """Whether member j, which is ahead, is to be followed: not if the own place is ahead of it and the id smaller."""
    back = math.atan2(-members.positions[j, 1], -members.positions[j, 0])
    mutual = abs(wrap(back - members.headings[j])) < ahead
    return not mutual or members.ids[j] < own.id


@compiled
def nearest_ahead(points: Floats, reach: float) -> int:
    """Row of the nearest obstacle ahead within `reach`, `NOT_FOUND` if there is none."""
    best = NOT_FOUND
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        if x > 0.0 and x * x + y * y < reach * reach and (best == NOT_FOUND or before(points, k, best)):
            best = k
    return best


@compiled
def flock_to_follow(own: Own, members: Members, chosen: Bools, ahead: float) -> tuple[int, float, float]:
    """Row of the nearest member to be followed among the chosen ones, and the mean velocity of all of these."""
    best, count, vx, vy = NOT_FOUND, 0, 0.0, 0.0
    for j in range(len(chosen)):
        if chosen[j] and followed(own, members, j, ahead):
            count += 1
            vx += members.velocities[j, 0]
            vy += members.velocities[j, 1]
            if best == NOT_FOUND or before(members.positions, j, best):
                best = j
    if count == 0:
        return NOT_FOUND, 0.0, 0.0
    return best, vx / count, vy / count


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """The first of the four behaviours that applies."""
    threat_x, threat_y, threat = 0.0, 0.0, math.inf
    k = nearest_ahead(obstacles.points, parameters.avoid_m)
    if k != NOT_FOUND:
        threat_x, threat_y = obstacles.points[k, 0], obstacles.points[k, 1]
        threat = math.hypot(threat_x, threat_y)
    j = nearest(members.positions, sets[NEAR])
    if j != NOT_FOUND and math.hypot(members.positions[j, 0], members.positions[j, 1]) < threat:
        threat_x, threat_y = members.positions[j, 0], members.positions[j, 1]
        threat = math.hypot(threat_x, threat_y)
    if threat < math.inf:
        turn = parameters.avoid_turn_rad
        if threat_y > 0.0 or (threat_y == 0.0 and u[1] < 0.5):
            turn = -turn
        return Motion(Kind.HEADING, turn, parameters.speed_m_s, AVOIDING)

    ahead = math.radians(parameters.ahead_deg)
    k, vx, vy = flock_to_follow(own, members, sets[FLOCK], ahead)
    if k != NOT_FOUND:
        x, y = members.positions[k, 0], members.positions[k, 1]
        distance = math.hypot(x, y)
        if distance > 0.0:
            pull = parameters.spacing_gain * (distance - parameters.spacing_m) / distance
            vx, vy = vx + pull * x, vy + pull * y
        vx, vy = limited(vx, vy, parameters.fast_m_s)
        return Motion(Kind.VELOCITY, vx, vy, KEEPING)
    k, _, _ = flock_to_follow(own, members, sets[DISTANT], ahead)
    if k != NOT_FOUND:
        bearing = math.atan2(members.positions[k, 1], members.positions[k, 0])
        return Motion(Kind.HEADING, bearing, parameters.fast_m_s, CATCHING_UP)
    turn = parameters.wander_turn_rad * (2.0 * u[0] - 1.0)
    return Motion(Kind.HEADING, turn, parameters.speed_m_s, LEADING)
