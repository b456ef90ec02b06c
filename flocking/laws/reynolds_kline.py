"""Boids that mind only their nearest flockmate for distance and heading.

Source: Reynolds 1987 in the reading of Kline's C++ boids (1996); Fine 2015, table 3.3 and section 3.4.1. The code has
units of its own: metres and seconds here, body frame.

Change of velocity = w1 s + w2 â + w3 ĉ with k the nearest member of the near set: s is w5 away from k if it is nearer
than w4 and w6 towards it otherwise, a is k's heading vector, c the mean position of the neighbours. Nobody near:
s = a = 0. No neighbours at all: the velocity is kept. The speed is cut at its maximum.

Reads positions and headings. Obstacles are left to the avoidance that all laws share. The row lists the members'
velocity, of which only the direction is read.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.geometry import NOT_FOUND, nearest
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import mean_vector, speed_limited, unit
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "headings"})
RULES = ("none", "flock")
SETS = {"neighbours": "distance-based(0, range_m)", "near": "distance-based(0, near_m) & nearest"}
NEIGHBOURS, NEAR = range(2)

OURS = "our choice: table 3.3 gives no value"


class Parameters(NamedTuple):
    """Of Kline's boids."""

    range_m: Annotated[float, Parameter("m", f"{OURS}: β", low=0.0)] = 10.0
    near_m: Annotated[float, Parameter("m", f"{OURS}: α", low=0.0)] = 10.0
    keep_m: Annotated[float, Parameter("m", f"{OURS}: w4, the distance kept from the nearest", low=0.0)] = 2.0
    away: Annotated[float, Parameter("", f"{OURS}: w5, urgency when too near", low=0.0)] = 1.0
    towards: Annotated[float, Parameter("", f"{OURS}: w6, urgency when too far", low=0.0)] = 0.5
    distance_weight: Annotated[float, Parameter("m/s²", f"{OURS}: w1", low=0.0)] = 2.0
    heading_weight: Annotated[float, Parameter("m/s²", f"{OURS}: w2", low=0.0)] = 2.0
    centre_weight: Annotated[float, Parameter("m/s²", f"{OURS}: w3", low=0.0)] = 0.5
    top_speed_m_s: Annotated[float, Parameter("m/s", OURS, low=0.0)] = 2.0


TAXONOMY = Taxonomy("homogeneous", "constrained", "continuous", "all", False, True, True, True)
VALIDATION = Validation("S", True, "global", "global", "global", "unbounded obstacles")
FILLED = (
    Filled(
        "motion computation",
        "table 3.3 gives the steps w5 and w6 about the threshold w4 for each axis apart, as the alignment: they would "
        "depend on the axes, align nothing and drive to negative coordinates",
        "steps of keeping a distance along the line to the nearest flockmate: w5 away within w4, w6 towards beyond it",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "table 3.3 has a distance, no vector, for the separation, and then no alignment is left",
        "the two are exchanged: the term without w4 to w6 is the match of heading with the same nearest flockmate",
        misprint=True,
    ),
    Filled("motion computation", "the table calls the sum a velocity", "a change of velocity, cut at a top speed"),
)
HERD = Herd(2.0, 1.0, 0.05)
CREATE = {
    "range_m": 5.6,
    "near_m": 5.6,
    "keep_m": 0.8,
    "distance_weight": 0.3,
    "heading_weight": 0.3,
    "centre_weight": 0.1,
    "top_speed_m_s": 0.25,
}


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Acceleration by the three urges."""
    gathered, centre_x, centre_y = mean_vector(members.positions, sets[NEIGHBOURS])
    k = nearest(members.positions, sets[NEAR])
    if gathered == 0 and k == NOT_FOUND:
        return Motion(Kind.HOLD, math.nan, math.nan, 0)
    centre_x, centre_y = unit(centre_x, centre_y)
    ax, ay = parameters.centre_weight * centre_x, parameters.centre_weight * centre_y
    if k != NOT_FOUND:
        x, y = members.positions[k, 0], members.positions[k, 1]
        urgency = -parameters.away if math.hypot(x, y) < parameters.keep_m else parameters.towards
        x, y = unit(x, y)
        ax += parameters.distance_weight * urgency * x + parameters.heading_weight * math.cos(members.headings[k])
        ay += parameters.distance_weight * urgency * y + parameters.heading_weight * math.sin(members.headings[k])
    ax, ay = speed_limited(ax, ay, own.velocity[0], own.velocity[1], own.dt, parameters.top_speed_m_s)
    return Motion(Kind.ACCELERATION, ax, ay, 1)
