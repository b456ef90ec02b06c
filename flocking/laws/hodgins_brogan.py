"""The herding algorithm of Hodgins and Brogan, as it drives point masses.

Source: Hodgins and Brogan 1994, "Robot herds: group behaviors for systems with significant dynamics", sections 3.1, 3.2
and 4.2, equation 1. Metres and seconds.

Of each visible neighbour, the member would like to be at the distance D from it, on the line between the two. These
points are averaged with weights 1/d², d being the distance to the neighbour. With e the way from the member to that
mean, the velocity is k_p e + k_v de/dt + v_nom, where v_nom is the mean velocity of the visible neighbours; the member
that the user controls (role 1) has a v_nom of its own, towards its goal. The user's member and one other come to keep
the distance D.

Needs positions and velocities. No neighbours: an ordinary member keeps its velocity, the user's moves with v_nom.
Two ordinary members alone that update at the same time exchange their velocities and swing ever wider, up to the limit;
three, or one and the user's member, come to rest.
The publication reads its neighbours' desired velocities; for point masses these are their velocities. It sees anew
every tenth step; here every step. Nothing is done about obstacles: the shared avoidance takes the place of the
publication's aim point beside an obstacle.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import mean_vector, towards_goal
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

SOURCE = "Hodgins and Brogan 1994"
CONTROLLED_BY_USER = 1

NEEDS = frozenset({"positions", "velocities", "goal"})
RULES = ("none", "herd", "user", "herd of the user")
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
        "physical motion",
        "point masses have no top speed, so that members that all but touch send a shock through the herd",
        "the velocity is cut to limit_m_s",
    ),
)
HERD = Herd(spacing_m=2.5, speed_m_s=2.0, dt_s=0.02, leaders=1)
CREATE = {"range_m": 5.6, "spacing_m": 0.8, "nominal_m_s": 0.25, "limit_m_s": 0.5}


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
        distance = math.hypot(x, y)
        if not sets[0, j] or distance < 1e-9:
            continue
        vx, vy = members.velocities[j, 0] - own.velocity[0], members.velocities[j, 1] - own.velocity[1]
        recession = (x * vx + y * vy) / distance
        weight = 1.0 / (distance * distance)
        weight_rate = -2.0 * weight / distance * recession
        share = 1.0 - parameters.spacing_m / distance
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
    elif found == 0:
        return Motion(Kind.HOLD, math.nan, math.nan, 0)
    if weights > 0.0:
        ex, ey = ex / weights, ey / weights
        nominal_x += parameters.kp_per_s * ex + parameters.kv * (ex_rate - ex * weights_rate) / weights
        nominal_y += parameters.kp_per_s * ey + parameters.kv * (ey_rate - ey * weights_rate) / weights
    scale = min(1.0, parameters.limit_m_s / max(math.hypot(nominal_x, nominal_y), 1e-9))
    return Motion(Kind.VELOCITY, scale * nominal_x, scale * nominal_y, rule)
