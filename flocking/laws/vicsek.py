"""Vicsek's self-propelled particles: take the mean heading of all within a radius, oneself included, plus noise.

Source: Vicsek, Czirok, Ben-Jacob, Cohen and Shochet 1995 (Physical Review Letters 75); Fine 2015, table A.1.
Heading(t + dt) = atan2(mean sin, mean cos) over the neighbours and oneself + a number drawn evenly from
[-noise/2, noise/2]; the speed is constant. Radians, metres, metres per second; one step is one second there.

Needs positions (to select) and headings. No neighbours: the mean is one's own heading, so the member goes on with
noise alone. Headings that cancel out exactly: the member's own is kept.

The publication moves a member by its old velocity and then turns it: the `forward` updating of the law's own herd.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from flocking.angles import wrap
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import heading_with_itself
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"headings"})
RULES = ("align",)
SETS = {"neighbours": "distance-based(0, range_m)"}
DRAWS = 1

TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "-", False, True, False, True)
VALIDATION = Validation("S", True, "global", "constant", "global", "periodic free")
FILLED = (
    Filled(
        "motion computation",
        "table A.1 adds up one arctangent for each neighbour, which is no mean of angles",
        "the arctangent of the mean sine over the mean cosine, in its full range of angles, as in the publication",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "table A.1 does not say that the member itself belongs to the mean",
        "it does, as in the publication",
    ),
)
HERD = Herd(spacing_m=0.5, speed_m_s=0.03, dt_s=1.0, space="periodic", updating="forward")
CREATE = {"range_m": 2.0, "speed_m_s": 0.25}


class Parameters(NamedTuple):
    """Of Vicsek's rule."""

    range_m: Annotated[float, Parameter("m", "Vicsek et al. 1995: the unit of length", published=True, low=0.0)] = 1.0
    speed_m_s: Annotated[float, Parameter("m/s", "Vicsek et al. 1995", published=True, low=0.0)] = 0.03
    noise_rad: Annotated[
        float, Parameter("rad", "Vicsek et al. 1995, figure 1; swept from 0 to 5 there", published=True, low=0.0)
    ] = 0.1


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: the mean one, plus uniform noise."""
    noise = parameters.noise_rad * (u[0] - 0.5)
    turn = wrap(heading_with_itself(members.headings, sets[0]) + noise)
    return Motion(Kind.HEADING, turn, parameters.speed_m_s, 0)
