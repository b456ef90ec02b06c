"""How near walls are to the grid that they came of: beams cast in both.

A beam starts in a free cell, at any place and in any direction, and ends where it meets a wall or leaves the map. In
the grid it is followed from cell border to cell border (Amanatides and Woo 1987, "A fast voxel traversal algorithm for
ray tracing"); among the walls it is intersected with each of them. Neither knows of the other.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from flocking.types import Bools, Floats, Ints

COUNT = 4000
"""Of beams. A choice: the share within a cell is then known to some 0.2 percentage points."""
_SEED = 20150501
_AT_A_TIME = 2_000_000
"""Pairs of a beam and a wall that are held at a time."""


class Error(NamedTuple):
    """How far beams in the world end from where they end in the grid."""

    beams: int
    """How many were cast."""
    share: float
    """Of beams that are at most one cell off."""
    worst_m: float
    """Largest difference, m."""


def error(
    occupied: Bools, free: Bools, cell_m: float, pose_w: tuple[float, float, float], walls: Floats
) -> Error | None:
    """The error of walls (W, 4), m, against cells (rows, columns), the first row lowest; None without a free cell.

    `pose_w`: where the corner of the first cell is, x, y (m) and yaw (rad).
    """
    open_cells = np.flatnonzero(free)
    if len(open_cells) == 0:
        return None
    rng = np.random.default_rng(_SEED)
    rows, columns = np.unravel_index(rng.choice(open_cells, COUNT), free.shape)
    starts = np.column_stack([columns, rows]) + rng.uniform(0.0, 1.0, (COUNT, 2))
    angles = rng.uniform(-math.pi, math.pi, COUNT)
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    in_grid, ends = cast_in_grid(occupied, starts, directions)
    c, s = math.cos(pose_w[2]), math.sin(pose_w[2])
    turn = np.array([[c, s], [-s, c]])
    in_world = cast_among(walls, cell_m * starts @ turn + pose_w[:2], directions @ turn)
    off = np.abs(np.minimum(in_world, cell_m * ends) - cell_m * in_grid)
    return Error(COUNT, float(np.mean(off <= cell_m * (1.0 + 1e-9))), float(off.max()))


def told(error: Error | None, cell_m: float) -> str:
    """One line of the error."""
    if error is None:
        return "no cell is free, so that no beams were cast"
    return (
        f"{error.beams} beams against the map: {100.0 * error.share:.2f} % at most one cell ({cell_m:g} m) off, "
        f"the worst {error.worst_m:.3g} m"
    )


def cast_in_grid(occupied: Bools, starts: Floats, directions: Floats) -> tuple[Floats, Floats]:
    """(N,) length of beams from `starts` (N, 2: column, row) to an occupied cell, and to the border of the grid; cells.

    Where no cell is occupied the first is the second. `directions` (N, 2) have length one.
    """
    rows, columns = occupied.shape
    size = np.array([columns, rows])
    cell = np.floor(starts).astype(np.int64)
    step = np.where(directions >= 0.0, 1, -1)
    with np.errstate(divide="ignore"):
        per_cell = 1.0 / np.abs(directions)
        ahead = np.where(step > 0, cell + 1 - starts, starts - cell)
    after = np.where(np.isfinite(per_cell), ahead * np.where(np.isfinite(per_cell), per_cell, 0.0), math.inf)
    hits, ends = np.full(len(starts), math.nan), np.full(len(starts), math.nan)
    live: Ints = np.arange(len(starts))
    while len(live):
        axis = np.argmin(after[live], axis=1)
        length = after[live, axis]
        cell[live, axis] += step[live, axis]
        after[live, axis] += per_cell[live, axis]
        out = (cell[live, axis] < 0) | (cell[live, axis] >= size[axis])
        ends[live[out]] = length[out]
        live, length = live[~out], length[~out]
        met = occupied[cell[live, 1], cell[live, 0]] & np.isnan(hits[live])
        hits[live[met]] = length[met]
    return np.where(np.isnan(hits), ends, hits), ends


def cast_among(walls: Floats, starts: Floats, directions: Floats) -> Floats:
    """(N,) length of beams from `starts` (N, 2) to the nearest of walls (W, 4), or inf.

    `directions` (N, 2) have length one.
    """
    found = np.full(len(starts), math.inf)
    along_x, along_y = walls[:, 2] - walls[:, 0], walls[:, 3] - walls[:, 1]
    at_a_time = max(1, _AT_A_TIME // max(1, len(walls)))
    for first in range(0, len(starts) if len(walls) else 0, at_a_time):
        rows = slice(first, first + at_a_time)
        dx, dy = directions[rows, :1], directions[rows, 1:]
        to_x, to_y = walls[:, 0] - starts[rows, :1], walls[:, 1] - starts[rows, 1:]
        across = dx * along_y - dy * along_x
        with np.errstate(divide="ignore", invalid="ignore"):
            length = (to_x * along_y - to_y * along_x) / across
            share = (to_x * dy - to_y * dx) / across
        # a beam through the place where two walls meet must not slip between them
        meets = (length >= 0.0) & (share >= -1e-9) & (share <= 1.0 + 1e-9)
        found[rows] = np.where(meets, length, math.inf).min(axis=1)
    return found
