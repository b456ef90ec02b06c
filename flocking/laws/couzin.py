"""Effective leadership: repulsion, else attraction and alignment; the informed balance it with their direction.

Source: Couzin, Krause, Franks and Levin 2005, "Effective leadership and decision-making in animal groups on the move";
Fine 2015, table A.1, which leaves repulsion, noise and turning out. The publication's unit of length is metres here.

    1  somebody nearer than alpha   d = minus the sum of the unit vectors towards them
    2  else, within rho             d = the sum of the unit vectors towards them and of all unit velocities, own too
    3  informed                     d = the unit vector of d + omega times the unit vector of the preferred direction

d is turned by a random angle (normal about 0) and approached by at most the turning rate times the time between
updates; the speed is constant. Informed members are those that have a goal: one far away is a direction.

Needs positions and velocities, and of itself the goal; the own direction is the body's x axis. No neighbours: the own
direction, for informed ones with their preferred one. A sum of zero: the own direction. Neighbours in its own place or
at rest add nothing.

Readings: equation 3 has no condition, so that the informed weigh in their preferred direction after repulsion as well;
repulsion's priority is that over attraction and alignment. With `repulsion_first` the preferred direction waits while
somebody is too near: in crowds, where somebody always is, informed members then hardly steer. Noise comes before the
limit of turning. The document gives no speed. Table 3.2 gives the model no orientation: velocities hold it.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.angles import wrap
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import NEGLIGIBLE, count, normal, towards_goal, unit
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

SOURCE = "Couzin et al. 2005"

NEEDS = frozenset({"positions", "velocities", "goal"})
RULES = ("alone", "apart", "together", "informed", "informed and apart")
SETS = {"repulsion": "distance-based(0, alpha_m)", "interaction": "distance-based(0, rho_m)"}
RELATIONS = ("alpha_m at most rho_m",)
DRAWS = 1
TAXONOMY = Taxonomy("heterogeneous", "idealized", "discrete", "member", False, True, True, False)
VALIDATION = Validation("S", True, "global", "global", "global", "unbounded free")
FILLED = (
    Filled(
        "motion computation",
        "table A.1 sums over the neighbours alone",
        "the member's own direction joins the sum of directions, as in the publication",
    ),
    Filled(
        "motion computation",
        "table A.1 leaves out the repulsion that table 3.2 marks, the angular noise and the limit of turning",
        "all three as in the original",
    ),
    Filled(
        "motion computation",
        "whether an informed member minds its preferred direction while somebody is too near",
        "it does: equation 3 has no condition; the parameter repulsion_first gives the other reading",
    ),
    Filled("motion computation", "terms that cancel out", "the member keeps its direction"),
)
HERD = Herd(spacing_m=1.5, speed_m_s=3.0, dt_s=0.2)
CREATE = {"alpha_m": 0.6, "rho_m": 4.0, "speed_m_s": 0.25, "turn_limit_rad_s": 10.0}

ALONE, APART, TOGETHER, INFORMED, INFORMED_APART = range(5)


class Parameters(NamedTuple):
    """Of effective leadership."""

    alpha_m: Annotated[float, Parameter("m", f"{SOURCE}: 1 unit", published=True, low=0.0)] = 1.0
    rho_m: Annotated[float, Parameter("m", f"{SOURCE}: 6 units", published=True, low=0.0)] = 6.0
    omega: Annotated[float, Parameter("", f"{SOURCE}: 0.5 in its figure 1", published=True, low=0.0)] = 0.5
    speed_m_s: Annotated[float, Parameter("m/s", "our choice: that of Couzin et al. 2002", low=0.0)] = 3.0
    noise_rad: Annotated[float, Parameter("rad", f"{SOURCE}: standard deviation of 0.01", published=True, low=0.0)] = (
        0.01
    )
    turn_limit_rad_s: Annotated[float, Parameter("rad/s", f"{SOURCE}: 2 radians a second", published=True, low=0.0)] = (
        2.0
    )
    repulsion_first: Annotated[
        bool, Parameter("", "our reading; true: no preferred direction while somebody is nearer than alpha_m")
    ] = False


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: the direction of equations 1 to 3, noise added, within the limit of turning."""
    x, y = 0.0, 0.0
    near = count(sets[0])
    if near > 0:
        rule = APART
        for j in range(len(sets[0])):
            if sets[0, j]:
                ux, uy = unit(members.positions[j, 0], members.positions[j, 1])
                x -= ux
                y -= uy
    else:
        rule = ALONE if count(sets[1]) == 0 else TOGETHER
        x = 1.0
        for j in range(len(sets[1])):
            if sets[1, j]:
                ux, uy = unit(members.positions[j, 0], members.positions[j, 1])
                vx, vy = unit(members.velocities[j, 0], members.velocities[j, 1])
                x += ux + vx
                y += uy + vy
    if math.hypot(x, y) <= NEGLIGIBLE:
        x, y = 1.0, 0.0
    has_goal, gx, gy = towards_goal(own.goal)
    if has_goal and not (near > 0 and parameters.repulsion_first):
        rule = INFORMED_APART if near > 0 else INFORMED
        x, y = unit(x, y)
        x += parameters.omega * gx
        y += parameters.omega * gy
        if math.hypot(x, y) <= NEGLIGIBLE:
            x, y = 1.0, 0.0
    turn = wrap(math.atan2(y, x) + parameters.noise_rad * normal(u[0]))
    most = parameters.turn_limit_rad_s * own.dt
    return Motion(Kind.HEADING, min(max(turn, -most), most), parameters.speed_m_s, rule)
