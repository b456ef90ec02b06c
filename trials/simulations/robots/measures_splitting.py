"""What is measured of flocks that come apart and join again, in a trial in which a body carries cameras."""

from __future__ import annotations

import math

import numpy as np

from flocking.measures import formation
from flocking.types import Bools, Floats, Ints
from trials.simulations.robots.log import SAMPLE_S
from trials.types import Measure, TrialResult

REACH_M = 8 * 0.3048
"""Robots farther apart are not of one flock: so far robots see one another in Kirchner 2006, section 3.3. The four feet
of the same section (`measures_eyes.FLOCK_CUT_M`) are less than what two Pioneers that keep their distance from lens to
cone may have from centre to centre, so that by them a flock that nothing disturbs comes apart."""
HELD_S = 1.0
"""What a flock is for less than this, apart or one again, does not count. A choice: ten images."""

ABOUT: dict[str, Measure] = {
    "split": Measure(
        "", "1 if the robots were one flock (no gap of eight feet) and then, for a second at least, several; else 0"
    ),
    "split_s": Measure("s", "when they first came apart"),
    "rejoined": Measure("", "of a trial that split: 1 if all are one flock in its last second, else 0"),
    "apart_s": Measure("s", "of a trial that rejoined: time from coming apart to being one flock for good"),
    "flocks_most": Measure("", "the greatest number of such flocks that there was for a second"),
}


def splitting(result: TrialResult) -> dict[str, float]:
    """The measures of `ABOUT`; nan where a trial has no such moment."""
    poses = result.poses_w
    if len(poses) == 0 or not np.isfinite(poses).all():
        return dict.fromkeys(ABOUT, math.nan)
    return of_flocks(result.times, formation.number_of_groups(poses[..., :2], REACH_M))


def of_flocks(times: Floats, flocks: Ints) -> dict[str, float]:
    """The measures of the numbers of flocks (T,) at these times (T,), `SAMPLE_S` apart."""
    found = dict.fromkeys(ABOUT, math.nan)
    length = round(HELD_S / SAMPLE_S) + 1
    most = max((count for count in np.unique(flocks) if _held(flocks >= count, length).any()), default=flocks.min())
    found |= {"flocks_most": float(most), "split": 0.0}
    whole = _held(flocks == 1, length)
    if not whole.any():
        return found | {"split": math.nan}
    first = int(np.flatnonzero(whole)[0])
    apart = np.flatnonzero(_held(flocks > 1, length) & (np.arange(len(flocks)) > first))
    if len(apart) == 0:
        return found
    split = float(times[apart[0]])
    found |= {"split": 1.0, "split_s": split, "rejoined": float(whole[-1])}
    if whole[-1]:
        last = np.flatnonzero(~whole)[-1] + 1
        found["apart_s"] = float(times[last]) - split
    return found


def _held(state: Bools, length: int) -> Bools:
    """(T,) where a state (T,) is true in a stretch of so many samples at least."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], state, [False]]).astype(np.int8)))
    kept = np.zeros(len(state), dtype=np.bool_)
    for start, end in zip(edges[::2], edges[1::2], strict=True):
        kept[start:end] = end - start >= length
    return kept
