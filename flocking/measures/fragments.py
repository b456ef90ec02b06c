"""How a herd falls apart and what it passes, judged at every time of a trajectory: compiled, for thousands of herds.

Shapes: T times of N members (T, N, 2), m, finite. Groups are those of `flocking.measures.groups` (single linkage, a
member alone is a group), which takes its time and is not compiled: tests hold the one against the other.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from flocking.compilation import compiled
from flocking.types import Bools, Floats, Ints


class Fragments(NamedTuple):
    """Of each time (T,)."""

    groups: Ints
    """Number of groups."""
    entropy: Floats
    """Shannon entropy of the groups' shares, relative to ln(number of groups): 1 where all are equally large, 0 for one
    group."""


def fragments(positions: Floats, cut_m: float) -> Fragments:
    """The groups of the members (T, N, 2) that links of at most `cut_m` join."""
    return Fragments(*_fragments(_contiguous(positions), float(cut_m)))


def splits(positions: Floats, cut_m: float, groups: int, entropy: float, consecutive: int) -> bool:
    """Whether the members (T, N, 2) are at least so many groups of at least this entropy so many times in a row."""
    return bool(_splits(_contiguous(positions), float(cut_m), int(groups), float(entropy), int(consecutive)))


def gathers(
    positions: Floats, cut_m: float, place_w: tuple[float, float], radius_m: float, share: float, consecutive: int
) -> bool:
    """Whether one group of at least that share of the members (T, N, 2) has its centroid within a radius of a place so
    many times in a row."""
    x, y = place_w
    positions = _contiguous(positions)
    return bool(_gathers(positions, float(cut_m), float(x), float(y), float(radius_m), float(share), int(consecutive)))


def crossed(positions: Floats, line_w: tuple[float, float, float, float]) -> Bools:
    """(N,) whether members (T, N, 2) crossed the line x0, y0, x1, y1 at some time, in either direction."""
    return _crossed(_contiguous(positions), *map(float, line_w))


def entered(positions: Floats, corners_w: Floats) -> Bools:
    """(N,) whether members (T, N, 2) were inside a polygon with these corners (K, 2) at some time."""
    return _entered(_contiguous(positions), _contiguous(corners_w))


def _contiguous(values: Floats) -> Floats:
    return np.ascontiguousarray(values, dtype=np.float64)


@compiled
def _groups(points: Floats, cut2: float, labels: Ints, queue: Ints) -> int:
    """Writes the group of each point (N, 2) to `labels` (N,), from 0; returns their number. `queue` (N,) is for work.

    Grows one group after the other: each point is compared with those that no group has yet.
    """
    count = len(points)
    for n in range(count):
        queue[n] = n
    groups, done = 0, 0  # the first `done` of the queue have had their neighbours; up to `found` are of a group
    found = 0
    while found < count:
        labels[queue[found]] = groups
        found += 1
        while done < found:
            x, y = points[queue[done]]
            done += 1
            for n in range(found, count):
                other = queue[n]
                dx, dy = points[other, 0] - x, points[other, 1] - y
                if dx * dx + dy * dy <= cut2:
                    labels[other] = groups
                    queue[n], queue[found] = queue[found], other
                    found += 1
        groups += 1
    return groups


@compiled
def _entropy(points: Floats, cut2: float, labels: Ints, queue: Ints) -> tuple[int, float]:
    """The number of groups and the entropy of their shares; `labels` and `queue` (N,) are for work."""
    count = len(points)
    groups = _groups(points, cut2, labels, queue)
    if groups < 2:
        return groups, 0.0
    sizes = queue[:groups]
    sizes[:] = 0
    for n in range(count):
        sizes[labels[n]] += 1
    entropy = 0.0
    for size in sizes:
        entropy -= size / count * math.log(size / count)
    return groups, entropy / math.log(groups)


@compiled
def _fragments(positions: Floats, cut: float) -> tuple[Ints, Floats]:
    times, count = positions.shape[:2]
    groups, entropy = np.zeros(times, np.int64), np.zeros(times)
    labels, queue = np.empty(count, np.int64), np.empty(count, np.int64)
    for t in range(times):
        groups[t], entropy[t] = _entropy(positions[t], cut * cut, labels, queue)
    return groups, entropy


@compiled
def _splits(positions: Floats, cut: float, least: int, entropy: float, consecutive: int) -> bool:
    """Looks at the last time of a possible run first: where nothing is shown there, the whole run is passed over."""
    times, count = positions.shape[:2]
    labels, queue = np.empty(count, np.int64), np.empty(count, np.int64)
    first, known = 0, 0  # shown from `first` up to `known`
    while first + consecutive <= times:
        end = t = first + consecutive
        while t > known:
            groups, found = _entropy(positions[t - 1], cut * cut, labels, queue)
            if groups < least or found < entropy:
                break
            t -= 1
        if t <= known:
            return True
        first, known = t, end
    return False


@compiled
def _is_gathered(points: Floats, cut2: float, x: float, y: float, radius: float, share: float, labels: Ints,
                 queue: Ints, sums: Floats) -> bool:  # fmt: skip
    count = len(points)
    groups = _groups(points, cut2, labels, queue)
    sums[:groups] = 0.0
    for n in range(count):
        sums[labels[n], 0] += points[n, 0]
        sums[labels[n], 1] += points[n, 1]
        sums[labels[n], 2] += 1.0
    for g in range(groups):
        size = sums[g, 2]
        near = math.hypot(sums[g, 0] / size - x, sums[g, 1] / size - y) <= radius
        if near and size >= share * count - 1e-9:  # two thirds of three are two
            return True
    return False


@compiled
def _gathers(positions: Floats, cut: float, x: float, y: float, radius: float, share: float, consecutive: int) -> bool:
    """As `_splits`."""
    times, count = positions.shape[:2]
    labels, queue, sums = np.empty(count, np.int64), np.empty(count, np.int64), np.empty((count, 3))
    first, known = 0, 0
    while first + consecutive <= times:
        end = t = first + consecutive
        while t > known:
            if not _is_gathered(positions[t - 1], cut * cut, x, y, radius, share, labels, queue, sums):
                break
            t -= 1
        if t <= known:
            return True
        first, known = t, end
    return False


@compiled
def _crossed(positions: Floats, x0: float, y0: float, x1: float, y1: float) -> Bools:
    times, count = positions.shape[:2]
    dx, dy = x1 - x0, y1 - y0
    found = np.zeros(count, np.bool_)
    for n in range(count):
        for t in range(1, times):
            ax, ay = positions[t - 1, n, 0] - x0, positions[t - 1, n, 1] - y0
            bx, by = positions[t, n, 0] - x0, positions[t, n, 1] - y0
            before, after = dx * ay - dy * ax, dx * by - dy * bx
            if (before > 0.0) != (after > 0.0):
                share = before / (before - after)
                along = (ax + share * (bx - ax)) * dx + (ay + share * (by - ay)) * dy
                if 0.0 <= along <= dx * dx + dy * dy:
                    found[n] = True
                    break
    return found


@compiled
def _entered(positions: Floats, corners: Floats) -> Bools:
    times, count = positions.shape[:2]
    found = np.zeros(count, np.bool_)
    for n in range(count):
        for t in range(times):
            x, y = positions[t, n]
            inside = False
            for k in range(len(corners)):
                x0, y0 = corners[k - 1]
                x1, y1 = corners[k]
                if (y0 > y) != (y1 > y) and x < x0 + (y - y0) / (y1 - y0) * (x1 - x0):
                    inside = not inside
            if inside:
                found[n] = True
                break
    return found
