"""Toner and Tu's microscopic rule: the mean heading within a radius, oneself included, plus normal noise.

Source: Toner and Tu 1998 (Physical Review E 58); Fine 2015, table A.1. Heading(t + dt) = direction of the summed
heading vectors of the neighbours and oneself + noise, then a step along the new heading; the noise has mean 0 and a
given variance, independent between members and steps. Radians, metres, metres per second; one step is one second.

Needs positions (to select) and headings. No neighbours: straight on, with noise alone. Headings that cancel out
exactly: the member's own is kept.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from flocking.angles import wrap
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import heading_with_itself, normal
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"headings"})
RULES = ("align",)
SETS = {"neighbours": "distance-based(0, range_m)"}
DRAWS = 1

TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "-", False, True, False, True)
VALIDATION = Validation("M", True, "global", "constant", "global", "bounded free")
FILLED = (
    Filled(
        "motion computation",
        "table A.1 adds up the neighbours' angles, where the publication takes their mean",
        "the direction of the sum of the heading vectors, which has no cut at half a turn; oneself included",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "only the mean and the variance of the noise are given",
        "normal noise; its standard deviation is a parameter",
    ),
    Filled(
        "motion computation",
        "table A.1 prints a step of length one, where the publication has a constant speed",
        "a speed, by default such that a step of a second has length one",
        misprint=True,
    ),
    Filled(
        "physical motion",
        "table 3.4 has a bounded space; what its walls do to a member is not said",
        "the herd lives in periodic space: with walls that only stop them, members end up along these",
    ),
)
HERD = Herd(spacing_m=0.5, speed_m_s=1.0, dt_s=1.0, space="periodic")
CREATE = {"range_m": 2.0, "speed_m_s": 0.25, "noise_rad": 0.05}


class Parameters(NamedTuple):
    """Of Toner and Tu's rule."""

    range_m: Annotated[float, Parameter("m", "our choice: the unit of length", low=0.0)] = 1.0
    speed_m_s: Annotated[float, Parameter("m/s", "Fine 2015, table A.1: a step of one", published=True, low=0.0)] = 1.0
    noise_rad: Annotated[float, Parameter("rad", "our choice: standard deviation, in the ordered phase", low=0.0)] = 0.3


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: the mean one, plus normal noise."""
    turn = wrap(heading_with_itself(members.headings, sets[0]) + parameters.noise_rad * normal(u[0]))
    return Motion(Kind.HEADING, turn, parameters.speed_m_s, 0)
