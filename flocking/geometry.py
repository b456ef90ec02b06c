"""Terms that laws share: distances, lines between members, nearest neighbours."""

from __future__ import annotations

import math

from flocking.compilation import compiled
from flocking.types import Bools, Floats

NOT_FOUND = -1


@compiled
def distance(positions: Floats, i: int, j: int) -> float:
    """Distance between rows i and j of `positions` (M, 2), m."""
    return math.hypot(positions[i, 0] - positions[j, 0], positions[i, 1] - positions[j, 1])


@compiled
def line(positions: Floats, i: int, j: int) -> tuple[float, float, float]:
    """Distance (m) between rows i and j of `positions` (M, 2), and the unit vector from i to j; the two lie apart."""
    gap = distance(positions, i, j)
    return gap, (positions[j, 0] - positions[i, 0]) / gap, (positions[j, 1] - positions[i, 1]) / gap


@compiled
def before(positions: Floats, i: int, j: int) -> bool:
    """Whether row i comes before row j when nothing else tells them apart: nearer, then smaller x, then smaller y.

    Laws that break ties so do not depend on the order of neighbours.
    """
    xi, yi, xj, yj = positions[i, 0], positions[i, 1], positions[j, 0], positions[j, 1]
    squared_i, squared_j = xi * xi + yi * yi, xj * xj + yj * yj
    if squared_i != squared_j:
        return squared_i < squared_j
    return xi < xj if xi != xj else yi < yj


@compiled
def nearest(positions: Floats, chosen: Bools) -> int:
    """Row of the member nearest to the focal member among the chosen ones, `NOT_FOUND` if there is none."""
    best = NOT_FOUND
    for i in range(len(positions)):
        if chosen[i] and (best == NOT_FOUND or before(positions, i, best)):
            best = i
    return best


@compiled
def nearest_to(positions: Floats, chosen: Bools, focus: int, beyond: float) -> int:
    """Row of the chosen member nearest to row `focus` among those farther from it than `beyond` (m).

    Never `focus` itself; `NOT_FOUND` if there is none.
    """
    best = NOT_FOUND
    best_gap = math.inf
    for i in range(len(positions)):
        if i == focus or not chosen[i]:
            continue
        gap = distance(positions, i, focus)
        if gap <= beyond or gap > best_gap:
            continue
        if gap < best_gap or before(positions, i, best):
            best, best_gap = i, gap
    return best
