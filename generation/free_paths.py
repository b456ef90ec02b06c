"""Where something of a width can get between walls: exact planar geometry, for filters.

Walls are (W, 4) straight pieces x0, y0, x1, y1, m. A path of some width is that of the centre of a disc of that width
which touches no wall; of width 0, that of a point.
"""

from __future__ import annotations

import numpy as np
import shapely

from flocking.types import Bools, Floats

SNAP_M = 1e-6
"""Walls nearer to one another than this are joined, m: by rounding, ends that meet do not. A choice."""
QUARTER = 16
"""Pieces of a quarter of a disc. Its corners are rounded from inside: a gap seems wider than it is by 0.12 % of the
width at the most."""


def hull(walls: Floats) -> shapely.Geometry:
    """The convex hull of walls; no more than a line or nothing where there are few."""
    return shapely.MultiPoint(np.asarray(walls).reshape(-1, 2)).convex_hull


def inside(corners: Floats, places: Floats) -> Bools:
    """(N,) whether places (N, 2) are inside of a polygon with these corners (K, 2), m."""
    found: Bools = shapely.contains_xy(shapely.Polygon(corners), places[:, 0], places[:, 1])
    return found


def is_within(region: shapely.Geometry, around: shapely.Geometry) -> bool:
    """Whether no place of a region is outside of a convex area, but for the rounding of places."""
    return bool(around.buffer(2.0 * SNAP_M).covers(region))


def reached(walls: Floats, place_w: tuple[float, float], width_m: float = 0.0) -> shapely.Polygon | None:
    """All places that a path of that width reaches from a place, cut off beyond all walls; none if it cannot be there.

    A wall that ends within the area is left out of what a point reaches: it is no area.
    """
    place = shapely.Point(place_w)
    pieces = shapely.linestrings(np.asarray(walls, dtype=np.float64).reshape(-1, 2, 2))
    if len(pieces) and shapely.distance(pieces, place).min() <= max(width_m / 2.0, SNAP_M):
        return None
    around = shapely.union_all([shapely.box(*shapely.total_bounds([*pieces, place])).buffer(width_m + 1.0).envelope])
    if width_m > 0.0:
        taken = shapely.union_all(shapely.buffer(pieces, width_m / 2.0, quad_segs=QUARTER))
        parts = shapely.get_parts(shapely.difference(around, taken))
    else:
        lines = shapely.union_all([*pieces, around.boundary], grid_size=SNAP_M)
        parts = shapely.get_parts(shapely.polygonize([lines]))
    inside = parts[shapely.intersects(parts, place)]
    return inside[0] if len(inside) else None
