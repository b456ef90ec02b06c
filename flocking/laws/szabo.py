"""Szabo's self-propelled particles: neighbours pass on their accelerations beside their velocities.

Source: Szabo, Nagy and Vicsek 2008 (SASO) and 2009 (Physical Review E 79), one law; Fine 2015, table A.1.
v(t + dt) = speed * R(xi) * the unit vector along (s * <v> + (1 - s) * <a> dt), with <> the mean over the neighbours
and the member itself, a = (v(t) - v(t - dt)) / dt, and R a turn by xi drawn evenly from [-noise pi, noise pi]. The
publication is in three dimensions, with R about a random axis across the velocity; in two there is one such axis. With
s = 1 the rule is Vicsek's. Metres, seconds; one step is one second.

Who accelerated how is not to be known without telling neighbours apart: `szabo_ids` is the published rule for members
that can. Here <a> dt is the change of the mean velocity since the last call, which is the same where the neighbours
are. The mean of the last call is kept in memory, relative to the velocity that the member then decided on: where the
member is then moving tells it, without a compass, how its body has turned. A body that cannot follow takes it along. At
the first call nobody has accelerated.

Needs positions (to select) and velocities. No neighbours: the member's own velocity and acceleration. Nothing left in
the sum: the velocity's direction is kept.
In a kinematic herd members move by the old velocity (`forward`), as in the publications.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.angles import wrap
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import direction, mean_vector, rotated
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"velocities"})
RULES = ("align",)
SETS = {"neighbours": "distance-based(0, range_m)"}
MEMORY = 3
DRAWS = 1

MEAN_X, MEAN_Y, CALLED = range(3)

TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "-", False, True, True, True)
VALIDATION = Validation("S", True, "global", "global", "global", "periodic free")
ORIENTATIONS = Filled(
    "sensing",
    "table 3.2 asks for the neighbours' orientations; the formula of table A.1 has their velocities only",
    "orientations are not needed",
)
FIRST_ACCELERATION = Filled("motion computation", "the acceleration at the start", "zero")
TWO_DIMENSIONS = Filled("motion computation", "three dimensions", "two: the random turn has one axis")
ITSELF = Filled("motion computation", "whether the member itself belongs to the means", "it does, as in Vicsek's rule")
FILLED = (
    ORIENTATIONS,
    Filled(
        "motion computation",
        "table A.1 has one acceleration, of whom it does not say, where the publications have the neighbours' mean",
        "the change of the mean velocity since the last call; with ids `szabo_ids` has each neighbour's own",
        misprint=True,
    ),
    FIRST_ACCELERATION,
    TWO_DIMENSIONS,
    ITSELF,
)
HERD = Herd(spacing_m=0.5, speed_m_s=0.1, dt_s=1.0, space="periodic", updating="forward")
CREATE = {"range_m": 2.0, "speed_m_s": 0.25, "velocity_share": 0.8}


RangeM = Annotated[float, Parameter("m", "our choice: the unit of length", low=0.0)]
SpeedMS = Annotated[float, Parameter("m/s", "our choice: a tenth of the radius a step", low=0.0)]
Share = Annotated[
    float, Parameter("", "our choice: s, from 0 (accelerations only) to 1; swept there", low=0.0, high=1.0)
]
Noise = Annotated[float, Parameter("", "our choice: a share of half a turn", low=0.0, high=1.0)]


class Parameters(NamedTuple):
    """Of Szabo's rule."""

    range_m: RangeM = 1.0
    speed_m_s: SpeedMS = 0.1
    velocity_share: Share = 0.8
    noise: Noise = 0.05


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: of mean velocity and mean acceleration, turned by uniform noise."""
    course = direction(own.velocity[0], own.velocity[1])
    found, x, y = mean_vector(members.velocities, sets[0])
    x = (found * x + own.velocity[0]) / (found + 1)
    y = (found * y + own.velocity[1]) / (found + 1)
    change_x, change_y = 0.0, 0.0
    if memory[CALLED] > 0.0:
        old_x, old_y = rotated(memory[MEAN_X], memory[MEAN_Y], course)
        change_x, change_y = x - old_x, y - old_y
    share = parameters.velocity_share
    sum_x = share * x + (1.0 - share) * change_x
    sum_y = share * y + (1.0 - share) * change_y
    wanted = course
    if sum_x != 0.0 or sum_y != 0.0:
        wanted = math.atan2(sum_y, sum_x)
    turn = wrap(wanted + parameters.noise * 2.0 * math.pi * (u[0] - 0.5))
    memory[MEAN_X], memory[MEAN_Y] = rotated(x, y, -turn)
    memory[CALLED] = 1.0
    return Motion(Kind.HEADING, turn, parameters.speed_m_s, 0)
