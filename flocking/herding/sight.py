"""Whom each member of a herd sees, as lists. Compiled."""

from __future__ import annotations

import math

import numpy as np

from flocking.compilation import allocating, borrowing, compiled
from flocking.perception import ARGUMENTS, Step, keep, keep_nearest
from flocking.types import Bools, Floats, Ints


@borrowing
def smallest(values: Floats, count: int, k: int) -> float:
    """The k-th smallest, from 1, of the first `count` values, whose order it changes (Hoare's selection)."""
    low, high, at = 0, count - 1, k - 1
    while low < high:
        a, b, c = values[low], values[(low + high) // 2], values[high]
        pivot = max(min(a, b), min(max(a, b), c))
        i, j = low, high
        while i <= j:
            while values[i] < pivot:
                i += 1
            while values[j] > pivot:
                j -= 1
            if i <= j:
                values[i], values[j] = values[j], values[i]
                i, j = i + 1, j - 1
        if at <= j:
            high = j
        elif at >= i:
            low = i
        else:
            break
    return float(values[at])


@allocating
def keep_k_nearest(positions: Floats, k: int, mask: Bools) -> None:
    """The k nearest of the members that `mask` (M,) holds, as `flocking.perception.keep_nearest` gives them.

    That looks k times at all members; this sorts their distances in part, and leaves ties to it.
    """
    squared, sorted_, count = np.full(len(mask), math.inf), np.empty(len(mask)), 0
    for j in range(len(mask)):
        if mask[j]:
            squared[j] = positions[j, 0] * positions[j, 0] + positions[j, 1] * positions[j, 1]
            sorted_[count] = squared[j]
            count += 1
    if count <= k:
        return
    if k <= 0:
        mask[:] = False
        return
    bound, within = smallest(sorted_, count, k), 0
    for j in range(len(mask)):
        within += squared[j] <= bound
    if within > k:
        keep_nearest(positions, k, mask)
        return
    for j in range(len(mask)):
        mask[j] &= squared[j] <= bound


@compiled
def look(
    steps: Ints,
    given: Floats,
    positions: Floats,
    headings: Floats,
    there: Bools,
    errors: Floats,
    seen: Ints,
    counts: Ints,
) -> None:
    """Writes for each member the others that it sees into the first `counts[i]` places of its row of `seen` (N, N).

    `steps` (K,) and `given` (N, K, ARGUMENTS): the steps of a selection and each member's numbers for them, as in
    `flocking.selection.Program`. `positions` (N, 2), `headings` (N,), world frame. `there` (N,): who can be seen.
    `errors` (N, N, 2) in m, or (0, 0, 2): by how much member i takes member j to be elsewhere, world axes.
    """
    count = len(positions)
    near, bearings, ids = np.empty((count, 2)), np.empty(count), np.empty(count, np.int64)
    nobody, mask, numbers = np.zeros(count, np.bool_), np.empty(count, np.bool_), np.empty(ARGUMENTS)
    errs = len(errors) > 0
    for i in range(count):
        c, s = math.cos(headings[i]), math.sin(headings[i])
        found = 0
        for j in range(count):
            if j == i or not there[j]:
                continue
            dx, dy = positions[j, 0] - positions[i, 0], positions[j, 1] - positions[i, 1]
            if errs:
                dx, dy = dx + errors[i, j, 0], dy + errors[i, j, 1]
            near[found, 0], near[found, 1] = c * dx + s * dy, c * dy - s * dx
            ids[found] = j
            mask[found] = True
            found += 1
        places = near[:found]
        bearings_known = False
        for k in range(len(steps)):
            if steps[k] == Step.ALL:
                continue
            if steps[k] == Step.K_NEAREST:
                keep_k_nearest(places, int(given[i, k, 0]), mask[:found])
                continue
            if steps[k] != Step.DISTANCE_BASED and not bearings_known:
                for m in range(found):
                    bearings[m] = math.atan2(near[m, 1], near[m, 0])
                bearings_known = True
            numbers[:] = given[i, k]
            keep(steps[k], numbers, places, bearings[:found], ids[:found], nobody[:found], nobody[:found], mask[:found])
        counts[i] = 0
        for m in range(found):
            if mask[m]:
                seen[i, counts[i]] = ids[m]
                counts[i] += 1
