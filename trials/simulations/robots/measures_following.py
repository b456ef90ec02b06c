"""How robots follow one member, and how they keep their direction while they see nobody.

Source of what is measured: Fine 2015, section 4.2 and figure 4.3: a robot that selects one member follows the leader.
"""

from __future__ import annotations

import math

import numpy as np

from flocking.angles import wrapped
from flocking.types import Bools, Ints, Kind
from trials.types import TrialResult, Updates

SETTLED_S = 0.5
"""Time since the last input from which on a robot counts as blind: scans, latency and the wheels' ramps take about
0.3 s to end a turn."""


def followed(result: TrialResult) -> Ints:
    """(U,) the one member to which all inputs let through to the law belong, at updates with a way-point; else −1."""
    updates = result.updates.as_selected()
    chosen = np.full(len(updates.times), -1, dtype=np.int64)
    own = (updates.kinds == Kind.WAY_POINT) & _of_one_owner(updates)
    chosen[own] = updates.input_owners[updates.input_starts[:-1][own]]
    return chosen


def following(result: TrialResult) -> dict[str, float]:
    """The measures of this file; nan where there were no updates to measure on."""
    updates = result.updates
    return {
        "follow_share": _share(followed(result) >= 0, updates.kinds == Kind.WAY_POINT),
        "blind_turn_rad_s": _blind_turn(updates),
    }


def _blind_turn(updates: Updates) -> float:
    """Mean turn rate (rad/s), whichever way, of robots that have seen nobody for `SETTLED_S`, from update to update."""
    order = np.lexsort((updates.times, updates.robots))
    robots, times, headings = updates.robots[order], updates.times[order], updates.poses_w[order, 2]
    seeing = np.diff(updates.input_starts)[order] > 0
    first = np.append(True, robots[1:] != robots[:-1])[: len(robots)]
    since = np.maximum.accumulate(np.where(seeing | first, np.arange(len(robots)), 0))
    settled = (robots[1:] == robots[:-1]) & ~seeing[:-1] & (times[:-1] - times[since[:-1]] >= SETTLED_S - 1e-9)
    turned = wrapped(headings[1:] - headings[:-1])
    passed = times[1:][settled] - times[:-1][settled]
    return float((np.abs(turned[settled]) / passed).mean()) if settled.any() else math.nan


def _of_one_owner(updates: Updates) -> Bools:
    """(U,) whether an update has inputs and all of them have the same owner."""
    counts = np.diff(updates.input_starts)
    some = np.flatnonzero(counts)
    found = np.zeros(len(counts), dtype=np.bool_)
    if len(some):
        starts = updates.input_starts[some]
        owners = updates.input_owners
        found[some] = np.minimum.reduceat(owners, starts) == np.maximum.reduceat(owners, starts)
    return found


def _share(of: Bools, among: Bools) -> float:
    whole = int(among.sum())
    return int((of & among).sum()) / whole if whole else math.nan
