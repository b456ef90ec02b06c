"""Leading according to need: keep apart, else hold together while heading for an own target.

Source: Conradt, Krause, Couzin and Roper 2009, "'Leading according to need' in self-organizing groups"; Fine 2015,
table A.1. The publication's unit of length is metres here.

    somebody nearer than alpha   minus the mean unit vector towards them
    else, within beta            1/4 mean unit vector towards them + 1/4 mean unit vector of their velocities
                                 + w/2 unit vector towards the own target
    else                         the unit vector towards the own target

The member turns to that direction and moves at constant speed. w, the member's assertiveness, differs between members
(a heterogeneous group), and so does the target.

Needs positions and velocities, and of itself the goal. A member without a goal leaves that term out; without a goal and
without neighbours it keeps its motion. A sum of zero: it keeps its motion. Neighbours in its own place or at rest add
nothing.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import NEGLIGIBLE, mean_unit_vector, towards_goal
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "velocities", "goal"})
RULES = ("alone", "apart", "together", "target")
SETS = {"repulsion": "distance-based(0, alpha_m)", "attraction": "distance-based(alpha_m, beta_m)"}
RELATIONS = ("alpha_m at most beta_m",)
TAXONOMY = Taxonomy("heterogeneous", "idealized", "continuous", "member", False, True, True, False)
VALIDATION = Validation("S", True, "global", "global", "global", "unbounded free")
FILLED = (
    Filled("motion computation", "a member that has neither neighbours nor a target", "it keeps its motion"),
    Filled("motion computation", "terms that cancel out", "the member keeps its motion"),
    Filled("neighbour selection", "the radii alpha and beta in the document's table", "1 and 6, as Couzin et al. 2005"),
)
HERD = Herd(spacing_m=2.0, speed_m_s=1.0, dt_s=0.2)
CREATE = {"alpha_m": 0.6, "beta_m": 4.0, "speed_m_s": 0.25}

ALONE, APART, TOGETHER, TARGET = range(4)


class Parameters(NamedTuple):
    """Of leading according to need."""

    alpha_m: Annotated[
        float, Parameter("m", "our choice: radius of repulsion of Couzin et al. 2005, the model it extends", low=0.0)
    ] = 1.0
    beta_m: Annotated[float, Parameter("m", "our choice: radius of attraction of Couzin et al. 2005", low=0.0)] = 6.0
    assertiveness: Annotated[float, Parameter("", "w of table A.1, each member's own; our choice", low=0.0)] = 0.5
    speed_m_s: Annotated[float, Parameter("m/s", "our choice: one radius of repulsion a second", low=0.0)] = 1.0


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: away from those too near, or a weighted sum, or the target."""
    near, away_x, away_y = mean_unit_vector(members.positions, sets[0])
    seen, towards_x, towards_y = mean_unit_vector(members.positions, sets[1])
    _, goal_x, goal_y = towards_goal(own.goal)
    if near > 0:
        rule, x, y = APART, -away_x, -away_y
    elif seen > 0:
        _, along_x, along_y = mean_unit_vector(members.velocities, sets[1])
        weight = 0.5 * parameters.assertiveness
        rule = TOGETHER
        x = 0.25 * towards_x + 0.25 * along_x + weight * goal_x
        y = 0.25 * towards_y + 0.25 * along_y + weight * goal_y
    else:
        rule, x, y = TARGET, goal_x, goal_y
    if math.hypot(x, y) <= NEGLIGIBLE:
        return Motion(Kind.HOLD, math.nan, math.nan, ALONE if rule == TARGET else rule)
    return Motion(Kind.HEADING, math.atan2(y, x), parameters.speed_m_s, rule)
