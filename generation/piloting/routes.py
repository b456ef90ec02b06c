"""Routes of piloting robots: the shortest ways over a grid of the free space that keep clear of walls and of a herd.

The document says where robots of a formation go and not how (Fine 2015, section 8.2). Here a robot plans by itself: the
free space, cut into cells, is a graph in which the way into a cell costs its length, and more near the herd, so that a
street with a herd in it is gone round rather than through. Dijkstra's algorithm finds the cheapest way.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse
from scipy.spatial.distance import cdist

from flocking.types import Bools, Floats, Ints
from generation.environment import Environment
from generation.free_space import distance, in_solid

CELL_M = 0.15
"""Side of a cell. A choice: ten across a street of 1.5 m."""
BESIDE = 2
"""A choice: beside a wall and a neighbour 0.35 m off, as in a formation, one is too few to get to a place."""
_NEIGHBOURS = ((1, 0), (0, 1), (1, 1), (1, -1))

CLEAR_M = 0.5
"""Cells nearer than this to a member are closed. A choice: two radii of a Create, and one to spare."""
NEAR_M = 1.0
"""Distance from a member within which the way is dearer. A choice: somewhat beyond a Create's look-ahead."""
TIMES = 20.0
"""How many times as dear the way is beside a member. A choice: rather five blocks round than through."""


@dataclass(frozen=True)
class Ground:
    """The free space of a workspace as cells for the centre of a robot."""

    origin: Floats
    """(2,) the centre of the first cell, m."""
    free: Bools
    """(X, Y) which cells a robot can stand in."""

    @cached_property
    def centres(self) -> Floats:
        """(X, Y, 2) m."""
        x, y = (np.arange(count) * CELL_M for count in self.free.shape)
        return np.stack(np.meshgrid(x, y, indexing="ij"), axis=2) + self.origin

    def cell(self, place: Floats) -> tuple[int, int]:
        """The free cell nearest to a place (2,), m."""
        apart = np.hypot(*(self.centres - place).transpose(2, 0, 1))
        found = np.unravel_index(np.where(self.free, apart, math.inf).argmin(), apart.shape)
        return int(found[0]), int(found[1])

    def is_clear(self, start: Floats, end: Floats) -> bool:
        """Whether the straight way from one place (2,) to another leads over free cells alone."""
        count = max(2, math.ceil(2.0 * float(np.hypot(*(end - start))) / CELL_M) + 1)
        places = start + np.linspace(0.0, 1.0, count)[:, None] * (end - start)
        cells = np.rint((places - self.origin) / CELL_M).astype(np.int64)
        inside = ((cells >= 0) & (cells < self.free.shape)).all()
        return bool(inside and self.free[cells[:, 0], cells[:, 1]].all())


def ground(workspace: Environment, radius_m: float) -> Ground:
    """The cells of a workspace in which a disc of that radius touches no wall."""
    walls = workspace.walls()
    ends = walls.reshape(-1, 2)
    low, high = ends.min(axis=0), ends.max(axis=0)
    shape = tuple(int(n) for n in np.ceil((high - low) / CELL_M) + 1)
    cells = Ground(low, np.ones(shape, dtype=np.bool_))
    places = cells.centres.reshape(-1, 2)
    free = (distance(walls, places) >= radius_m) & ~in_solid(workspace, places)
    return Ground(low, free.reshape(shape))


def route(over: Ground, start: Floats, goal: Floats, herd: Floats, blocked: Floats, room_m: float) -> Floats:
    """(K, 2) places from a start (2,) to a goal (2,), both included, m; (0, 2) where no way is open.

    `herd` (M, 2): where members are; `blocked` (B, 2): what else stands in the way, which the robot keeps `room_m` off.
    The cells of the start and of the goal, and `BESIDE` cells on all sides of them, are open whoever stands there; but
    dearer than all others are those that lead nearer by what stands than the start or the goal is itself.
    """
    first, last = over.cell(start), over.cell(goal)
    cost = np.where(over.free, 1.0, math.inf)
    centres = over.centres.reshape(-1, 2)
    if len(herd):
        near = cdist(centres, herd).min(axis=1).reshape(cost.shape)
        cost += TIMES * np.exp(-((near / NEAR_M) ** 2))
        cost[near < CLEAR_M] = math.inf
    if len(blocked):
        cost[cdist(centres, blocked).min(axis=1).reshape(cost.shape) < room_m] = math.inf
    beside = np.full(cost.shape, math.inf)
    for (x, y), place in ((first, start), (last, goal)):
        around = (slice(max(x - BESIDE, 0), x + BESIDE + 1), slice(max(y - BESIDE, 0), y + BESIDE + 1))
        dear = np.where(_nearer(over.centres[around], blocked, place, room_m), TIMES**2, TIMES)
        beside[around] = np.minimum(beside[around], dear)
    cost = np.where(over.free & ~np.isfinite(cost), beside, cost)
    cells = _cheapest(cost, first, last)
    if len(cells) == 0:
        return np.empty((0, 2))
    way = over.centres[cells[:, 0], cells[:, 1]]
    return np.concatenate([np.array([start]), way[1:-1], np.array([goal])])


def _nearer(cells: Floats, blocked: Floats, place: Floats, room_m: float) -> Bools:
    """(X, Y) which cells (X, Y, 2) are nearer to any of what stands (B, 2) than a place (2,) is, and than `room_m`."""
    apart = np.hypot(*(cells[:, :, None] - blocked).transpose(3, 0, 1, 2))
    own = np.hypot(*(blocked - place).T)
    return np.asarray((apart < np.minimum(room_m, own)).any(axis=2))


def _cheapest(cost: Floats, first: tuple[int, int], last: tuple[int, int]) -> Ints:
    """(K, 2) cells of the cheapest way between two cells, both included; none where there is no way."""
    number = np.arange(cost.size).reshape(cost.shape)
    rows, columns, weights = [], [], []
    for dx, dy in _NEIGHBOURS:
        one = (slice(0, cost.shape[0] - dx), slice(max(0, -dy), cost.shape[1] - max(0, dy)))
        other = (slice(dx, cost.shape[0]), slice(max(0, dy), cost.shape[1] + min(0, dy)))
        weight = CELL_M * math.hypot(dx, dy) * (cost[one] + cost[other]) / 2.0
        open_ = np.isfinite(weight)
        rows.append(number[one][open_])
        columns.append(number[other][open_])
        weights.append(weight[open_])
    pairs = (np.concatenate(rows), np.concatenate(columns))
    graph = sparse.csr_matrix((np.concatenate(weights), pairs), shape=(cost.size, cost.size))
    start, end = int(number[first]), int(number[last])
    _, before = sparse.csgraph.dijkstra(graph, directed=False, indices=start, return_predecessors=True)
    found = [end]
    while found[-1] != start:
        step = int(before[found[-1]])
        if step < 0:
            return np.empty((0, 2), dtype=np.int64)
        found.append(step)
    return np.stack(np.unravel_index(found[::-1], cost.shape), axis=1).astype(np.int64)
