"""The probability of success over a map's parameters, with its uncertainty, from configurations at unequal distances.

At a place x the outcomes of configuration i count with the weight w_i = min(1, v_i / v) exp(-d_i^2 / 2). The distance
d_i is in widths of the cell that x lies in, v is the volume of that cell and v_i that of the configuration's own: where
a map is fine, many configurations stand for as much space as one elsewhere. Configurations whose cells were split stand
for none. Random configurations have the cells that they would fill evenly. The probability is then the mean of
Beta(1/2 + Σ w_i k_i, 1/2 + Σ w_i (n_i - k_i)), of k_i successes in n_i simulations with Jeffreys' prior, and its
uncertainty that distribution's 95 % interval. So the surface is fine where the map is. Neighbours count as if their
probability were the same: where it changes within a cell, the interval is too narrow.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy import stats

from flocking.types import Bools, Floats, Ints
from generation.maps.trees import ParameterMap, painted

LEVEL = 0.95
CUT = 4.0
"""Distance, in widths, beyond which nothing counts: a weight of 0.0003."""
AT_A_TIME = 4_000_000


class Surface(NamedTuple):
    """At P places."""

    probability: Floats
    """(P,)."""
    low: Floats
    high: Floats


def surface(map_: ParameterMap, places: Floats) -> Surface:
    """The probability of success at places (P, d) of a map's box; nan in cells of which the schema makes nothing."""
    widths, there = _cells_at(map_, places)
    whole = widths.prod(axis=1)
    shares = _volumes(map_)
    kept = map_.possible & (shares > 0.0)
    shares = shares[kept]
    points, trials, successes = map_.points[kept], map_.judged.trials[kept], map_.judged.successes[kept]
    won, lost = np.full(len(places), math.nan), np.full(len(places), math.nan)
    step = max(1, AT_A_TIME // max(1, len(points)))
    for first in range(0, len(places) if len(points) else 0, step):
        part = slice(first, first + step)
        squared = np.zeros((len(places[part]), len(points)))
        for column, (axis, span) in enumerate(zip(map_.box.axes, map_.box.spans, strict=True)):
            apart = np.abs(places[part, column, None] - points[None, :, column])
            if axis.wraps:
                apart = np.minimum(apart, span - apart)
            squared += (apart / widths[part, column, None]) ** 2
        weights = np.where(squared <= CUT * CUT, np.exp(-0.5 * squared), 0.0)
        weights *= np.minimum(1.0, shares / whole[part, None])
        won[part], lost[part] = 0.5 + weights @ successes, 0.5 + weights @ (trials - successes)
    tail = (1.0 - LEVEL) / 2.0
    won[~there] = math.nan
    return Surface(won / (won + lost), stats.beta.ppf(tail, won, lost), stats.beta.ppf(1.0 - tail, won, lost))


def _volumes(map_: ParameterMap) -> Floats:
    """(C,) the volume that each configuration stands for; 0 where others stand for its cell."""
    whole = float(map_.box.spans.prod())
    if (map_.levels < 0).any():
        return np.full(len(map_.points), whole / max(1, len(map_.points)))
    owner = painted(map_.box, map_.cells, map_.levels, map_.finest)
    counts = np.bincount(owner[owner >= 0], minlength=len(map_.points))
    return whole * counts / owner.size


def _cells_at(map_: ParameterMap, places: Floats) -> tuple[Floats, Bools]:
    """(P, d) the widths of the cells that places lie in, and (P,) whether the schema makes something of those cells."""
    if (map_.levels < 0).any():
        each = max(1.0, len(map_.points)) ** (1.0 / len(map_.box.axes))
        return np.tile(map_.box.spans / each, (len(places), 1)), np.ones(len(places), np.bool_)
    level = map_.finest
    owner = painted(map_.box, map_.cells, map_.levels, level)
    shape = np.array(owner.shape)
    at = np.clip(np.floor((places - map_.box.lows) / map_.box.spans * shape).astype(np.int64), 0, shape - 1)
    here = owner[tuple(at.T)]
    levels = np.where(here >= 0, map_.levels[here], 0)
    cells = np.array([axis.cells for axis in map_.box.axes])
    return map_.box.spans / (cells * 2.0 ** levels[:, None]), map_.possible[here] | (here < 0)


def interval(successes: Ints, trials: Ints) -> tuple[Floats, Floats]:
    """The 95 % interval of each configuration's probability by itself, (C,) each: Jeffreys', as of the surface.

    The simulations of a pair are taken as independent. Where chance alone decides, the two of a pair come out as
    opposites, and the interval is too wide.
    """
    won, lost, tail = 0.5 + successes, 0.5 + trials - successes, (1.0 - LEVEL) / 2.0
    return stats.beta.ppf(tail, won, lost), stats.beta.ppf(1.0 - tail, won, lost)
