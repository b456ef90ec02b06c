"""The largest group of the members seen: what group-centric information is made of (Fine 2015, section 4.1).

Readings come beam after beam, so that most are linked with the one before: such runs are joined, not readings. By angle
the members are put in the order of their bearings first, and then only the two ends can be linked with one another.
"""

from __future__ import annotations

import math

import numpy as np

from flocking.angles import wrap
from flocking.compilation import allocating, compiled
from flocking.types import Bools, Floats, Ints

TIE = 1e-9
"""Numbers that differ by less are equal: sums of the same terms in another order differ by rounding."""


@allocating
def keep_densest(positions: Floats, bearings: Floats, threshold: float, by_angle: bool, mask: Bools) -> None:
    """MaxConnComponent(): the largest component of the members linked up to the threshold.

    Linked: at most `threshold` apart (m), or, `by_angle`, seen at most that angle apart (rad). Of components equally
    large the one that is denser (its members' mean distance from their mean is smaller), then the one whose mean is
    nearest (by angle: nearest to the nose), then the one with the smaller mean x, y.
    """
    kept = np.flatnonzero(mask)
    if len(kept) == 0:
        return
    points = np.empty((len(kept), 2))
    if by_angle:
        kept = kept[np.argsort(bearings[kept] % (2.0 * math.pi))]
        labels = _groups_by_angle(bearings[kept], threshold)
        points[:, 0], points[:, 1] = np.cos(bearings[kept]), np.sin(bearings[kept])
    else:
        points[:, 0], points[:, 1] = positions[kept, 0], positions[kept, 1]
        labels = _groups_by_distance(points, threshold)
    best = _largest(points, labels, by_angle)
    for place in range(len(kept)):
        if labels[place] != best:
            mask[kept[place]] = False


@allocating
def _groups_by_angle(bearings: Floats, threshold: float) -> Ints:
    """(M,) the component of each of the bearings, which are in order."""
    labels = np.zeros(len(bearings), np.int64)
    for k in range(1, len(bearings)):
        labels[k] = labels[k - 1] + (_turn(bearings[k - 1], bearings[k]) > threshold)
    last = labels[-1]
    if last > 0 and _turn(bearings[-1], bearings[0]) <= threshold:
        for k in range(len(bearings)):
            if labels[k] == last:
                labels[k] = 0
    return labels


@compiled
def _turn(first: float, second: float) -> float:
    return abs(wrap(second - first))


@allocating
def _groups_by_distance(points: Floats, threshold: float) -> Ints:
    """(M,) the component of each of the points (M, 2)."""
    count = len(points)
    starts = np.empty(count + 1, np.int64)
    runs = 0
    for k in range(count):
        if k == 0 or math.hypot(points[k, 0] - points[k - 1, 0], points[k, 1] - points[k - 1, 1]) > threshold:
            starts[runs] = k
            runs += 1
    starts[runs] = count
    boxes = np.empty((runs, 4))
    for run in range(runs):
        of_run = points[starts[run] : starts[run + 1]]
        boxes[run, 0], boxes[run, 1] = of_run[:, 0].min(), of_run[:, 1].min()
        boxes[run, 2], boxes[run, 3] = of_run[:, 0].max(), of_run[:, 1].max()
    joined = np.arange(runs)
    for run in range(runs):
        for other in range(run):
            if joined[run] == joined[other] or _apart(boxes[run], boxes[other]) > threshold:
                continue
            if _touch(points[starts[run] : starts[run + 1]], points[starts[other] : starts[other + 1]], threshold):
                first, second = min(joined[run], joined[other]), max(joined[run], joined[other])
                for k in range(run + 1):
                    if joined[k] == second:
                        joined[k] = first
    labels = np.empty(count, np.int64)
    for run in range(runs):
        labels[starts[run] : starts[run + 1]] = joined[run]
    return labels


@compiled
def _apart(box: Floats, other: Floats) -> float:
    """A distance that points of the one box and of the other are at least apart; boxes are (x0, y0, x1, y1)."""
    return max(box[0] - other[2], other[0] - box[2], box[1] - other[3], other[1] - box[3])


@compiled
def _touch(points: Floats, others: Floats, threshold: float) -> bool:
    """Whether one of the points is linked with one of the others."""
    for k in range(len(points)):
        for j in range(len(others)):
            if math.hypot(points[k, 0] - others[j, 0], points[k, 1] - others[j, 1]) <= threshold:
                return True
    return False


@allocating
def _largest(points: Floats, labels: Ints, by_angle: bool) -> int:
    """The label of the largest component, and of equally large ones the first in the order of `keep_densest`."""
    sizes = np.bincount(labels)
    most = sizes.max()
    best = -1
    best_spread, best_d, best_x, best_y = 0.0, 0.0, 0.0, 0.0
    for label in range(len(sizes)):
        if sizes[label] < most:
            continue
        x, y, spread = 0.0, 0.0, 0.0
        for k in range(len(labels)):
            if labels[k] == label:
                x += points[k, 0] / most
                y += points[k, 1] / most
        for k in range(len(labels)):
            if labels[k] == label:
                spread += math.hypot(points[k, 0] - x, points[k, 1] - y) / most
        d = abs(math.atan2(y, x)) if by_angle else math.hypot(x, y)
        if best == -1 or _less(spread, best_spread, d, best_d, x, best_x, y, best_y):
            best, best_spread, best_d, best_x, best_y = label, spread, d, x, y
    return best


@compiled
def _less(a0: float, b0: float, a1: float, b1: float, a2: float, b2: float, a3: float, b3: float) -> bool:
    """Whether (a0 … a3) comes before (b0 … b3), with ties up to rounding."""
    for a, b in ((a0, b0), (a1, b1), (a2, b2), (a3, b3)):
        if abs(a - b) > TIE * (1.0 + abs(a)):
            return a < b
    return False
