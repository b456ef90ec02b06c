"""The convex hull of a formation: its area and its perimeter."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from flocking.measures.space import from_centre
from flocking.types import Floats


class Hull(NamedTuple):
    """Of formations (…, N, 2): two arrays (…,)."""

    area: Floats
    """m²; 0 where all members stand on one line."""
    perimeter: Floats
    """m; of a line twice its length, the limit of a narrowing hull; 0 where all stand on one point."""


def convex_hull(positions: Floats, period_m: float | None = None) -> Hull:
    """The convex hull of the members (…, N, 2); nan where one of them is nan.

    In periodic space (`period_m`, the side of the square) of the members' images nearest to the herd's centre: it
    means something for a herd that spans less than half the period.
    """
    offsets = from_centre(positions, period_m)
    shape = offsets.shape[:-2]
    each = np.array([_hull(formation) for formation in offsets.reshape(-1, *offsets.shape[-2:])]).reshape(*shape, 2)
    return Hull(each[..., 0], each[..., 1])


def _hull(points: Floats) -> tuple[float, float]:
    if not np.isfinite(points).all():
        return np.nan, np.nan
    if len(points) > 2:
        try:
            hull = ConvexHull(points)
            return hull.volume, hull.area  # Qhull's names for area and perimeter in the plane
        except QhullError:  # all on one line, to rounding
            pass
    axis = points[np.argmax(np.hypot(points[:, 0], points[:, 1]))]
    length = float(np.hypot(*axis))
    return 0.0, 2.0 * float(np.ptp(points @ axis)) / length if length > 0.0 else 0.0
