"""The herding algorithm of Hodgins and Brogan, as it drives point masses.

Source: Hodgins and Brogan 1994, "Robot herds: group behaviors for systems with significant dynamics", sections 3.1, 3.2
and 4.2, equation 1. Metres and seconds.

Of each visible neighbour, the member would like to be at the distance D from it, on the line between the two. These
points are averaged with weights 1/d², d being the distance to the neighbour. With e the way from the member to that
mean, the velocity is k_p e + k_v de/dt + v_nom, where v_nom is the mean velocity of the visible neighbours; the member
that the user controls (role 1) has a v_nom of its own, towards its goal. The user's member and one other come to keep
the distance D.

Needs positions and velocities. No neighbours, whether nobody is near, n is 0 or the member is alone: an ordinary
member keeps its velocity, the user's moves with v_nom.
Two ordinary members alone that update at the same time exchange their velocities and swing ever wider, up to the limit;
three, or one and the user's member, come to rest.
The publication reads its neighbours' desired velocities; for point masses these are their velocities. Which of the two
the law is given, its own likewise, is the simulation's, and so is how often a member looks whom it sees (for point
masses of the publication at every tenth step): `trials.simulations.running` has both as keys. Sight that others block,
or that is less to the rear, are selections: `unoccluded(0.25)`, `angle(120)`.

An obstacle is a disc whose radius is told in advance; with a radius of 0 nothing is done about obstacles. A member
whose course runs into a disc that is nearer than the look-ahead would like to pass its centre at 1.5 radii, on the side
that is nearer: this sideways way is averaged with the herd's desired position. One whose course leads through the very
centre, as though there were none, keeps on.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.compilation import borrowing
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import mean_vector, towards_goal
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

SOURCE = "Hodgins and Brogan 1994"
CONTROLLED_BY_USER = 1

NEEDS = frozenset({"positions", "velocities", "goal", "obstacles"})
RULES = ("none", "herd", "user", "herd of the user", "obstacle")
SETS = {"visible": "distance-based(0, range_m) & k-nearest(visible)"}
RELATIONS = ("spacing_m at most range_m",)
TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "all", False, True, True, False)
VALIDATION = Validation("S", True, "global", "global", "-", "unbounded obstacles")
NO_ROW = "a publication that the tables do not hold"
FILLED = (
    Filled(
        "motion computation",
        "equation 1 prints k_p e - k_v de/dt; with e the way to the desired position, the second term feeds swings",
        "k_p e + k_v de/dt, a damper",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "how the rate of change of the error is obtained",
        "exactly, from the neighbours' velocities: a difference of two errors would jump as neighbours come and go",
    ),
    Filled(
        "motion computation",
        "the nominal velocity of the controlled creature is set by the user",
        "nominal_m_s towards its goal, or straight ahead without one",
    ),
    Filled(
        "motion computation",
        "the weight of the sideways motion about an obstacle, and how far ahead it begins",
        "obstacle_share of the mean, within look_ahead_m",
    ),
    Filled(
        "physical motion",
        "point masses have no top speed, so that members that all but touch send a shock through the herd",
        "the velocity is cut to limit_m_s",
    ),
)
HERD = Herd(spacing_m=2.5, speed_m_s=2.0, dt_s=0.02, leaders=1)
CREATE = {
    "range_m": 5.6,
    "spacing_m": 0.8,
    "nominal_m_s": 0.25,
    "limit_m_s": 0.5,
    "obstacle_radius_m": 0.165,
    "look_ahead_m": 1.5,
}


class Parameters(NamedTuple):
    """Of the herding algorithm."""

    range_m: Annotated[float, Parameter("m", f"{SOURCE}, section 3.1: r", published=True, low=0.0)] = 24.0
    visible: Annotated[int, Parameter("", f"{SOURCE}, section 3.1: n", published=True, low=0)] = 30
    spacing_m: Annotated[float, Parameter("m", f"{SOURCE}, section 3.2: D", published=True, low=0.0)] = 2.5
    kp_per_s: Annotated[float, Parameter("1/s", f"{SOURCE}, section 3.2: k_p", published=True, low=0.0)] = 0.5
    kv: Annotated[float, Parameter("", f"{SOURCE}, section 3.2: k_v", published=True, low=0.0)] = 0.3
    nominal_m_s: Annotated[
        float, Parameter("m/s", f"{SOURCE}, section 5: steady-state movement", published=True, low=0.0)
    ] = 2.0
    limit_m_s: Annotated[float, Parameter("m/s", "our choice: five times the nominal speed", low=0.0)] = 10.0
    obstacle_radius_m: Annotated[
        float, Parameter("m", "a choice: of the discs that are obstacles; 0 = none is avoided", low=0.0, plausible=())
    ] = 1.0
    aim_radii: Annotated[
        float, Parameter("", f"{SOURCE}, section 5: 1.5 times the radius of the obstacle", published=True, low=1.0)
    ] = 1.5
    look_ahead_m: Annotated[float, Parameter("m", "a choice: 6 s at the nominal speed", low=0.0)] = 12.0
    obstacle_share: Annotated[
        float, Parameter("", "a choice: weight of the way beside an obstacle in the mean", low=0.0, high=1.0)
    ] = 0.5


@borrowing
def beside(points: Floats, velocity: Floats, parameters: Parameters) -> float:
    """How far to the left of its course (m) a member would like to be for the nearest disc that its course runs into.

    `points` (K, 2): the nearest point of each disc; `velocity` (2,), its own; body frame. 0: there is no such disc.
    """
    speed, radius = math.hypot(velocity[0], velocity[1]), parameters.obstacle_radius_m
    if radius <= 0.0 or speed < 1e-9:
        return 0.0
    ux, uy = velocity[0] / speed, velocity[1] / speed
    nearest, way = parameters.look_ahead_m, 0.0
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        distance = math.hypot(x, y)
        if distance < 1e-9 or distance >= nearest:
            continue
        x, y = x * (1.0 + radius / distance), y * (1.0 + radius / distance)
        left = ux * y - uy * x
        if ux * x + uy * y <= 0.0 or abs(left) >= radius or left == 0.0:
            continue
        nearest, way = distance, left - math.copysign(parameters.aim_radii * radius, left)
    return way


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Velocity by spring and damper towards the desired position."""
    weights = ex = ey = 0.0
    weights_rate = ex_rate = ey_rate = 0.0
    for j in range(len(members.ids)):
        x, y = members.positions[j, 0], members.positions[j, 1]
        squared = x * x + y * y
        if not sets[0, j] or squared < 1e-18:
            continue
        vx, vy = members.velocities[j, 0] - own.velocity[0], members.velocities[j, 1] - own.velocity[1]
        near = 1.0 / math.sqrt(squared)
        recession = (x * vx + y * vy) * near
        weight = near * near
        weight_rate = -2.0 * weight * near * recession
        share = 1.0 - parameters.spacing_m * near
        share_rate = parameters.spacing_m * weight * recession
        weights += weight
        weights_rate += weight_rate
        ex += weight * share * x
        ey += weight * share * y
        ex_rate += (weight_rate * share + weight * share_rate) * x + weight * share * vx
        ey_rate += (weight_rate * share + weight * share_rate) * y + weight * share * vy
    found, nominal_x, nominal_y = mean_vector(members.velocities, sets[0])
    rule = 1
    if own.role == CONTROLLED_BY_USER:
        rule = 2 if found == 0 else 3
        nominal_x, nominal_y = parameters.nominal_m_s, 0.0
        has_goal, ux, uy = towards_goal(own.goal)
        if has_goal:
            nominal_x, nominal_y = parameters.nominal_m_s * ux, parameters.nominal_m_s * uy
    way, share = beside(obstacles.points, own.velocity, parameters), parameters.obstacle_share
    if found == 0 and rule == 1:
        if way == 0.0:
            return Motion(Kind.HOLD, math.nan, math.nan, 0)
        nominal_x, nominal_y = own.velocity[0], own.velocity[1]
    wished_x = wished_y = 0.0
    if weights > 0.0:
        ex, ey = ex / weights, ey / weights
        wished_x = parameters.kp_per_s * ex + parameters.kv * (ex_rate - ex * weights_rate) / weights
        wished_y = parameters.kp_per_s * ey + parameters.kv * (ey_rate - ey * weights_rate) / weights
    if way != 0.0:
        # the way beside is across the course, so that its rate of change is 0
        speed, aside = math.hypot(own.velocity[0], own.velocity[1]), share * parameters.kp_per_s * way
        wished_x = (1.0 - share) * wished_x - aside * own.velocity[1] / speed
        wished_y = (1.0 - share) * wished_y + aside * own.velocity[0] / speed
        rule = 4
    nominal_x += wished_x
    nominal_y += wished_y
    most = parameters.limit_m_s
    if found == 0 and own.role != CONTROLLED_BY_USER:  # alone: it turns, and keeps its speed
        most = min(most, math.hypot(own.velocity[0], own.velocity[1]))
    scale = min(1.0, most / max(math.hypot(nominal_x, nominal_y), 1e-9))
    return Motion(Kind.VELOCITY, scale * nominal_x, scale * nominal_y, rule)
