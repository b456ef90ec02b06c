"""Dong's velocity consensus: each step closes a part of the gap to the velocities of all within a distance.

Source: Dong 2012 (International Journal of Robust and Nonlinear Control, flocking under hierarchical leadership with
a free-will leader); Fine 2015, table A.1. v(t + dt) = v(t) + dt * gain * sum over the neighbours of (v_j - v). The
table's weight is 1 up to the distance w1 and 0 beyond; the selection does that. Metres, seconds. The step is the
member's own time since its last update; velocities converge if dt times gain times the number of neighbours is below
one.

A member of role 1 is the free-will leader of the publication's title: it keeps its velocity whatever the others do.
Without such a member the law is the table's.

Needs positions (to select) and velocities. No neighbours: the sum is empty, the velocity is kept. A herd at rest stays
at rest: velocities must come from the start or from a leader.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import mean_vector
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"velocities"})
RULES = ("keep", "consensus")
SETS = {"neighbours": "distance-based(0, range_m)"}
LEADER = 1

TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "-", False, True, True, False)
VALIDATION = Validation("M", True, "global", "global", "-", "unbounded free")
FILLED = (
    Filled(
        "motion computation",
        "table A.1 leaves out the leader of the publication's title, and table 3.2 calls the members homogeneous",
        "a member of role 1 keeps its velocity; with none the law is the table's",
    ),
    Filled(
        "motion computation",
        "table A.1 leaves out the hierarchy, in which a member heeds only those above it",
        "a member heeds all neighbours, as in the table",
    ),
    Filled("motion computation", "the weight has no unit", "a rate, 1 per second"),
)
HERD = Herd(spacing_m=1.0, speed_m_s=1.0, dt_s=0.02, space="unbounded", leaders=1)
CREATE = {"range_m": 3.0, "gain_per_s": 0.5}


class Parameters(NamedTuple):
    """Of Dong's rule."""

    range_m: Annotated[float, Parameter("m", "our choice: w1 of Fine 2015, table A.1, has no value", low=0.0)] = 5.0
    gain_per_s: Annotated[
        float, Parameter("1/s", "Fine 2015, table A.1: weight 1 within the distance", published=True, low=0.0)
    ] = 1.0


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Velocity: one's own, moved towards the neighbours'."""
    found, x, y = mean_vector(members.velocities, sets[0])
    if found == 0 or own.role == LEADER:
        return Motion(Kind.HOLD, math.nan, math.nan, 0)
    share = own.dt * parameters.gain_per_s * found
    vx, vy = own.velocity[0], own.velocity[1]
    return Motion(Kind.VELOCITY, vx + share * (x - vx), vy + share * (y - vy), 1)
