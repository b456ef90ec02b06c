"""Occupied cells of a grid as polygons: the borders of cells, exact, then simplified within less than a cell."""

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

TOLERANCES_CELLS = (0.5, 0.25, 0.0)
"""Tolerances of the simplification, in cells; the first by which beams meet the map's own walls is taken. A choice."""


def traced(occupied: Bools, where: str) -> list[Any]:
    """The solids, as shapely polygons with holes, whose borders are those of the occupied cells; in cells.

    Solids that meet at a corner alone are two. Raises `InputError` where there are too many.
    """
    boxes = _runs(occupied)
    if len(boxes) > 10 * MOST_PIECES:
        raise InputError(f"{where} has more than {MOST_PIECES} straight pieces of wall: expected a map with less noise")
    number, labels = cv2.connectedComponents(occupied.astype(np.uint8), connectivity=4)
    owners = labels[boxes[:, 1], boxes[:, 0]]
    order = np.argsort(owners, kind="stable")
    shapes = shapely.box(boxes[order, 0], boxes[order, 1], boxes[order, 2], boxes[order, 3])
    starts = np.searchsorted(owners[order], np.arange(1, number))
    solids = [shapely.union_all(part) for part in np.split(shapes, starts[1:])]
    solids = [shapely.simplify(solid, 0.0) for solid in solids]
    if sum(shapely.get_num_coordinates(solid) for solid in solids) > MOST_PIECES:
        raise InputError(f"{where} has more than {MOST_PIECES} straight pieces of wall: expected a map with less noise")
    return solids


def polygons(solids: list[Any], tolerance: float, in_world: Callable[[Floats], Floats]) -> tuple[Polygon, ...]:
    """The outlines of solids as polygons: free outside of them, and inside of their holes. Metres, world frame.

    `tolerance`: of the simplification, in cells. `in_world`: from places (N, 2) in cells to places in the world.
    """
    found = []
    for solid in solids:
        simple = shapely.simplify(solid, tolerance, preserve_topology=True) if tolerance else solid
        for ring, free in ((simple.exterior, OUTSIDE), *((hole, INSIDE) for hole in simple.interiors)):
            corners = in_world(shapely.get_coordinates(ring)[:-1])
            found.append(Polygon(tuple(map(tuple, corners.tolist())), free))
    return tuple(found)


def _runs(occupied: Bools) -> Any:
    """(R, 4) boxes x0, y0, x1, y1 of the runs of occupied cells in each row, in cells."""
    padded = np.pad(occupied.astype(np.int8), ((0, 0), (1, 1)))
    steps = np.diff(padded, axis=1)
    rows, starts = np.nonzero(steps == 1)
    _, ends = np.nonzero(steps == -1)
    return np.column_stack([starts, rows, ends, rows + 1])
