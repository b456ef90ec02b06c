"""Nearest-neighbour averaging of headings without a leader.

Source: Jadbabaie, Lin and Morse 2003 (conference 2002), "Coordination of groups of mobile autonomous agents using
nearest neighbor rules"; Fine 2015, table A.1 (leaderless). The publication's units are free; metres and seconds here.

New heading = own heading + the sum over the neighbours of (their heading - own heading), divided by g, which exceeds
the number of all agents, and so that of any member's neighbours; the speed is constant. Over a graph that is undirected
and stays connected all headings become their mean at the start.

Needs headings; the selection needs positions. No neighbours: the heading stays and the member moves on.
The publication takes headings as plain numbers. Here each difference is wrapped into half a turn either way, which is
the same wherever all headings lie within half a turn of one another; a neighbour that moves in exactly the opposite
direction lies to neither side and turns nobody. A member does not know how many agents there are: choose g above
their number. Where it does not even exceed a member's n neighbours, n + 1 takes its place: the plain average.
In a kinematic herd members move by the old velocity (`forward`), as in the publication.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.angles import wrap
from flocking.compilation import compiled
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

SOURCE = "Jadbabaie, Lin and Morse 2003"

NEEDS = frozenset({"headings"})
RULES = ("alone", "average")
SETS = {"neighbours": "distance-based(0, range_m)"}
TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "-", False, True, False, True)
VALIDATION = Validation("M", True, "global", "constant", "global", "-")
WRAPPED = Filled(
    "motion computation",
    "headings are plain numbers without a period",
    "differences of heading are wrapped into half a turn either way",
)
FILLED = (
    Filled(
        "motion computation",
        "a weight g of no more than the number of agents is outside of what is defined, but no member knows the number",
        "g is taken as it is, or one more than the number of neighbours where it does not exceed that",
    ),
    Filled(
        "motion computation",
        "table A.1 weights the own heading with the number of neighbours n, so that the weights do not sum to 1",
        "the own heading weighs g - n and each neighbour 1, all divided by g, as in the original",
        misprint=True,
    ),
    WRAPPED,
)
HERD = Herd(spacing_m=0.5, speed_m_s=0.03, dt_s=1.0, space="periodic", updating="forward")
CREATE = {"range_m": 2.5, "speed_m_s": 0.25, "g": 10.0}

RangeM = Annotated[float, Parameter("m", f"our choice: the unit of length of {SOURCE}", low=0.0)]
SpeedMS = Annotated[float, Parameter("m/s", "our choice: that of Vicsek et al. 1995, whose model it explains", low=0.0)]


class Parameters(NamedTuple):
    """Of Jadbabaie's law without a leader."""

    range_m: RangeM = 1.0
    speed_m_s: SpeedMS = 0.03
    g: Annotated[
        float,
        Parameter("", f"our choice: {SOURCE} ask for more than there are agents; a herd has 50 by itself", low=1.0),
    ] = 60.0


@compiled
def heading_differences(headings: Floats, chosen: Bools) -> tuple[int, float]:
    """How many members are chosen, and the sum of their headings relative to the focal one's, rad."""
    found, total = 0, 0.0
    for j in range(len(chosen)):
        if chosen[j]:
            found += 1
            difference = wrap(headings[j])
            if difference > -math.pi:
                total += difference
    return found, total


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: turned by the summed differences over g."""
    found, total = heading_differences(members.headings, sets[0])
    if found == 0:
        return Motion(Kind.HEADING, 0.0, parameters.speed_m_s, 0)
    return Motion(Kind.HEADING, total / max(parameters.g, found + 1.0), parameters.speed_m_s, 1)
