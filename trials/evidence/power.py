"""The power of a verdict: how often as many repeats would show a claim that is true.

The numbers behind each outcome are supposed to lie about the place where a true claim has them (`Tested.supposed`) and
to spread as those of the run do: samples are normal, with the covariance that the run's repeats have. Of a run of few
repeats that covariance is a rough estimate, and so is the power.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from flocking.types import Bools, Floats
from trials.evidence.outcomes import Outcome, Tested
from trials.evidence.statistics import ALPHA, FEWEST

SAMPLES = 4000
"""The standard error of a power is at most 0.008."""


def power(outcomes: Sequence[Outcome], n: int) -> float:
    """Share of samples of `n` repeats in which every outcome that decides holds; nan where it cannot be told.

    The outcomes of one claim are drawn together where they have the same repeats, and else apart.
    """
    deciding = [outcome for outcome in outcomes if outcome.decides]
    if n < FEWEST or not deciding or any(outcome.tested is None for outcome in deciding):
        return math.nan
    rng = np.random.default_rng(0)
    drawn: dict[int, Floats] = {}
    held = np.ones(SAMPLES, dtype=np.bool_)
    for outcome in deciding:
        tested = outcome.tested
        assert tested is not None
        values = np.asarray(tested.values, dtype=np.float64)
        values = values[np.isfinite(values)]
        count = len(values)
        if count < FEWEST:
            return math.nan
        if count not in drawn:
            drawn[count] = rng.normal(size=(SAMPLES, n, count)) / math.sqrt(count - 1)
        samples = tested.supposed + drawn[count] @ (values - values.mean())
        held &= _holds(outcome.kind, tested, samples)
    return float(held.mean())


def _holds(kind: str, tested: Tested, samples: Floats) -> Bools:
    """(S,) whether samples (S, n) of the numbers of an outcome of that kind hold, as `statistics` decides."""
    if kind == "equivalent":
        low, high = (_above(side, -tested.bound, ALPHA, tested.exact) for side in (samples, -samples))
        return low & high
    return _above(samples, tested.bound, ALPHA / 2.0, tested.exact)


def _above(samples: Floats, bound: float, level: float, exact: bool) -> Bools:
    """(S,) whether the middle of each sample (n,) is shown to lie above the bound."""
    from scipy import stats  # as in `statistics`

    n = samples.shape[1]
    if exact:
        least = int(stats.binom.isf(level, n, 0.5)) + 1
        found: Bools = (samples > bound).sum(axis=1) >= least
        return found
    mean, error = samples.mean(axis=1), samples.std(axis=1, ddof=1) / math.sqrt(n)
    shown: Bools = mean - bound > stats.t.isf(level, n - 1) * np.maximum(error, 1e-12)
    return shown
