"""Whom each member of a herd sees, as lists. Compiled."""

from __future__ import annotations

import math

import numpy as np

from flocking.compilation import borrowing, compiled
from flocking.perception import ARGUMENTS, Step, keep, keep_nearest
from flocking.types import Bools, Floats, Ints

MOST_TURNS = 100
"""Bounds that are tried: halved fifty times, any two different distances are told apart."""


@borrowing
def bound_of(squared: Floats, count: int, k: int) -> float:
    """A number that k of the `squared` distances, of which `count` are finite and more than k, are within; nan where
    ties leave none.

    Between two bounds it is guessed by how many lie within each, as in a plane these grow with the squared distance,
    and every other time halfway. To count takes no branch that a processor could guess wrong, as sorting does.
    """
    low, high, under, over = 0.0, 0.0, 0, count
    for j in range(len(squared)):
        high = max(high, squared[j] if squared[j] < math.inf else 0.0)
    for turn in range(MOST_TURNS):
        part = (k + 0.5 - under) / (over - under) if turn % 2 == 0 else 0.5
        middle, within = low + min(part, 0.9) * (high - low), 0
        for j in range(len(squared)):
            within += squared[j] <= middle
        if within == k:
            return middle
        if within < k:
            low, under = middle, within
        else:
            high, over = middle, within
    return math.nan


@borrowing
def keep_k_nearest(positions: Floats, k: int, mask: Bools, squared: Floats) -> None:
    """The k nearest of the members that `mask` (M,) holds, as `flocking.perception.keep_nearest` gives them.

    That looks k times at all members; this looks for a distance that k are within, and leaves ties to it. `squared`
    (M,) is room.
    """
    count = 0
    for j in range(len(mask)):
        away = positions[j, 0] * positions[j, 0] + positions[j, 1] * positions[j, 1]
        squared[j] = away if mask[j] else math.inf
        count += mask[j]
    if count <= k:
        return
    bound = bound_of(squared, count, k) if k > 0 else -1.0
    if math.isnan(bound):
        keep_nearest(positions, k, mask)
        return
    for j in range(len(mask)):
        mask[j] = squared[j] <= bound


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
    errs, squared = len(errors) > 0, np.empty(count)
    turned = False  # distances are the same in any axes
    for step in steps:
        turned |= step != Step.ALL and step != Step.K_NEAREST and step != Step.DISTANCE_BASED
    for i in range(count):
        c, s = (math.cos(headings[i]), math.sin(headings[i])) if turned else (1.0, 0.0)
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
                keep_k_nearest(places, int(given[i, k, 0]), mask[:found], squared[:found])
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
