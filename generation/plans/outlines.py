"""Occupied cells of a grid as polygons, whose sides are the borders of cells.

Nothing is simplified: within half a cell that saves some hundredth of the sides, and makes corners so sharp that no
wall has room behind them. Cells that meet at a corner alone, as in a slanting line one cell wide, let no beam of the
grid through, and are joined by a small square about that corner.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import cv2
import numpy as np
import shapely

from flocking.errors import InputError
from flocking.types import Bools, Floats
from generation.checking import MOST_PIECES
from generation.primitives import INSIDE, OUTSIDE, Polygon

JOINT_CELLS = 0.2
"""Half the side of the square that joins cells at a corner, in cells. A choice: well under a cell."""


def polygons(occupied: Bools, in_world: Callable[[Floats], Floats], where: str) -> tuple[Polygon, ...]:
    """The outlines of occupied cells: free outside of each solid, and inside of its holes. Metres, world frame.

    `occupied`: (rows, columns), the first row lowest. `in_world`: from places (N, 2) in the grid (column and row from
    its corner, in cells) to places in the world. Raises `InputError` where there are too many.
    """
    found, count = [], 0
    for solid in _solids(occupied, where):
        for ring, free in ((solid.exterior, OUTSIDE), *((hole, INSIDE) for hole in solid.interiors)):
            corners = in_world(shapely.get_coordinates(ring)[:-1])
            count += len(corners)
            if count > MOST_PIECES:
                raise _too_many(where)
            found.append(Polygon(tuple(map(tuple, corners.tolist())), free))
    return tuple(found)


def _solids(occupied: Bools, where: str) -> list[Any]:
    """Cells and joints that hang together, as shapely polygons with holes and without corners on a side; in cells."""
    boxes = np.vstack([_runs(occupied), _joints(occupied)])
    if len(boxes) > MOST_PIECES:
        raise _too_many(where)
    number, labels = cv2.connectedComponents(occupied.astype(np.uint8), connectivity=8)
    # a joint's centre is the corner of four cells, of which at least one is occupied, all in one component
    around = labels[np.floor(boxes[:, 1]).astype(np.int64), np.floor(boxes[:, 0]).astype(np.int64)]
    beside = labels[np.floor(boxes[:, 1]).astype(np.int64), np.ceil(boxes[:, 2] - 1.0).astype(np.int64)]
    owners = np.maximum(around, beside)
    order = np.argsort(owners, kind="stable")
    shapes = shapely.box(*boxes[order].T)
    starts = np.searchsorted(owners[order], np.arange(1, number))
    return [shapely.simplify(shapely.union_all(part), 0.0) for part in np.split(shapes, starts[1:])]


def _runs(occupied: Bools) -> Floats:
    """(R, 4) boxes x0, y0, x1, y1 of the runs of occupied cells in each row, in cells."""
    padded = np.pad(occupied.astype(np.int8), ((0, 0), (1, 1)))
    steps = np.diff(padded, axis=1)
    rows, starts = np.nonzero(steps == 1)
    _, ends = np.nonzero(steps == -1)
    return np.column_stack([starts, rows, ends, rows + 1]).astype(np.float64)


def _joints(occupied: Bools) -> Floats:
    """(J, 4) squares about the corners at which two occupied cells meet and the other two are not occupied."""
    a, b, c, d = occupied[:-1, :-1], occupied[:-1, 1:], occupied[1:, :-1], occupied[1:, 1:]
    rows, columns = np.nonzero((a & d & ~b & ~c) | (b & c & ~a & ~d))
    x, y = columns + 1.0, rows + 1.0
    return np.column_stack([x - JOINT_CELLS, y - JOINT_CELLS, x + JOINT_CELLS, y + JOINT_CELLS])


def _too_many(where: str) -> InputError:
    return InputError(f"{where} has more than {MOST_PIECES} straight pieces of wall: expected a map with less noise")
