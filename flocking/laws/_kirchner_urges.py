"""The five urges of Kirchner 2006, section 2.4, and the influence of section 2.5.4, for the laws that combine them.

Source: Kirchner 2006, equations 2.1 to 2.4 and 2.6, after Reynolds 1987, Lorek and White 1993 and Schnapauff. P_b is
the place of flockmate b, |P_b| its distance d, P̂_b the unit vector there; I_b = C1 C2^d its influence (2.6):

    centring     Σ P̂_b I_b                  (2.1)
    separation   −Σ P̂_b I_b / d²            (2.2, printed without the minus sign: it would attract)
    matching     Σ (D_b − D_i) I_b           (2.3)
    obstacle     −Ô I_O                      (2.4, of the nearest alone; printed as a distance times its influence)
    migration    the unit vector to the goal

Each urge, times its urgency (m/s² for a unit vector), is an acceleration; the publication gives no value of any of
them. Metres and seconds, body frame. A flockmate on the own place has no direction and asks for nothing but matching.
"""

from __future__ import annotations

import math
from typing import Annotated, Any

from flocking.compilation import compiled
from flocking.geometry import NOT_FOUND, nearest
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd
from flocking.terms import length_of, limited, speed_limited, unit
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "velocities", "obstacles", "goal"})
SETS = {"flockmates": "distance-based(0, range_m) & field-of-view(view_deg)"}
HERD = Herd(1.2, 0.3, 0.1)
FOR_CREATES = {"range_m": 4.0, "top_speed_m_s": 0.4, "top_acceleration_m_s2": 0.3}
NO_ROW = "publications that the tables do not hold; the rows are what they earn"

KIRCHNER = "Kirchner 2006"
TOUCHING_M = 1e-6
"""Separation does not grow any more for flockmates nearer than this."""

RangeM = Annotated[float, Parameter("m", f"{KIRCHNER}, section 3.3: eight feet", published=True, low=0.0)]
ViewDeg = Annotated[float, Parameter("deg", f"{KIRCHNER}, section 3.1", published=True, low=0.0, high=360.0)]
Influence = Annotated[float, Parameter("", "our choice: C1 of equation 2.6, which has no value", low=0.0)]
Decay = Annotated[
    float, Parameter("", "our choice: C2 of equation 2.6, by the metre, which has no value", low=0.0, high=1.0)
]
Urgency = Annotated[float, Parameter("m/s²", "our choice: no urgency has a value", low=0.0)]
SeparationUrgency = Annotated[
    float, Parameter("m³/s²", "our choice: two robots then keep 36 inches, as section 3.6.8 has it", low=0.0)
]
MatchingUrgency = Annotated[
    float, Parameter("1/s", "our choice: no urgency has a value; m/s² with match_speeds=false", low=0.0)
]
MatchSpeeds = Annotated[
    bool,
    Parameter(
        "",
        f"{KIRCHNER}, section 2.4.3: D is direction and speed; false: the unit vector of the direction",
        published=True,
        plausible=(False, True),
    ),
]
MatesAreObstacles = Annotated[
    bool,
    Parameter(
        "",
        f"{KIRCHNER}, section 2.4.4: the nearest obstacle may be a flockmate; false: only what is none",
        published=True,
        plausible=(False, True),
    ),
]
ObstacleAsPrinted = Annotated[
    bool,
    Parameter(
        "",
        "our reading of 2.4: as strong as its influence; true: times its distance too, as printed",
        plausible=(False, True),
    ),
]
TopAcceleration = Annotated[float, Parameter("m/s²", "our choice: the physical limit, which has no value", low=0.0)]
TopSpeed = Annotated[float, Parameter("m/s", f"{KIRCHNER}, section 3.3", published=True, low=0.0)]

LEFT_OPEN = (
    Filled(
        "motion computation",
        "equation 2.2 is printed without a minus sign and so attracts",
        "away from each flockmate, as its text says",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "equation 2.4 is a distance times an influence: it has no direction, and grows with the distance",
        "away from the nearest, as strong as its influence; with obstacle_as_printed times its distance",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "P_b is normalized in 2.1, divided by a square in 2.2 and an exponent in 2.6",
        "a unit vector where it points; its distance, in metres, in the square and in the exponent",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "D of 2.3 is a direction vector, and the text matches direction and speed",
        "velocities; with match_speeds=false their unit vectors",
    ),
    Filled("motion computation", "C1, C2 and all urgencies have no value", "parameters"),
    Filled("physical motion", "the urges are desired headings, their limit an acceleration", "all are accelerations"),
    Filled("neighbour selection", "the neighbourhood", "that of the robots: 220 degrees and eight feet"),
)
"""What both laws that combine the urges leave open."""


@compiled
def influence_of(distance: float, parameters: Any) -> float:
    """Equation 2.6 of a member at that distance, m."""
    return parameters.influence * parameters.decay**distance


@compiled
def centring(members: Members, chosen: Bools, parameters: Any) -> tuple[float, float]:
    """Equation 2.1."""
    x, y = 0.0, 0.0
    for j in range(len(chosen)):
        if chosen[j]:
            px, py = members.positions[j, 0], members.positions[j, 1]
            ux, uy = unit(px, py)
            weight = influence_of(length_of(px, py), parameters)
            x += ux * weight
            y += uy * weight
    return x, y


@compiled
def separation(members: Members, chosen: Bools, parameters: Any) -> tuple[float, float]:
    """Equation 2.2 with the minus sign that it lacks."""
    x, y = 0.0, 0.0
    for j in range(len(chosen)):
        if chosen[j]:
            px, py = members.positions[j, 0], members.positions[j, 1]
            ux, uy = unit(px, py)
            distance = length_of(px, py)
            apart = max(distance, TOUCHING_M)
            weight = influence_of(distance, parameters) / (apart * apart)
            x -= ux * weight
            y -= uy * weight
    return x, y


@compiled
def matching(own: Own, members: Members, chosen: Bools, parameters: Any) -> tuple[float, float]:
    """Equation 2.3, of velocities or of their unit vectors."""
    own_x, own_y = own.velocity[0], own.velocity[1]
    if not parameters.match_speeds:
        own_x, own_y = unit(own_x, own_y)
    x, y = 0.0, 0.0
    for j in range(len(chosen)):
        if chosen[j]:
            weight = influence_of(length_of(members.positions[j, 0], members.positions[j, 1]), parameters)
            vx, vy = members.velocities[j, 0], members.velocities[j, 1]
            if not parameters.match_speeds:
                vx, vy = unit(vx, vy)
            x += (vx - own_x) * weight
            y += (vy - own_y) * weight
    return x, y


@compiled
def nearest_obstacle(points: Floats, range_m: float, view_deg: float) -> int:
    """Row of the nearest of `points` (K, 2) in the neighbourhood, `NOT_FOUND` if there is none; ties as `before`."""
    widest = math.radians(0.5 * view_deg)
    best, best_squared = NOT_FOUND, range_m * range_m
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        squared = x * x + y * y
        if squared > best_squared or abs(math.atan2(y, x)) > widest:
            continue
        if best != NOT_FOUND and squared == best_squared:
            bx, by = points[best, 0], points[best, 1]
            if x > bx or (x == bx and y >= by):
                continue
        best, best_squared = k, squared
    return best


@compiled
def avoidance(members: Members, chosen: Bools, obstacles: Obstacles, parameters: Any) -> tuple[bool, float, float]:
    """Equation 2.4 as an urge away from the nearest obstacle, and whether there is one."""
    found, x, y, distance = False, 0.0, 0.0, 0.0
    k = nearest_obstacle(obstacles.points, parameters.range_m, parameters.view_deg)
    if k != NOT_FOUND:
        found, x, y = True, obstacles.points[k, 0], obstacles.points[k, 1]
        distance = length_of(x, y)
    if parameters.mates_are_obstacles:
        j = nearest(members.positions, chosen)
        if j != NOT_FOUND:
            mx, my = members.positions[j, 0], members.positions[j, 1]
            gap = length_of(mx, my)
            if not found or gap < distance:
                found, x, y, distance = True, mx, my, gap
    if not found:
        return False, 0.0, 0.0
    ux, uy = unit(x, y)
    strength = influence_of(distance, parameters)
    if parameters.obstacle_as_printed:
        strength *= distance
    return True, -ux * strength, -uy * strength


@compiled
def accelerated(own: Own, x: float, y: float, parameters: Any, rule: int) -> Motion:
    """The acceleration (x, y), within the limits of acceleration and speed."""
    x, y = limited(x, y, parameters.top_acceleration_m_s2)
    x, y = speed_limited(x, y, own.velocity[0], own.velocity[1], own.dt, parameters.top_speed_m_s)
    return Motion(Kind.ACCELERATION, x, y, rule)
