"""The power of a verdict, against closed forms and against samples that are judged one by one."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy import stats

from flocking.types import Floats
from trials.evidence.outcomes import Outcome, above, decided_by_all, more, same
from trials.evidence.power import SAMPLES, power

STANDARD_ERROR = 0.5 / math.sqrt(SAMPLES)
"""Of a share of so many samples, at the most."""


def spread_out(deviation: float, n: int = 30) -> Floats:
    """(n,) numbers of mean 3 with that standard deviation."""
    values = stats.norm.ppf((np.arange(n) + 0.5) / n)
    spread: Floats = 3.0 + deviation * values / values.std(ddof=1)
    return spread


@pytest.mark.parametrize("deviation", [0.05, 0.1, 0.2])
def test_power_of_an_excess_is_that_of_the_t_test(deviation: float) -> None:
    """Supposed: twice the margin of 0.1, so 0.1 beyond the least that counts. The non-central t has its power."""
    shift = 0.1 / (deviation / math.sqrt(7))
    expected = stats.nct.sf(stats.t.isf(0.025, 6), 6, shift)
    assert power([more("x", spread_out(deviation), 0.1)], 7) == pytest.approx(expected, abs=4 * STANDARD_ERROR)


def test_power_of_an_exact_sameness_is_that_of_all_seven_within_the_margin() -> None:
    inside = 2.0 * stats.norm.cdf(0.1 / 0.08) - 1.0
    both = power([same("x", spread_out(0.08), 0.1, exact=True)], 7)
    assert both == pytest.approx(inside**7, abs=4 * STANDARD_ERROR)


@pytest.mark.parametrize(
    "judged",
    [
        lambda values: same("x", values, 0.1),
        lambda values: same("x", values, 0.1, exact=True),
        lambda values: more("x", values, 0.1),
        lambda values: more("x", values, 0.1, exact=True),
        lambda values: above("x", values, 0.5, 0.2),
    ],
)
def test_power_is_how_often_such_samples_are_judged_to_hold(judged: Callable[[Floats], Outcome]) -> None:
    outcome = judged(spread_out(0.07))
    assert outcome.tested is not None
    rng = np.random.default_rng(5)
    held = [judged(outcome.tested.supposed + 0.07 * rng.normal(size=7)).decision.agrees is True for _ in range(200)]
    error = math.hypot(0.5 / math.sqrt(200), STANDARD_ERROR)  # of a difference of two shares
    assert power([outcome], 7) == pytest.approx(np.mean(held), abs=4 * error)


def test_outcomes_of_the_same_repeats_are_drawn_together() -> None:
    one, other = (same("x", values, 0.1) for values in (spread_out(0.12), 3.0 - spread_out(0.12)))
    alone = power([one], 7)
    assert power([one, other], 7) == pytest.approx(alone, abs=1e-12)  # the mirror image of the same repeats
    apart = same("y", np.random.default_rng(0).permutation(spread_out(0.12)), 0.1)
    assert power([one, apart], 7) < alone - 4 * STANDARD_ERROR


def test_repeats_that_are_all_alike_leave_no_doubt() -> None:
    assert power([same("x", np.zeros(5), 0.1)], 7) == 1.0


def test_what_no_power_can_be_told_of() -> None:
    told = same("x", spread_out(0.1), 0.1)
    assert math.isnan(power([same("x", np.zeros(2), 0.1)], 7))
    assert math.isnan(power([told], 2))
    assert math.isnan(power([told._replace(tested=None)], 7))
    assert math.isnan(power([told._replace(decides=False)], 7))
    assert decided_by_all([told])[1] is told
