"""Walls as formations: places for robots along them, and which robot goes where (Fine 2015, section 8.2).

Each wall is approximated by three robots, "a hand-tuned parameter", "equal distance along the wall". Here the wall is
cut into equal parts with a robot in the middle of each, so that the gaps beside the outer robots are half as wide as
those between two. Robots are assigned by the Hungarian method (Kuhn 1955).
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal, NamedTuple

import numpy as np
from scipy import sparse
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist

from flocking.errors import InputError
from flocking.types import Floats, Ints
from generation.free_space import distance
from generation.piloting.plan import ROBOTS_A_WALL, Plan
from generation.piloting.task import Task

Objective = Literal["total", "largest"]
OBJECTIVES: tuple[Objective, ...] = ("total", "largest")
"""What is least over all ways of robots to their places: the sum, or the longest."""


class Held(NamedTuple):
    """Which robots hold which walls."""

    walls: dict[int, Ints]
    """Number of a wall that stands (from 0) → the robots (k,) along it."""
    moving: Ints
    """(M,) robots that have to change their places."""
    places: Floats
    """(M, 2) where they go, m."""


def slots(segment: Floats, robots: int = ROBOTS_A_WALL) -> Floats:
    """(robots, 2) their places along a wall (4,): x0, y0, x1, y1, m."""
    if robots < 1:
        raise InputError(f"{robots} robots a wall; expected at least 1")
    parts = (np.arange(robots) + 0.5) / robots
    return np.asarray(segment[:2] + parts[:, None] * (segment[2:] - segment[:2]), dtype=np.float64)


def along(segments: Floats, robots: int) -> Floats:
    """(robots, 3) poses at equal distances along fences (K, 4), one after the other, each looking along its fence."""
    if robots < 1 or len(segments) == 0:
        raise InputError(f"{robots} robots along {len(segments)} fences; expected one of each at least")
    ways = segments[:, 2:] - segments[:, :2]
    ends = np.cumsum(np.hypot(*ways.T))
    at = (np.arange(robots) + 0.5) / robots * ends[-1]
    of = np.searchsorted(ends, at)
    part = (at - (ends - np.hypot(*ways.T))[of]) / np.hypot(*ways.T)[of]
    return np.column_stack([segments[of, :2] + part[:, None] * ways[of], np.arctan2(ways[of, 1], ways[of, 0])])


def has_room(walls: Floats, segment: Floats, robots: int, radius_m: float) -> bool:
    """Whether robots of that radius can stand along a wall (4,) without touching one another or other walls (W, 4)."""
    places = slots(segment, robots)
    apart = float(np.hypot(*(segment[2:] - segment[:2]))) / robots
    return (robots == 1 or apart > 2.0 * radius_m) and bool((distance(walls, places) > radius_m).all())


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


def change(
    task: Task, plan: Plan, passed: int, places: Floats, held: Mapping[int, Ints] = MappingProxyType({}),
    robots_a_wall: int = ROBOTS_A_WALL, objective: Objective = "total",
) -> Held:  # fmt: skip
    """What pilots at places (R, 2), m, do once so many walls have been passed, where they hold the walls of `held`.

    As many walls as there are robots for stand at a time. Robots of a wall that goes on standing stay; all others are
    assigned to the walls that are next. Raises `InputError` where there are fewer pilots than places.
    """
    standing = plan.standing(passed, len(places) // robots_a_wall)
    kept = {wall: robots for wall, robots in held.items() if wall in standing}
    busy = {int(robot) for robots in kept.values() for robot in robots}
    free = np.array([robot for robot in range(len(places)) if robot not in busy], dtype=np.int64)
    wanted = [wall for wall in standing if wall not in kept]
    goals = [slots(plan.walls[wall].segment(task), robots_a_wall) for wall in wanted]
    targets = np.concatenate([np.empty((0, 2)), *goals])
    robots = free[assigned(places[free], targets, objective)]
    for k, wall in enumerate(wanted):
        kept[wall] = robots[k * robots_a_wall : (k + 1) * robots_a_wall]
    return Held(kept, robots, targets)


def at_first(task: Task, plan: Plan, pilots: int, robots_a_wall: int = ROBOTS_A_WALL) -> Floats:
    """(pilots, 2) where pilots stand at the start: along the walls that stand then, m.

    Raises `InputError` for a number of them that does not make whole walls, or none.
    """
    if pilots < robots_a_wall or pilots % robots_a_wall:
        least = max(1, round(pilots / robots_a_wall)) * robots_a_wall
        raise InputError(
            f"{pilots} pilots for walls of {robots_a_wall} robots; expected a multiple, as {least}: fewer leave places "
            "of a formation empty"
        )
    standing = plan.standing(0, pilots // robots_a_wall)
    if len(standing) * robots_a_wall < pilots:
        raise InputError(
            f"{pilots} pilots for {len(plan.walls)} walls of {robots_a_wall} robots; expected at most "
            f"{len(plan.walls) * robots_a_wall}"
        )
    return np.concatenate([slots(plan.walls[wall].segment(task), robots_a_wall) for wall in standing])
