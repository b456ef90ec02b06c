"""Dynamic time warping of two shapes: Berndt and Clifford 1994, named by Fine 2015, section 2.3.1.

The step pattern is the symmetric one of Sakoe and Chiba (1978, form P = 0): a step along one series weighs 1, a
diagonal step 2, and the sum is divided by the sum of both lengths. So the cost is a mean distance in metres, the same
in both directions, and does not prefer short paths. They charge a step the distance at its end, which changes the
cost when both series run backwards, as they do in a mirror; here a step is charged the mean of its two ends (and the
first and the last pair once more), so left and right are equal.
"""

from __future__ import annotations

import math

import numpy as np

from flocking.compilation import borrowing
from flocking.types import Floats


def warp_rows(samples: int) -> Floats:
    """The scratch space that `warp` needs for shapes of `samples` rows."""
    return np.full((4, samples + 2), np.inf)


@borrowing
def warp(a: Floats, b: Floats, band: int, ceiling: float, rows: Floats) -> float:
    """Mean distance (m) of the best alignment of the shapes `a` and `b`, both (S, 2), m.

    Samples further apart in time than `band` are never paired. Once it is sure that the cost exceeds `ceiling`, the
    search is abandoned and inf returned; a cost below or at `ceiling` is exact. `rows` is scratch space.
    """
    last = len(a) - 1
    most = ceiling * 2.0 * len(a)
    end = math.sqrt((a[last, 0] - b[last, 0]) ** 2 + (a[last, 1] - b[last, 1]) ** 2)
    if last > 0:
        first = math.sqrt((a[0, 0] - b[0, 0]) ** 2 + (a[0, 1] - b[0, 1]) ** 2)
        if 1.5 * (first + end) > most:
            return math.inf
    for i in range(last + 1):
        now, before = i & 1, 1 - (i & 1)
        low, high = max(0, i - band), min(last, i + band)
        rows[now, low] = math.inf
        rows[now, high + 2] = math.inf
        least, left, left_distance = math.inf, math.inf, 0.0
        x, y = a[i, 0], a[i, 1]
        for j in range(low, high + 1):
            distance = math.sqrt((x - b[j, 0]) ** 2 + (y - b[j, 1]) ** 2)
            cost = distance
            if i + j > 0:
                cost = left + 0.5 * (left_distance + distance)
                if i > 0:
                    cost = min(cost, rows[before, j + 1] + 0.5 * (rows[before + 2, j + 1] + distance))
                    cost = min(cost, rows[before, j] + rows[before + 2, j] + distance)
            rows[now, j + 1] = cost
            rows[now + 2, j + 1] = distance
            left, left_distance = cost, distance
            least = min(least, cost)
        if least > most:
            return math.inf
    cost = rows[last & 1, last + 1] + end
    return cost / (2.0 * len(a)) if cost <= most else math.inf


@borrowing
def nearest_shape(shape: Floats, templates: Floats, band: int, ceiling: float, enough: float, rows: Floats) -> float:
    """Least warping cost (m) of `shape` (S, 2) among `templates` (K, S, 2); inf if none is at or below `ceiling`.

    Stops at the first template whose cost is at or below `enough`: whether a shape is accepted is then known.
    """
    best = math.inf
    for k in range(len(templates)):
        cost = warp(shape, templates[k], band, min(ceiling, best), rows)
        if cost < best:
            best = cost
            if best <= enough:
                break
    return best
