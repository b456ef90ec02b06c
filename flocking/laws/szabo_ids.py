"""Szabo's self-propelled particles as published: the mean of each neighbour's own acceleration.

Source: Szabo, Nagy and Vicsek 2008 (SASO) and 2009 (Physical Review E 79), one law; Fine 2015, table A.1.
v(t + dt) = speed * R(xi) * the unit vector along (s * <v> + (1 - s) * <a> dt), as in `szabo`, but with <a> dt the mean
of v_j(t) - v_j(t - dt) over the neighbours of now and the member itself. Metres, seconds; one step is one second.

Neighbours are told apart by their ids. The velocities of all members within `watch_m` are kept from call to call, so
that whoever comes within range is known already: nobody comes nearer by more than twice the speed in a second, so that
`watch_m` is to exceed the range by that. Whoever was not seen at the last call, or has no id, counts as not
accelerating, and so do those beyond the first `MOST` watched. Velocities are kept relative to the one that the member
then decided on, as in `szabo`.

Needs positions (to select), velocities and ids. No neighbours: the member's own velocity and acceleration. Nothing left
in the sum: the velocity's direction is kept.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.angles import wrap
from flocking.laws.szabo import FIRST_ACCELERATION, ITSELF, ORIENTATIONS, TWO_DIMENSIONS, Noise, RangeM, Share, SpeedMS
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import direction, mean_vector, rotated
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"velocities", "ids"})
RULES = ("align",)
SETS = {"neighbours": "distance-based(0, range_m)", "watched": "distance-based(0, watch_m)"}
RELATIONS = ("range_m at most watch_m",)
MOST = 300
"""Members whose velocities are kept."""
CALLED, OWN_X, OWN_Y, KEPT, FIRST = range(5)
"""What the memory holds; from `FIRST` on, of each member kept, its id and velocity."""
MEMORY = FIRST + 3 * MOST
DRAWS = 1

TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "-", True, True, True, False)
VALIDATION = Validation("S", True, "global", "global", "global", "periodic free")
NO_ROW = "the rule of Szabó et al. with identification, which their row of table 3.2 does not ask for"
FILLED = (
    ORIENTATIONS,
    Filled(
        "sensing",
        "table 3.2 asks for no identification, without which nobody knows how a neighbour has accelerated",
        "neighbours are told apart; `szabo` is the rule for members that cannot",
    ),
    FIRST_ACCELERATION,
    TWO_DIMENSIONS,
    ITSELF,
)
HERD = Herd(spacing_m=0.5, speed_m_s=0.1, dt_s=1.0, space="periodic", updating="forward")
CREATE = {"range_m": 2.0, "watch_m": 2.2, "speed_m_s": 0.25, "velocity_share": 0.8}


class Parameters(NamedTuple):
    """Of Szabo's rule with ids."""

    range_m: RangeM = 1.0
    watch_m: Annotated[
        float, Parameter("m", "the range and twice the speed in a second: who may come within range", low=0.0)
    ] = 1.2
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
        old_x, old_y = rotated(memory[OWN_X], memory[OWN_Y], course)
        change_x, change_y = own.velocity[0] - old_x, own.velocity[1] - old_y
        kept = int(memory[KEPT])
        for j in range(len(members.ids)):
            if not sets[0, j] or members.ids[j] < 0:
                continue
            for k in range(FIRST, FIRST + 3 * kept, 3):
                if memory[k] == members.ids[j]:
                    old_x, old_y = rotated(memory[k + 1], memory[k + 2], course)
                    change_x += members.velocities[j, 0] - old_x
                    change_y += members.velocities[j, 1] - old_y
                    break
        change_x, change_y = change_x / (found + 1), change_y / (found + 1)
    share = parameters.velocity_share
    sum_x = share * x + (1.0 - share) * change_x
    sum_y = share * y + (1.0 - share) * change_y
    wanted = course
    if sum_x != 0.0 or sum_y != 0.0:
        wanted = math.atan2(sum_y, sum_x)
    turn = wrap(wanted + parameters.noise * 2.0 * math.pi * (u[0] - 0.5))
    memory[OWN_X], memory[OWN_Y] = rotated(own.velocity[0], own.velocity[1], -turn)
    at = FIRST
    for j in range(len(members.ids)):
        if sets[1, j] and members.ids[j] >= 0 and at < MEMORY:
            memory[at] = members.ids[j]
            memory[at + 1], memory[at + 2] = rotated(members.velocities[j, 0], members.velocities[j, 1], -turn)
            at += 3
    memory[KEPT] = (at - FIRST) // 3
    memory[CALLED] = 1.0
    return Motion(Kind.HEADING, turn, parameters.speed_m_s, 0)
