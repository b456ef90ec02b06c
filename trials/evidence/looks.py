"""Tests that are looked at more than once, while repeats are added: the levels that keep their error rates.

A claim that is tested at each of K looks, and for which no more repeats are made once a test has shown it or its
contrary, has K chances to err. Here every look has the same nominal level (Pocock 1977), lower than the level of the
whole, such that the whole procedure errs as often as one test of fixed n: eight looks at equal distances at a two-sided
0.0120 err in 5 %, where the spread is known.

A p-value of one look becomes one of the whole procedure: the chance that, were the claim false, the p-value of any of
the planned looks would be as small. It is counted in seeded random walks of Student's t, of normal numbers whose mean
lies at the bound of the claim: for few repeats the chance of a normal statistic's walk (Armitage, McPherson and Rowe
1969) is too low, by a twentieth for looks at 7, 14 ... 56. Sign tests are held to the same chances: null batches
show them to err less. Since what comes out is a p-value at every level, claims of several outcomes are decided as
ever: all must hold (intersection-union), or one fails after Holm's correction. Intervals are at the nominal level, and
hold at all looks together.

Sources: Pocock 1977, Biometrika 64; repeated confidence intervals, Jennison and Turnbull 1989; both in Jennison and
Turnbull 2000, "Group Sequential Methods with Applications to Clinical Trials", chapters 2, 4 and 9.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache

import numpy as np
from scipy import special

from flocking.errors import InputError
from flocking.types import Floats

MOST = 8
"""Looks that a plan has at most. A choice: more looks cost power and save few repeats."""
WALKS = 400_000
"""Random walks that are counted: the level of a whole is known to one in a hundred of it."""
FEWEST = 3
"""Repeats below which nothing is decided: two numbers that happen to be equal would prove anything."""
_AT_ONCE = 50_000
_FEWEST = 100
"""Walks below which a chance is not read off: it is then at most that of so many, and the sum over the looks."""
_PLANNED: ContextVar[tuple[int, ...]] = ContextVar("_PLANNED", default=())


def planned_looks(block: int, most: int | None = None) -> tuple[int, ...]:
    """Repeats at each look: blocks of `block`, `MOST` of them, or up to `most` repeats in at most `MOST` looks.

    Raises `InputError` if `most` is too few for one look.
    """
    if most is None:
        return tuple(block * look for look in range(1, MOST + 1))
    if most < FEWEST:
        raise InputError(f"a budget of {most} repeat{'s' * (most != 1)} decides nothing: expected at least {FEWEST}")
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


def overall(p: Floats | float) -> Floats:
    """One-sided p-values (…) of one look, as those of all planned looks; as they are where there is no plan."""
    looks, p = _PLANNED.get(), np.asarray(p, dtype=np.float64)
    if len(looks) < 2:
        return p
    least, chances = _chances(looks)
    with np.errstate(divide="ignore"):
        read = np.exp(np.interp(np.log(p), least, chances))
    found: Floats = np.clip(np.minimum(read, len(looks) * p), p, 1.0)
    return found


def nominal(level: float) -> float:
    """The one-sided level of each planned look whose whole has `level`; as it is where there is no plan."""
    looks = _PLANNED.get()
    if len(looks) < 2:
        return level
    least, chances = _chances(looks)
    read = float(np.exp(np.interp(np.log(level), chances, least, left=-np.inf)))
    return max(read, level / len(looks))


@lru_cache(maxsize=32)
def _chances(looks: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Logarithms of p-values of one look, and of the chance that the p-value of any look is as small."""
    rng = np.random.default_rng(0)
    least = np.sort(np.concatenate([_least(looks, rng) for _ in range(WALKS // _AT_ONCE)]))
    counts = np.unique(np.geomspace(_FEWEST, WALKS, 120).astype(np.int64))
    return np.log(least[counts - 1]), np.log(counts / WALKS)


def _least(looks: tuple[int, ...], rng: np.random.Generator) -> Floats:
    """(W,) the least one-sided p-value of each walk over the looks. Looks at fewer than two numbers test nothing."""
    least, total, square, before = np.ones(_AT_ONCE), np.zeros(_AT_ONCE), np.zeros(_AT_ONCE), 0
    p = np.geomspace(1e-12, 1.0 - 1e-9, 4000)
    for n in looks:
        more, before = n - before, n
        added = np.sqrt(more) * rng.standard_normal(_AT_ONCE)
        total += added
        square += added**2 / more + 2.0 * rng.standard_gamma((more - 1) / 2.0, _AT_ONCE)
        if n > 1:
            t = total / np.sqrt(n * (square - total**2 / n) / (n - 1))
            least = np.minimum(least, np.exp(np.interp(-t, special.stdtrit(n - 1, p), np.log(p))))
    return least
