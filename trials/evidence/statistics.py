"""How a claim is decided from a handful of repeats.

All tests are on n independent numbers, one a repeat: a paired difference between two conditions (same repeat
= same start and noise), or a measure of one condition. Every test gives two p-values, that the claim holds
and that it does not, and so one of three verdicts: true, false, or None (undecided: at this n neither is
shown).

Each test is of the mean, by Student's t, or, `exact`, of the median, by the sign test, which supposes nothing of how
the numbers are distributed. Shares near 0 and 1 are tested exactly: most of their repeats lie at the bound and a few
far off, and t takes a sample that lacks those few for a proof. No test of their mean that supposes nothing can be had:
a share that is 0 in one trial of twenty and 1 in all others has a mean of 0.95, and 0.95^7 = 70 % of all samples of
seven are all 1.

Within `looks.among` every test is that of one look among several: its p-values and its intervals are those of the whole
procedure, and so are the verdicts.

Sources: Student's t; sign test and interval of the median, Conover 1999, "Practical Nonparametric Statistics", sections
3.2 and 3.4 (`scipy.stats.quantile_test`); two one-sided tests, Schuirmann 1987; intersection-union, Berger 1982; Holm
1979; Hedges 1981.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy import special

from flocking.types import Floats
from trials.evidence.looks import FEWEST as FEWEST
from trials.evidence.looks import nominal, overall

ALPHA = 0.05
"""Level of every verdict."""

NEAR_A_BOUND = 0.1
"""Shares whose mean lies within this of 0 or 1 are tested exactly. A choice."""


class Decision(NamedTuple):
    """The outcome of one test. A p-value below `ALPHA` shows its side."""

    agrees: bool | None
    p_holds: float
    p_fails: float
    measured: float
    """Mean of the n numbers; of an exact test their median."""
    low: float
    high: float
    """Confidence interval of it; of an exact test nan where n is too small for any."""
    n: int
    effect: float
    """Hedges' g: the mean (less the threshold, where there is one) in standard deviations of the n numbers;
    nan where they do not vary."""


def mean_interval(values: Floats, confidence: float = 1.0 - ALPHA) -> tuple[float, float, float]:
    """Mean of `values` (n,) and its confidence interval by Student's t; a bound is nan for n < 2."""
    values = _finite(values)
    mean, error, n = _mean_error(values)
    if n < 2:
        return mean, math.nan, math.nan
    reach = float(special.stdtrit(n - 1, 0.5 + confidence / 2.0)) * error
    return mean, mean - reach, mean + reach


def median_interval(values: Floats, confidence: float = 1.0 - ALPHA) -> tuple[float, float, float]:
    """Median of `values` (n,) and its exact confidence interval, from one of them to another; nan if n is too small."""
    values = _finite(values)
    if len(values) == 0:
        return math.nan, math.nan, math.nan
    from scipy import stats  # takes longer to import than all else here: commands that judge nothing do not wait for it

    interval = stats.quantile_test(values, p=0.5).confidence_interval(confidence)
    return float(np.median(values)), float(interval.low), float(interval.high)


def near_a_bound(shares: Floats, bounds: tuple[float, float] = (0.0, 1.0)) -> bool:
    """Whether the mean of `shares` (n,) lies near one of the two bounds that none of them can pass."""
    shares = _finite(shares)
    mean = float(shares.mean()) if len(shares) else math.nan
    return mean <= bounds[0] + NEAR_A_BOUND or mean >= bounds[1] - NEAR_A_BOUND


def exceeds(values: Floats, threshold: float = 0.0, margin: float = 0.0, exact: bool = False) -> Decision:
    """The claim that the mean of `values` (n,) is above `threshold` by more than `margin`, the least that counts.

    Holds if the 95 % interval lies above threshold + margin; does not hold if it lies below. `exact`: of the median.
    """
    values, bound = _finite(values), threshold + margin
    p_holds = min(1.0, 2.0 * _p_above(values, bound, exact))
    p_fails = min(1.0, 2.0 * _p_above(-values, -bound, exact))
    return _decided(values, p_holds, p_fails, threshold, 1.0 - ALPHA, exact)


def equivalent(values: Floats, margin: float, exact: bool = False) -> Decision:
    """The claim that the mean of `values` (n,), paired differences, lies within ±`margin`.

    Holds if the 90 % interval lies within (two one-sided tests). Does not hold if the 95 % interval lies
    wholly outside. The interval given is the 90 % one. `exact`: of the median.
    """
    values = _finite(values)
    p_holds = max(_p_above(values, -margin, exact), _p_above(-values, -margin, exact))
    p_fails = min(1.0, 2.0 * min(_p_above(values, margin, exact), _p_above(-values, margin, exact)))
    return _decided(values, p_holds, p_fails, 0.0, 1.0 - 2.0 * ALPHA, exact)


def all_hold(decisions: Sequence[Decision]) -> bool | None:
    """The claim that every one of several holds.

    True if each does by itself (intersection-union: no correction is needed). False if one does not, its
    p-value corrected for their number (Holm). Else None.
    """
    if all(decision.agrees is True for decision in decisions):
        return True
    if min(holm([decision.p_fails for decision in decisions])) < ALPHA:
        return False
    return None


def some_hold(groups: Sequence[Sequence[Decision]]) -> bool | None:
    """The claim that in at least one of several groups every decision holds.

    True if one group's largest p-value, corrected for the number of groups (Holm), shows it. False if every
    group is shown not to hold. Else None.
    """
    if min(holm([max(decision.p_holds for decision in group) for group in groups])) < ALPHA:
        return True
    if all(all_hold(group) is False for group in groups):
        return False
    return None


def holm(p_values: Sequence[float]) -> list[float]:
    """Holm's step-down adjusted p-values, in the order given."""
    order = sorted(range(len(p_values)), key=lambda k: p_values[k])
    adjusted, least = [1.0] * len(p_values), 0.0
    for rank, k in enumerate(order):
        least = max(least, min(1.0, (len(p_values) - rank) * p_values[k]))
        adjusted[k] = least
    return adjusted


def slopes(x: Floats, outcomes: Floats) -> Floats:
    """Least-squares slope of each repeat's outcomes (n, K) over `x` (K,): (n,), to be tested as n numbers are."""
    x, outcomes = np.asarray(x, dtype=np.float64), np.asarray(outcomes, dtype=np.float64)
    centred = x - x.mean()
    slope: Floats = (outcomes - outcomes.mean(axis=1, keepdims=True)) @ centred / (centred @ centred)
    return slope


def hedges_g(values: Floats, threshold: float = 0.0) -> float:
    """Mean of `values` (n,) less `threshold` in standard deviations, corrected for small n; nan if they are equal."""
    values = _finite(values)
    n = len(values)
    if n < 2 or not (deviation := float(values.std(ddof=1))) > 1e-12:
        return math.nan
    correction = 1.0 - 3.0 / (4.0 * (n - 1) - 1.0)
    return correction * (float(values.mean()) - threshold) / deviation


def _decided(
    values: Floats, p_holds: float, p_fails: float, threshold: float, confidence: float, exact: bool
) -> Decision:
    agrees = False if p_fails < ALPHA else True if p_holds < ALPHA else None
    wide = 1.0 - 2.0 * nominal((1.0 - confidence) / 2.0)
    middle, low, high = (median_interval if exact else mean_interval)(values, wide)
    return Decision(agrees, p_holds, p_fails, middle, low, high, len(values), hedges_g(values, threshold))


def _p_above(values: Floats, bound: float, exact: bool) -> float:
    """One-sided p-value for a mean, or a median, above `bound`, of all planned looks; 1 below `FEWEST` values."""
    mean, error, n = _mean_error(values)
    if n < FEWEST:
        return 1.0
    if exact:
        return float(overall(special.bdtrc(int((values > bound).sum()) - 1, n, 0.5)))
    if error <= 1e-12 * max(1.0, abs(bound)):  # all alike, up to rounding
        return 0.0 if mean > bound else 1.0
    return float(overall(special.stdtr(n - 1, (bound - mean) / error)))


def _mean_error(values: Floats) -> tuple[float, float, int]:
    n = len(values)
    if n == 0:
        return math.nan, math.nan, 0
    return float(values.mean()), float(values.std(ddof=1)) / math.sqrt(n) if n > 1 else math.nan, n


def _finite(values: Floats) -> Floats:
    values = np.asarray(values, dtype=np.float64)
    return values[np.isfinite(values)]
