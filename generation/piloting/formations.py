"""Walls as formations: places for robots along them, and which robot goes where (Fine 2015, section 8.2).

Each wall is approximated by three robots, "a hand-tuned parameter", "equal distance along the wall". Here the wall is
cut into equal parts with a robot in the middle of each, so that the gaps beside the outer robots are half as wide as
those between two. Robots are assigned by the Hungarian method (Kuhn 1955).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from scipy import sparse
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist

from flocking.errors import InputError
from flocking.types import Floats, Ints
from generation.piloting.plan import Plan
from generation.piloting.task import Task

ROBOTS_A_WALL = 3
"""Fine 2015, section 8.2."""
Objective = Literal["total", "largest"]


class Change(NamedTuple):
    """What pilots do when a stage begins."""

    slots: Floats
    """(S, 2) places of all walls that stand in the stage, wall by wall, m."""
    robots: Ints
    """(S,) which robot goes to each, or stays there."""
    moving: Ints
    """Robots that change their place."""


def slots(segment: Floats, robots: int = ROBOTS_A_WALL) -> Floats:
    """(robots, 2) their places along a wall (4,): x0, y0, x1, y1, m."""
    if robots < 1:
        raise InputError(f"{robots} robots a wall; expected at least 1")
    parts = (np.arange(robots) + 0.5) / robots
    return np.asarray(segment[:2] + parts[:, None] * (segment[2:] - segment[:2]), dtype=np.float64)


def assigned(places: Floats, targets: Floats, objective: Objective = "total") -> Ints:
    """(S,) which of the robots at places (R, 2) goes to each of the targets (S, 2), m.

    `total`: the least sum of straight ways; `largest`: the shortest longest way, and of those that have it the least
    sum. Robots that are left over stay where they are. Raises `InputError` for fewer robots than targets.
    """
    if len(places) < len(targets):
        raise InputError(f"{len(places)} pilots for {len(targets)} places of a formation; expected at least as many")
    ways = cdist(targets, places)
    if objective == "largest" and len(targets):
        ways = np.where(ways <= _bottleneck(ways), ways, 1e3 * (1.0 + ways.sum()))
    return np.asarray(linear_sum_assignment(ways)[1], dtype=np.int64)


def _bottleneck(ways: Floats) -> float:
    """The least longest way with which every target (row) has a robot (column) of its own."""
    lengths = np.unique(ways)
    low, high = 0, len(lengths) - 1
    while low < high:
        middle = (low + high) // 2
        allowed = sparse.csr_matrix(ways <= lengths[middle])
        matched = sparse.csgraph.maximum_bipartite_matching(allowed, perm_type="column")
        if (matched >= 0).all():
            high = middle
        else:
            low = middle + 1
    return float(lengths[low])


def changes(
    task: Task, plan: Plan, places: Floats, robots_a_wall: int = ROBOTS_A_WALL, objective: Objective = "total"
) -> list[Change]:
    """What pilots that begin at places (R, 2) do at the beginning of each stage of a plan, m.

    Robots of a wall that goes on standing stay; those of the wall that was passed, and those that were free, are
    assigned to the next one. Raises `InputError` where there are fewer pilots than places.
    """
    found, at = [], np.array(places, dtype=np.float64)
    holding: dict[int, Ints] = {}
    for passed in range(len(plan.walls)):
        standing = plan.standing(passed)
        holding = {wall: robots for wall, robots in holding.items() if wall in standing}
        free = np.array(sorted(set(range(len(at))) - {int(r) for robots in holding.values() for r in robots}), np.int64)
        wanted = [wall for wall in standing if wall not in holding]
        goals = [slots(plan.walls[wall].segment(task), robots_a_wall) for wall in wanted]
        targets = np.concatenate([np.empty((0, 2)), *goals])
        robots = free[assigned(at[free], targets, objective)]
        at[robots] = targets
        for k, wall in enumerate(wanted):
            holding[wall] = robots[k * robots_a_wall : (k + 1) * robots_a_wall]
        every = np.concatenate([np.empty(0, np.int64), *(holding[wall] for wall in standing)]).astype(np.int64)
        found.append(Change(at[every].copy(), every, np.sort(robots)))
    return found


def most_slots(plan: Plan, robots_a_wall: int = ROBOTS_A_WALL) -> int:
    """The most places that are held at a time."""
    counts: Sequence[int] = [len(plan.standing(passed)) for passed in range(len(plan.walls))]
    return robots_a_wall * max(counts, default=0)
