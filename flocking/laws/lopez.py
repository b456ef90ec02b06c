"""The common form of fish school models: alignment and attraction weighted by distance, with noise.

Source: Lopez, Gautrais, Couzin and Theraulaz 2012, "From behavioural analyses to models of collective motion in fish
schools", a review; Fine 2015, table A.1. The review gives no numbers; metres and seconds.

    direction = mean over neighbours of f(distance) times their unit heading
              + mean over neighbours of g(distance) times the unit vector towards them
              + a noise vector

and the member moves along it at constant speed. f and g are left to the reader, who is to measure them. Here

    f = `alignment` at every distance
    g = `attraction` times (distance - balance) / balance, held within -1 and 1

so that neighbours nearer than the balance distance repel, and the noise vector has a constant length and a direction
drawn uniformly.

Needs positions and headings. No neighbours: the means are undefined; the own direction (the body's x axis) takes their
place, so that a member alone wanders by its noise. A sum of zero: the own direction. Neighbours in its own place align
but do not attract. Table 3.2 gives the model a heterogeneous group and no orientation; the formula has one law for all
and reads headings.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import NEGLIGIBLE, unit
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "headings"})
RULES = ("alone", "school")
SETS = {"neighbours": "distance-based(0, range_m)"}
DRAWS = 1
TAXONOMY = Taxonomy("heterogeneous", "idealized", "discrete", "-", False, True, False, False)
VALIDATION = Validation("S", True, "global", "global", "global", "unbounded free")
FILLED = (
    Filled("motion computation", "the function of distance that weights alignment", "constant"),
    Filled(
        "motion computation",
        "the function of distance that weights attraction",
        "linear through zero at a balance distance, held within the attraction's strength either way",
    ),
    Filled("motion computation", "the stochastic component", "a vector of constant length in a random direction"),
    Filled("motion computation", "the mean over no neighbours", "the own direction takes its place"),
    Filled(
        "motion computation",
        "the new direction is printed without being brought to unit length, which lets the speed vary",
        "its direction alone counts and the speed is constant, as in most of the models that the review compares",
    ),
)
HERD = Herd(spacing_m=1.0, speed_m_s=1.0, dt_s=0.1)
CREATE = {"range_m": 4.0, "speed_m_s": 0.25, "balance_m": 0.8}


class Parameters(NamedTuple):
    """Of the common form of fish school models."""

    range_m: Annotated[float, Parameter("m", "beta of table A.1; our choice", low=0.0)] = 5.0
    speed_m_s: Annotated[float, Parameter("m/s", "w1 of table A.1; our choice", low=0.0)] = 1.0
    alignment: Annotated[float, Parameter("", "w2 of table A.1; our choice", low=0.0)] = 1.0
    attraction: Annotated[float, Parameter("", "w3 of table A.1; our choice", low=0.0)] = 0.5
    balance_m: Annotated[float, Parameter("m", "where w3 of table A.1 is zero; our choice", low=1e-6)] = 1.0
    noise: Annotated[float, Parameter("", "length of eta of table A.1; our choice", low=0.0)] = 0.1


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: the direction of the weighted means and the noise."""
    found, x, y = 0, 0.0, 0.0
    for j in range(len(sets[0])):
        if sets[0, j]:
            found += 1
            px, py = members.positions[j, 0], members.positions[j, 1]
            ux, uy = unit(px, py)
            excess = (math.hypot(px, py) - parameters.balance_m) / parameters.balance_m
            pull = parameters.attraction * min(max(excess, -1.0), 1.0)
            x += parameters.alignment * math.cos(members.headings[j]) + pull * ux
            y += parameters.alignment * math.sin(members.headings[j]) + pull * uy
    if found == 0:
        x = 1.0
    else:
        x /= found
        y /= found
    x += parameters.noise * math.cos(2.0 * math.pi * u[0])
    y += parameters.noise * math.sin(2.0 * math.pi * u[0])
    rule = 0 if found == 0 else 1
    if math.hypot(x, y) <= NEGLIGIBLE:
        return Motion(Kind.HEADING, 0.0, parameters.speed_m_s, rule)
    return Motion(Kind.HEADING, math.atan2(y, x), parameters.speed_m_s, rule)
