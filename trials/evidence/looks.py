"""Tests that are looked at more than once, while repeats are added: the levels that keep their error rates.

A claim that is tested at each of K looks, and for which no more repeats are made once a test has shown it or its
contrary, has K chances to err. Here every look has the same nominal level (Pocock 1977), lower than the level of the
whole, such that the whole procedure errs as often as one test of fixed n: eight looks at equal distances at a two-sided
0.0119 err in 5 %.

A p-value of one look becomes one of the whole procedure: the chance that, were the claim false, the p-value of any of
the planned looks would be as small. It is computed by recursive numerical integration over the looks' normal statistics
with independent increments (Armitage, McPherson and Rowe 1969; Jennison and Turnbull 2000, "Group Sequential Methods
with Applications to Clinical Trials", chapters 2 and 19), one-sided, and holds for t and sign tests by their p-values
(the significance-level approach, Jennison and Turnbull 2000, section 3.8 for t; a sign test's p-values are larger than
normal ones at all levels). Since what comes out is a p-value at every level, claims of several outcomes are decided as
ever: all must hold (intersection-union), or one fails after Holm's correction. Intervals are at the nominal level, and
hold at all looks together (repeated confidence intervals, Jennison and Turnbull 1989).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache

import numpy as np
from scipy import stats
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from flocking.errors import InputError
from flocking.types import Floats

MOST = 8
"""Looks that a plan has at most. A choice: more looks cost power and save few repeats."""
_LOWEST, _HIGHEST = -4.0, 8.0
"""Normal quantiles between which the chances are tabled; below, any look crosses."""
_NODES = 120
"""Of the quadrature over one look's statistic: with 240 the level of eight looks differs by less than 1e-9."""
_PLANNED: ContextVar[tuple[int, ...]] = ContextVar("_PLANNED", default=())


def planned_looks(block: int, most: int | None = None) -> tuple[int, ...]:
    """Repeats at each look: blocks of `block`, `MOST` of them, or up to `most` repeats in at most `MOST` looks.

    Raises `InputError` if `most` is too few for one look.
    """
    if most is None:
        return tuple(block * look for look in range(1, MOST + 1))
    if most < 1:
        raise InputError(f"a budget of {most} repeats: expected at least 1")
    step = max(min(block, most), -(-most // MOST))
    return (*range(step, most, step), most)


@contextmanager
def among(looks: Sequence[int]) -> Iterator[None]:
    """Has the tests made within it be those of one look among these, given by their numbers of repeats."""
    token = _PLANNED.set(tuple(looks))
    try:
        yield
    finally:
        _PLANNED.reset(token)


def overall(p: float) -> float:
    """A one-sided p-value of one look, as one of all planned looks; as it is where there is no plan."""
    looks = _PLANNED.get()
    if len(looks) < 2 or not 0.0 < p < 1.0:
        return p
    quantile = float(stats.norm.isf(p))
    if quantile <= _LOWEST:
        return 1.0
    if quantile >= _HIGHEST:
        return min(1.0, p * len(looks))
    return min(1.0, max(p, float(np.exp(_table(looks)(quantile)))))


def nominal(level: float) -> float:
    """The one-sided level of each planned look whose whole has `level`; as it is where there is no plan."""
    looks = _PLANNED.get()
    if len(looks) < 2:
        return level
    table, wanted = _table(looks), float(np.log(level))
    return float(stats.norm.sf(brentq(lambda quantile: float(table(quantile)) - wanted, 0.0, _HIGHEST)))


@lru_cache(maxsize=64)
def _table(looks: tuple[int, ...]) -> PchipInterpolator:
    """Logarithm of the chance that any look's statistic lies above a quantile, by the quantile."""
    quantiles = np.linspace(_LOWEST, _HIGHEST, 49)
    return PchipInterpolator(quantiles, np.log([chance(looks, quantile) for quantile in quantiles]))


def chance(looks: Sequence[int], quantile: float) -> float:
    """Chance that the standard normal statistic of any look lies above `quantile`."""
    information = np.asarray(looks, dtype=np.float64)
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    lowest = min(quantile, 0.0) - _HIGHEST
    half = (quantile - lowest) / 2.0
    at, weights = lowest + half * (nodes + 1.0), half * weights
    density: Floats = stats.norm.pdf(at)
    crossed = float(stats.norm.sf(quantile))
    for before, now in itertools.pairwise(information):
        spread = np.sqrt(now - before)
        crossed += float(weights @ (density * stats.norm.sf((quantile * np.sqrt(now) - at * np.sqrt(before)) / spread)))
        moved = (at[:, None] * np.sqrt(now) - at[None, :] * np.sqrt(before)) / spread
        density = (stats.norm.pdf(moved) * np.sqrt(now) / spread) @ (weights * density)
    return crossed
