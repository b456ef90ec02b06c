"""Who is near whom: members binned in square cells, so that a search looks at nine of them. Compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from flocking.compilation import compiled
from flocking.types import Floats, Ints

FEWEST_MEMBERS = 48
"""Below it, looking at everybody is as fast as binning. (measured)"""
FINEST = 1e-6
"""Cells are wider than asked by this part, and at least this part of the herd's width: so there are at most a million
columns, and rounding moves nobody by more than a small part of one."""
FEWEST_CELLS = 4
"""Fewest cells along each axis; with fewer, the nine cells of a search are most of the space."""


class Cells(NamedTuple):
    """Members by cell."""

    columns: int
    """Cells along x; 0 = there are none: look at everybody."""
    rows: int
    folded: bool
    """Whether the last column and row have the first ones beside them: periodic space, or a scattered herd."""
    x0: float
    y0: float
    edge_x: float
    edge_y: float
    starts: Ints
    """(columns · rows + 1,) where the members of each cell begin in `members`."""
    members: Ints
    """(N,) members, cell by cell."""


@compiled
def no_cells() -> Cells:
    """No cells: a search then looks at every member."""
    return Cells(0, 0, False, 0.0, 0.0, 1.0, 1.0, np.empty(0, np.int64), np.empty(0, np.int64))


@compiled
def no_members() -> Ints:
    """An empty list of members."""
    return np.empty(0, np.int64)


@compiled
def binned(positions: Floats, edge: float, period: float) -> Cells:
    """The members in cells at least `edge` wide; none if the space or the herd is too small for them."""
    count = len(positions)
    if not edge < math.inf or count < FEWEST_MEMBERS:
        return no_cells()
    x0, y0, x1, y1 = 0.0, 0.0, period, period
    if period == 0.0:
        x0 = y0 = math.inf
        x1 = y1 = -math.inf
        for i in range(count):
            x0, x1 = min(x0, positions[i, 0]), max(x1, positions[i, 0])
            y0, y1 = min(y0, positions[i, 1]), max(y1, positions[i, 1])
        if not (x1 - x0) + (y1 - y0) < math.inf:
            return no_cells()
    most = 2.0 * count
    if period > 0.0:  # wider cells rather than many empty ones
        edge = max(edge, math.sqrt((x1 - x0) * (y1 - y0) / most))
    else:  # so wide that cells can be counted without a slip of rounding
        edge = max(edge, FINEST * max(x1 - x0, y1 - y0)) * (1.0 + FINEST)
        if edge == 0.0:
            return no_cells()
    if period == 0.0 and (math.floor((x1 - x0) / edge) + 1.0) * (math.floor((y1 - y0) / edge) + 1.0) > most:
        # a scattered herd shares its cells with those far away, like one map folded many times
        columns = rows = int(max(FEWEST_CELLS, math.ceil(math.sqrt(most))))
        return filled(positions, Cells(columns, rows, True, x0, y0, edge, edge, no_members(), no_members()))
    columns = int(max(1.0, math.floor((x1 - x0) / edge)))
    rows = int(max(1.0, math.floor((y1 - y0) / edge)))
    if columns * rows < FEWEST_CELLS * FEWEST_CELLS or (period > 0.0 and min(columns, rows) < FEWEST_CELLS):
        return no_cells()
    edge_x = max((x1 - x0) / columns, edge)
    edge_y = max((y1 - y0) / rows, edge)
    return filled(positions, Cells(columns, rows, period > 0.0, x0, y0, edge_x, edge_y, no_members(), no_members()))


@compiled
def filled(positions: Floats, cells: Cells) -> Cells:
    """The empty cells with the members in them."""
    count = len(positions)
    starts = np.zeros(cells.columns * cells.rows + 1, np.int64)
    which = np.empty(count, np.int64)
    for i in range(count):
        column, row = cell_of(cells, positions[i, 0], positions[i, 1])
        which[i] = row * cells.columns + column
        starts[which[i] + 1] += 1
    for c in range(cells.columns * cells.rows):
        starts[c + 1] += starts[c]
    at = starts[:-1].copy()
    members = np.empty(count, np.int64)
    for i in range(count):
        members[at[which[i]]] = i
        at[which[i]] += 1
    return Cells(
        cells.columns, cells.rows, cells.folded, cells.x0, cells.y0, cells.edge_x, cells.edge_y, starts, members
    )


@compiled
def cells_of(cells: Cells, members: Ints) -> Cells:
    """The same cells with other names for their members, in the same order."""
    return Cells(
        cells.columns, cells.rows, cells.folded, cells.x0, cells.y0, cells.edge_x, cells.edge_y, cells.starts, members
    )


@compiled
def cell_of(cells: Cells, x: float, y: float) -> tuple[int, int]:
    """Column and row in which (x, y) lies."""
    along, up = math.floor((x - cells.x0) / cells.edge_x), math.floor((y - cells.y0) / cells.edge_y)
    if cells.folded:
        return int(along) % cells.columns, int(up) % cells.rows
    return int(min(max(along, 0.0), cells.columns - 1.0)), int(min(max(up, 0.0), cells.rows - 1.0))


@compiled
def nearby(cells: Cells, x: float, y: float, found: Ints) -> int:
    """Writes the pieces of `Cells.members` that hold the nine cells about (x, y); returns how many numbers it wrote.

    `found` (18,) takes each piece's start and end. Three neighbouring cells of a row are one piece where they lie side
    by side.
    """
    column, row = cell_of(cells, x, y)
    count = 0
    for r in range(row - 1, row + 2):
        at = r
        if cells.folded:
            at = r % cells.rows
        elif r < 0 or r >= cells.rows:
            continue
        first, last = column - 1, column + 1
        if cells.folded and (first < 0 or last >= cells.columns):
            for c in range(first, last + 1):
                here = at * cells.columns + c % cells.columns
                found[count], found[count + 1] = cells.starts[here], cells.starts[here + 1]
                count += 2
        else:
            here, there = max(first, 0), min(last, cells.columns - 1)
            found[count] = cells.starts[at * cells.columns + here]
            found[count + 1] = cells.starts[at * cells.columns + there + 1]
            count += 2
    return count
