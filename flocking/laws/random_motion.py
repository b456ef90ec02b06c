"""Random motion (RM): a random walk, the control that knows nobody.

Source: Viscido, Miller and Wethey 2002, where it is the null model; Fine 2015, section 6.3.3 and figure 6.6, where RM
is the control of the generated environments. It gives no numbers; metres and seconds here.

At each choice a new direction is drawn uniformly within the turning range to either side; the member moves along it at
constant speed, and keeps to it for the holding time. With a turning range of half a turn and no holding time every step
goes anywhere (an uncorrelated walk: the mean squared displacement is the number of steps times the step squared).

Needs nothing; it reads no member, so that it does the same with neighbours and without. The direction held is carried
on by the own turn rate, so that no compass is needed.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.angles import wrap
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS: frozenset[str] = frozenset()
RULES = ("choose", "keep")
SETS = {"nobody": "all"}
DRAWS = 1
MEMORY = 2
TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "-", False, False, False, False)
VALIDATION = Validation("S", True, "-", "-", "-", "bounded free")
NO_ROW = "the control that knows nobody, of section 6.3.3; the tables hold the rules of its publication only"
FILLED = (Filled("motion computation", "the distribution of turns and of steps", "uniform turns, steps of one length"),)
HERD = Herd(spacing_m=4.0, speed_m_s=1.0, dt_s=1.0, space="bounded")
CREATE = {"speed_m_s": 0.25, "hold_s": 3.0, "turn_rad": 1.0}

LEFT_S, BEARING_RAD = 0, 1
"""What the memory holds: time until the next choice, and the chosen direction in the body's frame."""


class Parameters(NamedTuple):
    """Of random motion."""

    speed_m_s: Annotated[float, Parameter("m/s", "our choice: one body-length an update", low=0.0)] = 1.0
    turn_rad: Annotated[float, Parameter("rad", "our choice: any direction", low=0.0, high=math.pi)] = math.pi
    hold_s: Annotated[float, Parameter("s", "our choice: a new direction at every update", low=0.0)] = 0.0


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: the direction drawn, or the one kept."""
    memory[LEFT_S] -= own.dt
    if memory[LEFT_S] > 0.0:
        memory[BEARING_RAD] = wrap(memory[BEARING_RAD] - own.turn_rate * own.dt)
        return Motion(Kind.HEADING, memory[BEARING_RAD], parameters.speed_m_s, 1)
    memory[LEFT_S] = parameters.hold_s
    memory[BEARING_RAD] = parameters.turn_rad * (2.0 * u[0] - 1.0)
    return Motion(Kind.HEADING, memory[BEARING_RAD], parameters.speed_m_s, 0)
