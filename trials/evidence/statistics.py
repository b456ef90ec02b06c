"""How a claim is decided from a handful of repeats.

All tests are on n independent numbers, one a repeat: a paired difference between two conditions (same repeat
= same start and noise), or a measure of one condition. Every test gives two p-values, that the claim holds
and that it does not, and so one of three verdicts: true, false, or None (undecided: at this n neither is
shown).

Sources: Student's t; two one-sided tests, Schuirmann 1987; intersection-union, Berger 1982; Holm 1979; Hedges
1981.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy import stats

from flocking.types import Floats

ALPHA = 0.05
"""Level of every verdict."""

FEWEST = 3
"""Repeats below which nothing is decided: two numbers that happen to be equal would prove anything."""


class Decision(NamedTuple):
    """The outcome of one test. A p-value below `ALPHA` shows its side."""

    agrees: bool | None
    p_holds: float
    p_fails: float
    measured: float
    """Mean of the n numbers."""
    low: float
    high: float
    """Confidence interval of the mean."""
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
    reach = float(stats.t.ppf(0.5 + confidence / 2.0, n - 1)) * error
    return mean, mean - reach, mean + reach


def exceeds(values: Floats, threshold: float = 0.0, margin: float = 0.0) -> Decision:
    """The claim that the mean of `values` (n,) is above `threshold`.

    Holds if the 95 % interval lies above the threshold. Does not hold if it lies below threshold + margin:
    `margin` is the smallest excess that would count, and one as large is then excluded. Should both be so
    (there is an excess, too small to count), it does not hold.
    """
    values = _finite(values)
    p_holds = min(1.0, 2.0 * _p_above(values, threshold))
    p_fails = min(1.0, 2.0 * _p_above(-values, -(threshold + margin)))
    return _decided(values, p_holds, p_fails, threshold, 1.0 - ALPHA)


def equivalent(values: Floats, margin: float) -> Decision:
    """The claim that the mean of `values` (n,), paired differences, lies within ±`margin`.

    Holds if the 90 % interval lies within (two one-sided tests). Does not hold if the 95 % interval lies
    wholly outside. The interval given is the 90 % one.
    """
    values = _finite(values)
    p_holds = max(_p_above(values, -margin), _p_above(-values, -margin))
    p_fails = min(1.0, 2.0 * min(_p_above(values, margin), _p_above(-values, margin)))
    return _decided(values, p_holds, p_fails, 0.0, 1.0 - 2.0 * ALPHA)


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


def _decided(values: Floats, p_holds: float, p_fails: float, threshold: float, confidence: float) -> Decision:
    agrees = False if p_fails < ALPHA else True if p_holds < ALPHA else None
    mean, low, high = mean_interval(values, confidence)
    return Decision(agrees, p_holds, p_fails, mean, low, high, len(values), hedges_g(values, threshold))


def _p_above(values: Floats, bound: float) -> float:
    """One-sided p-value for a mean above `bound`; 1 below `FEWEST` values."""
    mean, error, n = _mean_error(values)
    if n < FEWEST:
        return 1.0
    if error <= 1e-12 * max(1.0, abs(bound)):  # all alike, up to rounding
        return 0.0 if mean > bound else 1.0
    return float(stats.t.sf((mean - bound) / error, n - 1))


def _mean_error(values: Floats) -> tuple[float, float, int]:
    n = len(values)
    if n == 0:
        return math.nan, math.nan, 0
    return float(values.mean()), float(values.std(ddof=1)) / math.sqrt(n) if n > 1 else math.nan, n


def _finite(values: Floats) -> Floats:
    values = np.asarray(values, dtype=np.float64)
    return values[np.isfinite(values)]
