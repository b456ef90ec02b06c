"""Hamilton's two-dimensional model with the merging that he proposed: groups move towards the nearest group.

Source: Hamilton 1971, "Geometry for the selfish herd"; Fine 2015, section 2.1.1: the model forms many small groups, and
"the smaller groups would then move toward the nearest group, producing a single compact group". No rule is printed: the
following is a reading. The unit is the body-length, one metre here.

    nearest neighbour beyond the repulsion distance   one step towards it, as `hamilton_2d`
    else, own group not larger than the nearest one   one step along the line from the own group's middle to that one's
    else                                              the position as it is

Groups: two members, the focal one among them, are of one group where a chain of members joins them, each link at most
`link_m` long. The nearest group is the one with the shortest gap between a member of it and one of the own group. All
members of a group that see the same so take the same step, and the group keeps its shape; of two groups that are
nearest to one another the smaller one moves, equal ones both.

Needs positions. No neighbours: undefined in the publication; the member keeps its motion. No other group in sight, or
middles in one place: the member stands still.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from flocking.compilation import compiled
from flocking.geometry import NOT_FOUND, before, nearest
from flocking.laws._selfish_herd import NOBODY, SIGHT, BodyLengthM, RepulsionM, SightM
from flocking.parameters import Parameter
from flocking.steps import step
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import unit
from flocking.types import Bools, Floats, Ints, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions"})
RULES = ("none", "snn", "merge", "rest")
SETS = {"detected": "distance-based(0, range_m)"}
TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "-", False, True, False, False)
VALIDATION = Validation("S", True, "global", "-", "-", "unbounded free")
FILLED = (
    Filled("neighbour selection", "what a group is", "members joined by chains of links of at most three body-lengths"),
    Filled("motion computation", "which groups move", "those not larger than the group nearest to them"),
    Filled("motion computation", "where a group moves", "all its members in parallel, from its middle to the other's"),
    SIGHT,
    NOBODY,
)
HERD = Herd(spacing_m=4.0, speed_m_s=1.0, dt_s=1.0)
CREATE = {"step_m": 0.33, "repulsion_m": 0.66, "link_m": 0.99, "range_m": 5.6}

NONE, SNN, MERGE, REST = range(4)
NEGLIGIBLE_M = 1e-9
"""Middles this near to one another give no direction but that of rounding."""


class Parameters(NamedTuple):
    """Of Hamilton's model with merging."""

    step_m: BodyLengthM = 1.0
    repulsion_m: RepulsionM = 2.0
    link_m: Annotated[float, Parameter("m", "our choice: the repulsion distance and a step more", low=0.0)] = 3.0
    range_m: SightM = 100.0


@compiled
def number_groups(positions: Floats, chosen: Bools, link: float, numbers: Ints) -> int:
    """Writes the number of each chosen member's group into `numbers` (M,), 0 = the focal member's; returns how many.

    −1 stands for members that are not chosen.
    """
    count = len(positions)
    waiting = np.empty(count + 1, np.int64)
    numbers[:] = -1
    found = 0
    for first in range(-1, count):
        if first >= 0 and (not chosen[first] or numbers[first] >= 0):
            continue
        if first >= 0:
            numbers[first] = found
        waiting[0], left = first, 1
        while left > 0:
            left -= 1
            i = waiting[left]
            x, y = 0.0, 0.0
            if i >= 0:
                x, y = positions[i, 0], positions[i, 1]
            for j in range(count):
                if chosen[j] and numbers[j] < 0 and math.hypot(positions[j, 0] - x, positions[j, 1] - y) <= link:
                    numbers[j] = found
                    waiting[left] = j
                    left += 1
        found += 1
    return found


@compiled
def nearest_group(positions: Floats, numbers: Ints) -> int:
    """Number of the group with the shortest gap to the focal member's; `NOT_FOUND` if there is none."""
    best, gap = NOT_FOUND, math.inf
    for j in range(len(positions)):
        if numbers[j] <= 0:
            continue
        nearby = math.hypot(positions[j, 0], positions[j, 1])
        for i in range(len(positions)):
            if numbers[i] == 0:
                nearby = min(nearby, math.hypot(positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]))
        if nearby < gap or (nearby == gap and before(positions, j, best)):
            best, gap = j, nearby
    return numbers[best] if best != NOT_FOUND else NOT_FOUND


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Way-point: one step towards the nearest neighbour or, near it, with the group towards the nearest group."""
    positions = members.positions
    k = nearest(positions, sets[0])
    if k == NOT_FOUND:
        return Motion(Kind.HOLD, math.nan, math.nan, NONE)
    rule = SNN
    x, y = unit(positions[k, 0], positions[k, 1])
    if math.hypot(positions[k, 0], positions[k, 1]) <= parameters.repulsion_m:
        rule, x, y = REST, 0.0, 0.0
        numbers = np.empty(len(positions), np.int64)
        number_groups(positions, sets[0], parameters.link_m, numbers)
        other = nearest_group(positions, numbers)
        if other != NOT_FOUND:
            mine, theirs = 1.0, 0.0
            mine_x = mine_y = theirs_x = theirs_y = 0.0
            for j in range(len(positions)):
                if numbers[j] == 0:
                    mine, mine_x, mine_y = mine + 1.0, mine_x + positions[j, 0], mine_y + positions[j, 1]
                elif numbers[j] == other:
                    theirs, theirs_x, theirs_y = theirs + 1.0, theirs_x + positions[j, 0], theirs_y + positions[j, 1]
            gap_x, gap_y = theirs_x / theirs - mine_x / mine, theirs_y / theirs - mine_y / mine
            if mine <= theirs and math.hypot(gap_x, gap_y) > NEGLIGIBLE_M:
                rule = MERGE
                x, y = unit(gap_x, gap_y)
    return step(x, y, parameters.step_m, rule)
