"""The probability of success over a map's parameters, with its uncertainty, from configurations at unequal distances.

At a place x the outcomes of all configurations i count with the weight w_i = exp(-d_i^2 / 2), where d_i is the distance
in widths of the cell that x lies in (of a map of random configurations: of the cells that they would fill evenly). The
probability is then the mean of Beta(1/2 + Σ w_i k_i, 1/2 + Σ w_i (n_i - k_i)), of k_i successes in n_i simulations
with Jeffreys' prior, and its uncertainty that distribution's 95 % interval. So the surface is fine where the map is.
Neighbours count as if their probability were the same: where it changes within a cell, the interval is too narrow.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy import stats

from flocking.types import Floats, Ints
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
    """The probability of success at places (P, d) of a map's box. nan without a possible configuration."""
    widths = _widths(map_, places)
    kept = map_.possible
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
        won[part], lost[part] = 0.5 + weights @ successes, 0.5 + weights @ (trials - successes)
    tail = (1.0 - LEVEL) / 2.0
    return Surface(won / (won + lost), stats.beta.ppf(tail, won, lost), stats.beta.ppf(1.0 - tail, won, lost))


def _widths(map_: ParameterMap, places: Floats) -> Floats:
    """(P, d) the widths of the cells that places lie in."""
    if (map_.levels < 0).any():
        each = max(1.0, len(map_.points)) ** (1.0 / len(map_.box.axes))
        return np.tile(map_.box.spans / each, (len(places), 1))
    level = map_.finest
    owner = painted(map_.box, map_.cells, map_.levels, level)
    shape = np.array(owner.shape)
    at = np.clip(np.floor((places - map_.box.lows) / map_.box.spans * shape).astype(np.int64), 0, shape - 1)
    levels = np.where(owner >= 0, map_.levels[owner], 0)[tuple(at.T)]
    cells = np.array([axis.cells for axis in map_.box.axes])
    found: Floats = map_.box.spans / (cells * 2.0 ** levels[:, None])
    return found


def interval(successes: Ints, trials: Ints) -> tuple[Floats, Floats]:
    """The 95 % interval of each configuration's probability by itself, (C,) each: Jeffreys', as of the surface.

    The simulations of a pair are taken as independent. Where chance alone decides, the two of a pair come out as
    opposites, and the interval is too wide.
    """
    won, lost, tail = 0.5 + successes, 0.5 + trials - successes, (1.0 - LEVEL) / 2.0
    return stats.beta.ppf(tail, won, lost), stats.beta.ppf(1.0 - tail, won, lost)
