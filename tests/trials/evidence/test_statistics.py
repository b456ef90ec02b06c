"""The tests behind the verdicts: against SciPy's, against their nominal levels, at their limits."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from flocking.types import Floats
from trials.evidence.statistics import (
    ALPHA,
    Decision,
    all_hold,
    equivalent,
    exceeds,
    hedges_g,
    holm,
    mean_interval,
    near_a_bound,
    slopes,
    some_hold,
)


def _decision(p_holds: float, p_fails: float) -> Decision:
    agrees = False if p_fails < ALPHA else True if p_holds < ALPHA else None
    return Decision(agrees, p_holds, p_fails, 0.0, 0.0, 0.0, 7, 0.0)


HOLDS, FAILS, OPEN = _decision(0.001, 0.999), _decision(0.999, 0.001), _decision(0.4, 0.6)


def test_interval_and_p_value_equal_scipys() -> None:
    values = np.random.default_rng(1).normal(0.4, 1.0, 9)
    decision = exceeds(values)
    test = stats.ttest_1samp(values, 0.0)
    assert decision.p_holds == pytest.approx(test.pvalue, rel=1e-9)
    assert (decision.low, decision.high) == pytest.approx(tuple(test.confidence_interval(0.95)), rel=1e-9)
    tost = max(
        stats.ttest_1samp(values, -0.5, alternative="greater").pvalue,
        stats.ttest_1samp(values, 0.5, alternative="less").pvalue,
    )
    assert equivalent(values, 0.5).p_holds == pytest.approx(tost, rel=1e-9)


@pytest.mark.parametrize("shift", np.linspace(-2.0, 2.0, 41))
def test_verdicts_are_what_the_intervals_say(shift: float) -> None:
    values = np.random.default_rng(2).normal(0.0, 0.3, 7) + shift
    above, same = exceeds(values, margin=0.2), equivalent(values, 0.5)
    _, low, high = mean_interval(values, 0.95)
    assert above.agrees is (False if above.high < 0.2 else True if above.low > 0.2 else None)
    assert (above.low, above.high) == pytest.approx((low, high))
    expected = False if low > 0.5 or high < -0.5 else True if same.low > -0.5 and same.high < 0.5 else None
    assert same.agrees is expected


def test_a_mirror_image_is_as_equivalent() -> None:
    values = np.random.default_rng(3).normal(0.1, 0.3, 7)
    plain, mirrored = equivalent(values, 0.5), equivalent(-values, 0.5)
    assert plain.p_holds == pytest.approx(mirrored.p_holds)
    assert plain.p_fails == pytest.approx(mirrored.p_fails)


def _rate(shift: float, decide: str) -> float:
    """How often the verdict is the wrong one at the edge of what is true; 4000 samples of 7."""
    rng = np.random.default_rng(4)
    wrong = 0
    for values in rng.normal(shift, 0.3, (4000, 7)):
        wrong += (exceeds(values).agrees is True) if decide == "exceeds" else (equivalent(values, 0.5).agrees is True)
    return wrong / 4000


def test_error_rates_are_nominal() -> None:
    """At the edge of the hypothesis, a true verdict comes with the nominal rate: 2.5 % (one side of the 95 %
    interval) and 5 % (TOST). Bound: four standard errors of a proportion of 4000."""
    for shift, decide, nominal in ((0.0, "exceeds", 0.025), (0.5, "equivalent", 0.05)):
        error = math.sqrt(nominal * (1 - nominal) / 4000)
        assert _rate(shift, decide) == pytest.approx(nominal, abs=4 * error)


def test_an_excess_too_small_to_count_does_not_hold() -> None:
    values = 0.05 + 0.001 * np.array([-1.0, 0.0, 1.0, 0.5, -0.5])
    assert exceeds(values).agrees is True
    assert exceeds(values, margin=0.1).agrees is False


def test_an_excess_that_counts_must_be_shown_to_exceed_the_margin() -> None:
    values = 0.15 + 0.04 * np.array([-1.0, 0.0, 1.0, 0.5, -0.5])
    assert exceeds(values, margin=0.05).agrees is True
    assert exceeds(values, margin=0.12).agrees is None  # above 0, but perhaps too small to count
    assert exceeds(values, margin=0.25).agrees is False


def test_few_or_no_repeats_decide_nothing() -> None:
    for values in ([], [1.0], [1.0, 1.0], [1.0, math.nan, 1.0]):
        assert exceeds(np.array(values)).agrees is None
        assert equivalent(np.array(values), 0.1).agrees is None
        assert exceeds(np.array(values), exact=True).agrees is None
        assert equivalent(np.array(values), 0.1, exact=True).agrees is None


def mostly_at_the_bound(rng: np.random.Generator, samples: int, n: int) -> Floats:
    """(samples, n) shares of repeats that differ as much as a beta distribution of mean 0.95 and standard deviation 0.1
    has it: most near 1, a few far off."""
    strength = 0.95 * 0.05 / 0.1**2 - 1.0
    return rng.beta(0.95 * strength, 0.05 * strength, (samples, n))


def test_shares_near_a_bound_deceive_t_and_not_the_sign_test() -> None:
    """Each is asked whether shares lie above its own middle, mean or median, which they do not. 2.5 % may say that they
    do; bound: four standard errors of a proportion of 400."""
    shares = mostly_at_the_bound(np.random.default_rng(6), 400, 7)
    median = float(np.median(mostly_at_the_bound(np.random.default_rng(7), 200_000, 1)))
    by_t = np.mean([exceeds(sample, 0.95).agrees is True for sample in shares])
    exact = np.mean([exceeds(sample, median, exact=True).agrees is True for sample in shares])
    nominal, error = 0.025, math.sqrt(0.025 * 0.975 / 400)
    assert by_t > 3.0 * nominal
    assert exact < nominal + 4.0 * error
    assert exact == pytest.approx(0.5**7, abs=4.0 * math.sqrt(0.5**7 / 400))  # all seven above


def test_the_sign_test_equals_scipys_binomial_test() -> None:
    values = np.random.default_rng(8).normal(0.4, 1.0, 12)
    decision = exceeds(values, exact=True)
    above = stats.binomtest(int((values > 0.0).sum()), 12, 0.5, alternative="greater")
    assert decision.p_holds == pytest.approx(min(1.0, 2.0 * above.pvalue), rel=1e-9)
    assert decision.measured == np.median(values)
    # the third smallest and the third largest of twelve: 1 - 2 P(X <= 2) = 0.961, X binomial (12, 1/2)
    assert (decision.low, decision.high) == tuple(np.sort(values)[[2, -3]])


@pytest.mark.parametrize("n", [7, 12])
def test_exact_verdicts_need_repeats_enough(n: int) -> None:
    """Of seven repeats all must lie on one side; of twelve (2 P(X <= 1) = 0.006) one may be missing."""
    values = np.full(n, 0.05)
    assert equivalent(values, 0.1, exact=True).agrees is True
    assert exceeds(values, 0.0, 0.02, exact=True).agrees is True
    assert exceeds(values, 0.0, 0.1, exact=True).agrees is False
    values[0] = -0.5
    assert (exceeds(values, exact=True).agrees is True) == (n == 12)
    assert (equivalent(values, 0.1, exact=True).agrees is True) == (n == 12)
    assert exceeds(values[:4], 0.1, exact=True).agrees is None  # of four nothing can be shown: 2 / 2^4 = 0.125


def test_what_is_near_a_bound() -> None:
    assert near_a_bound(np.array([0.99, 0.9, math.nan]))
    assert near_a_bound(np.array([0.0, 0.1]))
    assert not near_a_bound(np.array([0.5, 0.95]))
    assert not near_a_bound(np.array([0.05]), (-math.inf, math.inf))
    assert not near_a_bound(np.array([math.nan]))


def test_repeats_that_are_all_alike() -> None:
    assert equivalent(np.zeros(7), 0.1).agrees is True
    assert exceeds(np.full(7, 0.3)).agrees is True
    assert exceeds(np.zeros(7)).agrees is None  # neither above nor shown to be below
    assert exceeds(np.zeros(7), margin=0.1).agrees is False
    assert math.isnan(exceeds(np.zeros(7)).effect)


def test_holm_of_a_worked_example() -> None:
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.9, 0.8]) == [1.0, 1.0]


def test_all_hold() -> None:
    assert all_hold([HOLDS, HOLDS]) is True
    assert all_hold([HOLDS, OPEN]) is None
    assert all_hold([HOLDS, FAILS, OPEN]) is False
    assert all_hold([_decision(0.9, 0.04), OPEN]) is None  # 0.04 of two is no proof


def test_some_hold() -> None:
    assert some_hold([[FAILS], [HOLDS, HOLDS]]) is True
    assert some_hold([[FAILS], [HOLDS, OPEN]]) is None
    assert some_hold([[FAILS], [HOLDS, FAILS]]) is False
    assert some_hold([[_decision(0.04, 0.9)], [OPEN]]) is None  # 0.04 of two is no proof


def test_slopes_of_lines() -> None:
    x = np.array([0.0, 0.5, 2.0])
    assert slopes(x, np.outer([1.0, -2.0], x) + np.array([[3.0], [1.0]])) == pytest.approx([1.0, -2.0])


def test_hedges_g_nears_the_standardised_mean() -> None:
    values = np.random.default_rng(5).normal(1.0, 2.0, 20000)
    # standard error of a standardised mean of n: about 1/sqrt(n) = 0.007; four of them
    assert hedges_g(values) == pytest.approx(0.5, abs=0.028)
    assert hedges_g(values, threshold=1.0) == pytest.approx(0.0, abs=0.028)
