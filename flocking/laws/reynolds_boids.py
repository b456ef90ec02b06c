"""Boids at one speed: away from those too near, with the velocity of the neighbours, towards their centre.

Source: Reynolds 1987, the three urges and their order, as Fine 2015 has them in section 7.4.2 (cohesion, separation and
velocity matching) with one radius of interaction (figure 6.6, section 6.3.3), for the herds of generated environments.
Metres and seconds, body frame.

Direction = w1 ŝ + w2 â + w3 ĉ, each term a unit vector: s the sum over the neighbours nearer than the separation of the
vectors away from each, divided by the square of its distance; a the mean velocity of the neighbours; c their mean
position. The member turns there at once, as far as its body can, and goes on at its speed.

Reads positions and velocities. No neighbours, or urges that cancel out: it goes straight on. Obstacles are left to the
avoidance that all laws share. In contrast to `reynolds-opensteer` it steers by no force, never slows down, matches
velocities instead of headings and sees all around itself.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.lanes import over
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import NEGLIGIBLE, unit
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "velocities"})
RULES = ("alone", "flock")
SETS = {"neighbours": "distance-based(0, range_m)"}

FILLED = (
    Filled("motion computation", "the formulas of the urges and their weights", "unit vectors, weighted and added"),
    Filled("motion computation", "the distance at which separation begins", "a third of the radius of interaction"),
    Filled("physical motion", "speeds", "one speed for all, as of Fine 2015's other two models"),
)
TAXONOMY = Taxonomy("homogeneous", "constrained", "discrete", "all", False, True, True, False)
VALIDATION = Validation("S", True, "global", "global", "global", "bounded obstacles")
NO_ROW = "the boids of sections 6.3.3 and 7.4.2; the tables hold two other readings of the same publication"
HERD = Herd(spacing_m=8.0, speed_m_s=2.0, dt_s=1.0)
CREATE = {"range_m": 5.6, "separation_m": 0.9, "speed_m_s": 0.25}


class Parameters(NamedTuple):
    """Of boids at one speed."""

    range_m: Annotated[
        float, Parameter("m", "our choice: the fragmentation threshold of Fine 2015, table 6.1", low=0.0)
    ] = 25.0
    separation_m: Annotated[float, Parameter("m", "our choice: a third of the range", low=0.0)] = 8.0
    speed_m_s: Annotated[float, Parameter("m/s", "our choice: a quarter of the separation a second", low=0.0)] = 2.0
    separation_weight: Annotated[float, Parameter("", "our choice: above the others, as it comes first", low=0.0)] = 1.5
    alignment_weight: Annotated[float, Parameter("", "our choice", low=0.0)] = 1.0
    cohesion_weight: Annotated[float, Parameter("", "our choice", low=0.0)] = 1.0


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: the direction of the three urges, at one speed."""
    away_x = away_y = with_x = with_y = to_x = to_y = 0.0
    found, nearest = 0, parameters.separation_m * parameters.separation_m
    for j in range(len(members.ids)):
        if sets[0, j]:
            found += 1
            x, y = members.positions[j, 0], members.positions[j, 1]
            with_x += members.velocities[j, 0]
            with_y += members.velocities[j, 1]
            to_x += x
            to_y += y
            squared = x * x + y * y
            # without a branch, which a processor would often guess wrong: what is divided by infinity adds nothing
            part_x, part_y = over(x, y, squared if (squared > 0.0) & (squared < nearest) else math.inf)
            away_x -= part_x
            away_y -= part_y
    away_x, away_y = unit(away_x, away_y)
    with_x, with_y = unit(with_x, with_y)
    to_x, to_y = unit(to_x, to_y)
    w1, w2, w3 = parameters.separation_weight, parameters.alignment_weight, parameters.cohesion_weight
    x = w1 * away_x + w2 * with_x + w3 * to_x
    y = w1 * away_y + w2 * with_y + w3 * to_y
    if abs(x) + abs(y) <= NEGLIGIBLE:
        return Motion(Kind.HEADING, 0.0, parameters.speed_m_s, 1 if found > 0 else 0)
    return Motion(Kind.HEADING, math.atan2(y, x), parameters.speed_m_s, 1)
