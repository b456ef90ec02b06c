"""Who is near whom: members binned in square cells, so that a search looks at nine of them. Compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from flocking.compilation import compiled
from flocking.types import Floats, Ints

FEWEST_MEMBERS = 48
"""Below it, looking at everybody is as fast as binning. (measured)"""
FEWEST_CELLS = 4
"""Along each axis; with fewer, the nine cells are most of the space."""


class Cells(NamedTuple):
    """Members by cell."""

    columns: int
    """Cells along x; 0 = there are none: look at everybody."""
    rows: int
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
    """Look at everybody."""
    return Cells(0, 0, 0.0, 0.0, 1.0, 1.0, np.empty(0, np.int64), np.empty(0, np.int64))


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
    # a scattered herd gets wider cells rather than many empty ones
    edge = max(edge, math.sqrt((x1 - x0) * (y1 - y0) / (2.0 * count)))
    most = 2.0 * count
    columns = int(max(1.0, min(most, math.floor((x1 - x0) / edge))))
    rows = int(max(1.0, min(most, math.floor((y1 - y0) / edge))))
    if columns * rows < FEWEST_CELLS * FEWEST_CELLS or (period > 0.0 and min(columns, rows) < FEWEST_CELLS):
        return no_cells()
    edge_x = max((x1 - x0) / columns, edge)
    edge_y = max((y1 - y0) / rows, edge)
    starts = np.zeros(columns * rows + 1, np.int64)
    which = np.empty(count, np.int64)
    for i in range(count):
        which[i] = _cell(positions[i, 0], positions[i, 1], x0, y0, edge_x, edge_y, columns, rows)
        starts[which[i] + 1] += 1
    for c in range(columns * rows):
        starts[c + 1] += starts[c]
    filled = starts[:-1].copy()
    members = np.empty(count, np.int64)
    for i in range(count):
        members[filled[which[i]]] = i
        filled[which[i]] += 1
    return Cells(columns, rows, x0, y0, edge_x, edge_y, starts, members)


@compiled
def cells_of(cells: Cells, members: Ints) -> Cells:
    """The same cells with other names for their members, in the same order."""
    return Cells(cells.columns, cells.rows, cells.x0, cells.y0, cells.edge_x, cells.edge_y, cells.starts, members)


@compiled
def _cell(x: float, y: float, x0: float, y0: float, edge_x: float, edge_y: float, columns: int, rows: int) -> int:
    column = min(max(int((x - x0) / edge_x), 0), columns - 1)
    row = min(max(int((y - y0) / edge_y), 0), rows - 1)
    return row * columns + column


@compiled
def nearby(cells: Cells, x: float, y: float, period: float, found: Ints) -> int:
    """Writes the slots `start, end` in `Cells.members` of the nine cells about (x, y); returns how many numbers.

    `found` (18,). Rows of three neighbouring cells are one piece where they lie side by side.
    """
    column = min(max(int((x - cells.x0) / cells.edge_x), 0), cells.columns - 1)
    row = min(max(int((y - cells.y0) / cells.edge_y), 0), cells.rows - 1)
    count = 0
    for r in range(row - 1, row + 2):
        at = r
        if period > 0.0:
            at = r % cells.rows
        elif r < 0 or r >= cells.rows:
            continue
        first, last = column - 1, column + 1
        if period > 0.0 and (first < 0 or last >= cells.columns):
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
