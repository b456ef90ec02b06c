"""Terms that laws share: distances and nearest neighbours."""

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
def nearest(positions: Floats, chosen: Bools) -> int:
    """Row of the member nearest to the focal member among the chosen ones, `NOT_FOUND` if there is none.

    Ties go to the smaller x, then the smaller y, so that the order of neighbours does not matter.
    """
    best = NOT_FOUND
    best_squared = math.inf
    for i in range(len(positions)):
        if not chosen[i]:
            continue
        x, y = positions[i, 0], positions[i, 1]
        squared = x * x + y * y
        if squared < best_squared or (
            squared == best_squared
            and best >= 0
            and (x < positions[best, 0] or (x == positions[best, 0] and y < positions[best, 1]))
        ):
            best, best_squared = i, squared
    return best


@compiled
def nearest_to(positions: Floats, chosen: Bools, focus: int, beyond: float) -> int:
    """Row of the chosen member nearest to row `focus` among those farther from it than `beyond` (m).

    Never `focus` itself; `NOT_FOUND` if there is none. Ties go to the one nearer to the focal member.
    """
    best = NOT_FOUND
    best_gap = math.inf
    best_squared = math.inf
    for i in range(len(positions)):
        if i == focus or not chosen[i]:
            continue
        gap = distance(positions, i, focus)
        if gap <= beyond or gap > best_gap:
            continue
        squared = positions[i, 0] ** 2 + positions[i, 1] ** 2
        if gap < best_gap or squared < best_squared:
            best, best_gap, best_squared = i, gap, squared
    return best
