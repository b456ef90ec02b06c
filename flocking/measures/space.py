"""What the measures share: gaps, centres, ways and neighbours, in unbounded or periodic space.

Shapes: N members; leading axes (…) pass through. `period_m` is the side of a square whose opposite sides are one
(None = unbounded space); positions may then lie in or outside it. Lengths in metres, or any one unit.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from flocking.types import Floats, Ints


def shortest(gaps: Floats, period_m: float | None = None) -> Floats:
    """The gaps (…, 2) by the shortest way: each component at most half a period."""
    if period_m is None:
        return gaps
    return gaps - period_m * np.round(gaps / period_m)


def centre(positions: Floats, period_m: float | None = None) -> Floats:
    """Mean position of the members (…, N, 2): (…, 2).

    In periodic space the mean of the members' nearest images, seen from the direction of their mean unit vector on
    the circle that each axis is; exact for a group that spans less than half a period.
    """
    positions = np.asarray(positions, dtype=np.float64)
    if period_m is None:
        return positions.mean(axis=-2)
    angles = positions * (2.0 * np.pi / period_m)
    middle = np.arctan2(np.sin(angles).mean(axis=-2), np.cos(angles).mean(axis=-2)) * (period_m / (2.0 * np.pi))
    offsets = shortest(positions - middle[..., None, :], period_m)
    return np.mod(middle + offsets.mean(axis=-2), period_m)


def from_centre(positions: Floats, period_m: float | None = None) -> Floats:
    """Offsets of the members (…, N, 2) from their centre: (…, N, 2)."""
    positions = np.asarray(positions, dtype=np.float64)
    return shortest(positions - centre(positions, period_m)[..., None, :], period_m)


def unwrapped(positions: Floats, period_m: float | None = None) -> Floats:
    """The way through `positions` (T, …, 2) without jumps across the seam.

    Right where no step is half a period long or longer.
    """
    positions = np.asarray(positions, dtype=np.float64)
    return positions if period_m is None else np.unwrap(positions, period=period_m, axis=0)


def tree_of(formations: Floats, reach: float, period_m: float | None = None) -> cKDTree:
    """One tree for all members of the formations (F, N, 2), finite: point f·N + n is member n of formation f.

    Each formation stands in a plane of its own, farther than `reach` from the next.
    """
    frames, count = formations.shape[:2]
    planes = np.broadcast_to((2.0 * reach + 1.0) * np.arange(frames)[:, None, None], (frames, count, 1))
    if period_m is None:
        return cKDTree(np.concatenate([formations, planes], axis=2).reshape(-1, 3))
    inside = np.mod(formations, period_m)
    inside[inside >= period_m] = 0.0  # what rounding put onto the far side
    return cKDTree(np.concatenate([inside, planes], axis=2).reshape(-1, 3), boxsize=[period_m, period_m, 0.0])


def nearest_neighbours(positions: Floats, k: int, period_m: float | None = None) -> tuple[Floats, Ints]:
    """Distances and rows of the k nearest other members of each member (…, N, 2): both (…, N, k), nearest first.

    `k` is at most N − 1. Equally near ones come in no particular order. In a formation with a nan, distances are nan
    and rows 0.
    """
    positions = np.asarray(positions, dtype=np.float64)
    shape, count = positions.shape[:-2], positions.shape[-2]
    formations = positions.reshape(-1, count, 2)
    known = np.asarray(np.isfinite(formations).all(axis=(1, 2)))
    distances, rows = np.full((*known.shape, count, k), np.nan), np.zeros((*known.shape, count, k), dtype=np.int64)
    if known.any() and k > 0:
        finite = formations[known]
        tree = tree_of(finite, float(np.ptp(finite, axis=(0, 1)).sum()), period_m)
        gaps, points = tree.query(tree.data, k=k + 1)
        itself = points == np.arange(len(points))[:, None]
        itself[~itself.any(axis=1), -1] = True  # crowded out by members at the very same place
        distances[known] = gaps[~itself].reshape(-1, count, k)
        rows[known] = points[~itself].reshape(-1, count, k) % count
    return distances.reshape(*shape, count, k), rows.reshape(*shape, count, k)
