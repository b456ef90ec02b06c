"""Success rates, and what an environment adds to them: differences of paired outcomes with their intervals.

Each start was tried twice, with the construct and without it, so that outcomes come in pairs.

Sources: Wilson 1927 for a rate; Newcombe 1998, "Improved confidence intervals for the difference between binomial
proportions based on paired data", method 10; McNemar's test, exact.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy import special, stats

from flocking.types import Bools, Floats

CONFIDENCE = 0.95
RESAMPLES = 2000
"""Of the bootstrap over environments."""


class Rate(NamedTuple):
    """A share with its interval."""

    rate: float
    low: float
    high: float
    n: int


class Uplift(NamedTuple):
    """The rate with the construct less that without it."""

    uplift: float
    low: float
    high: float
    p: float
    """Of the exact test that both rates are equal (McNemar); over environments tried more than once, nan."""
    n: int
    """Pairs."""


def rate(succeeded: Bools, confidence: float = CONFIDENCE) -> Rate:
    """The share of successes (n,), with Wilson's interval; nan of none."""
    n, k = len(succeeded), int(np.sum(succeeded))
    if n == 0:
        return Rate(math.nan, math.nan, math.nan, 0)
    low, high = _wilson(k, n, confidence)
    return Rate(k / n, low, high, n)


def _wilson(k: int, n: int, confidence: float) -> tuple[float, float]:
    z = float(special.ndtri(0.5 + confidence / 2.0))
    centre = (k + z * z / 2.0) / (n + z * z)
    reach = z * math.sqrt(k * (n - k) / n + z * z / 4.0) / (n + z * z)
    return max(0.0, centre - reach) if k else 0.0, min(1.0, centre + reach) if k < n else 1.0


def paired(with_it: Bools, without: Bools, confidence: float = CONFIDENCE) -> Uplift:
    """The uplift of n independent pairs of outcomes, with Newcombe's interval and McNemar's exact p; nan of none."""
    n = len(with_it)
    if n == 0:
        return Uplift(math.nan, math.nan, math.nan, math.nan, 0)
    with_it, without = np.asarray(with_it, np.bool_), np.asarray(without, np.bool_)
    both, gained = int((with_it & without).sum()), int((with_it & ~without).sum())
    lost = int((~with_it & without).sum())
    neither = n - both - gained - lost
    one, other = (both + gained) / n, (both + lost) / n
    low_1, high_1 = _wilson(both + gained, n, confidence)
    low_2, high_2 = _wilson(both + lost, n, confidence)
    product = (both + gained) * (lost + neither) * (both + lost) * (gained + neither)
    phi = 0.0
    if product:
        excess = both * neither - gained * lost
        phi = (max(excess - n / 2.0, 0.0) if excess > 0 else excess) / math.sqrt(product)
    down, up = (one - low_1, high_2 - other), (high_1 - one, other - low_2)
    low = one - other - _joined(down, phi)
    high = one - other + _joined(up, phi)
    changed = gained + lost
    p = float(stats.binomtest(gained, changed, 0.5).pvalue) if changed else 1.0
    return Uplift(one - other, low, high, p, n)


def _joined(reaches: tuple[float, float], phi: float) -> float:
    one, other = reaches
    return math.sqrt(max(one * one - 2.0 * phi * one * other + other * other, 0.0))


def over_environments(with_it: Floats, without: Floats, confidence: float = CONFIDENCE) -> Uplift:
    """The mean uplift of environments with rates (E,) with and without their construct.

    The interval is that of the mean over environments, which are drawn, by the bootstrap's percentiles; repeats within
    an environment are not independent pairs. Where all differences are alike there is nothing to draw from, and the
    interval is that of as many pairs as there are environments.
    """
    differences = np.asarray(with_it, np.float64) - np.asarray(without, np.float64)
    n = len(differences)
    if n < 2:
        return Uplift(float(differences.mean()) if n else math.nan, math.nan, math.nan, math.nan, n)
    if np.ptp(differences) <= 1e-12:
        alike = paired(np.full(n, differences[0] > 0.5), np.full(n, differences[0] < -0.5), confidence)
        mean = float(differences.mean())
        return Uplift(mean, min(mean, alike.low), max(mean, alike.high), math.nan, n)
    rng = np.random.default_rng(0)  # the interval of the same numbers is the same
    means = np.concatenate([differences[rng.integers(0, n, (100, n))].mean(axis=1) for _ in range(RESAMPLES // 100)])
    low, high = np.quantile(means, [0.5 - confidence / 2.0, 0.5 + confidence / 2.0])
    return Uplift(float(differences.mean()), float(low), float(high), math.nan, n)
