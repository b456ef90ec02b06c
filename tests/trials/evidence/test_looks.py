"""Repeated looks: their levels against published constants and simulation, and the errors of every kind of claim."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest
from scipy import special, stats

from flocking.errors import InputError
from flocking.types import Floats
from trials.evidence import looks as levels
from trials.evidence import statistics
from trials.evidence.looks import among, nominal, overall, planned_looks
from trials.evidence.statistics import ALPHA, all_hold, equivalent, exceeds, some_hold
from trials.studies.link_tension.estimates import FEWEST_FORETELLING, one_more

LOOKS = planned_looks(7)
BATCHES = 20_000


def too_many(rate: float) -> float:
    """Wrong decisions among `BATCHES` that an error rate may give: two standard errors more."""
    return rate + 2.0 * math.sqrt(rate * (1.0 - rate) / BATCHES)


def test_levels_are_those_of_pocock() -> None:
    """Table 2.1 of Jennison and Turnbull 2000: Pocock's constants for looks at equal distances, two-sided, 5 % in all.

    They are of normal numbers: looks are at thousands of repeats here. Of 400,000 walks 10,000 cross: three standard
    errors of that are a constant's 0.012.
    """
    for number, constant in {2: 2.178, 3: 2.289, 4: 2.361, 5: 2.413, 8: 2.512}.items():
        with among(range(5000, 5000 * number + 1, 5000)):
            assert stats.norm.isf(nominal(0.025)) == pytest.approx(constant, abs=0.012)


def test_the_chance_is_that_of_t_tests_on_growing_samples() -> None:
    """Against 40,000 samples made number by number, tested by t at unequal distances; four standard errors."""
    looks, samples = (3, 5, 20, 21), 40_000
    numbers = np.random.default_rng(2).normal(size=(samples, looks[-1]))
    p = np.stack([stats.ttest_1samp(numbers[:, :n], 0.0, axis=1, alternative="greater").pvalue for n in looks])
    for level in (0.5, 0.1, 0.02, 0.005):
        with among(looks):
            found = float(overall(level))
        error = math.sqrt(found * (1.0 - found) / samples)
        assert (p.min(axis=0) <= level).mean() == pytest.approx(found, abs=4.0 * error)


def test_a_p_value_of_one_look_becomes_one_of_all_and_back() -> None:
    with among(LOOKS):
        for level in (0.2, 0.05, 0.025, 0.001, 1e-6):
            assert overall(nominal(level)) == pytest.approx(level, rel=1e-9)  # read off the same line both ways
        p = np.array([0.0, *np.geomspace(1e-20, 1.0, 200)])
        assert (np.diff(overall(p)) >= 0.0).all()
        assert ((overall(p) >= p) & (overall(p) <= 1.0)).all()
        assert overall(p)[[0, -1]].tolist() == [0.0, 1.0]
    assert overall(0.03) == nominal(0.03) == 0.03  # no plan, or one look: as it is
    with among((12,)):
        assert overall(0.03) == nominal(0.03) == 0.03


def test_the_plan_of_looks() -> None:
    assert planned_looks(7) == (7, 14, 21, 28, 35, 42, 49, 56)
    assert planned_looks(7, 20) == (7, 14, 20)
    assert planned_looks(7, 3) == (3,)
    with pytest.raises(InputError, match="decides nothing"):
        planned_looks(7, 2)
    with pytest.raises(InputError, match="a budget of 1 repeat decides nothing"):
        planned_looks(7, 1)
    assert planned_looks(1, 20) == (3, 6, 9, 12, 15, 18, 20)
    for block in range(1, 12):
        for most in range(3, 120):
            looks = planned_looks(block, most)
            assert len(looks) <= levels.MOST
            assert looks[-1] == most
            assert list(looks) == sorted(set(looks))


Judge = Callable[[Floats], bool | None]
"""(n, K) numbers of n repeats → verdict."""
Rule = Callable[[Floats, Floats], tuple[Floats, Floats]]
"""(…, K) p-values of one look that the numbers lie above their bound, or below it → p-values (…) that the claim holds,
and that it does not. It is what a judge does, for all batches at once."""


def p_values(numbers: Floats, bound: float, exact: bool) -> tuple[Floats, Floats]:
    """One-sided p-values (batches, looks, K) that `numbers` (batches, repeats, K) lie above the bound, or below."""
    sides = []
    for sign in (1.0, -1.0):
        shifted, found = sign * (numbers - bound), []
        for n in LOOKS:
            some = shifted[:, :n]
            if exact:
                found.append(special.bdtrc((some > 0.0).sum(axis=1) - 1, n, 0.5))
            else:
                found.append(special.stdtr(n - 1, -some.mean(axis=1) / (some.std(axis=1, ddof=1) / math.sqrt(n))))
        sides.append(overall(np.stack(found, axis=1)))
    return sides[0], sides[1]


def first_verdicts(p_holds: Floats, p_fails: Floats) -> tuple[Floats, Floats]:
    """(batches,) whether each is found to hold, and not to hold, at the first of its looks that shows either."""
    fails, holds = p_fails < ALPHA, (p_holds < ALPHA) & (p_fails >= ALPHA)
    first = np.argmax(fails | holds, axis=1)
    rows = np.arange(len(first))
    return holds[rows, first], fails[rows, first]


def holm_least(p: Floats) -> Floats:
    """(…) the least p-value of several (…, K), corrected."""
    return np.minimum(1.0, p.shape[-1] * p.min(axis=-1))


def one(above: Floats, below: Floats) -> tuple[Floats, Floats]:
    return 2.0 * above[..., 0], 2.0 * below[..., 0]


def every(above: Floats, below: Floats) -> tuple[Floats, Floats]:
    return 2.0 * above.max(axis=-1), holm_least(2.0 * below)


def some(above: Floats, below: Floats) -> tuple[Floats, Floats]:
    return holm_least(2.0 * above), 2.0 * below.max(axis=-1)


def normal(means: tuple[float, ...], seed: int) -> Floats:
    """(BATCHES, most repeats, K) of standard deviation 1."""
    return np.random.default_rng(seed).normal(means, 1.0, size=(BATCHES, LOOKS[-1], len(means)))


def shares(seed: int) -> Floats:
    """(BATCHES, most repeats, 1) shares near 1, beta distributed, whose median is 0.95."""
    a, b = 12.0, 0.9
    scale = 0.95 / stats.beta.median(a, b)
    return np.random.default_rng(seed).beta(a, b, size=(BATCHES, LOOKS[-1], 1)) * scale


class Kind(NamedTuple):
    """A kind of claim, at the very bound between true and false."""

    draw: Callable[[int], Floats]
    judge: Judge
    rule: Rule
    wrong: tuple[bool, bool]
    """Whether it would be wrong to say that it holds, and that it does not."""
    bound: float = 0.0
    exact: bool = False


KINDS = {
    "a difference": Kind(
        lambda s: normal((0.5,), s), lambda x: exceeds(x[:, 0], 0.0, 0.5).agrees, one, (True, True), 0.5
    ),
    "three outcomes, all true": Kind(
        lambda s: normal((0.0,) * 3, s), lambda x: all_hold([exceeds(column) for column in x.T]), every, (False, True)
    ),
    "two outcomes, one of them false": Kind(
        lambda s: normal((0.0, 1.5), s), lambda x: all_hold([exceeds(column) for column in x.T]), every, (True, False)
    ),
    "some of three (Holm), none of them true": Kind(
        lambda s: normal((0.0,) * 3, s), lambda x: some_hold([[exceeds(column)] for column in x.T]), some, (True, False)
    ),
    "a share near 1": Kind(shares, lambda x: exceeds(x[:, 0], 0.95, exact=True).agrees, one, (True, True), 0.95, True),
}


@pytest.mark.parametrize("name", KINDS)
def test_wrong_decisions_are_at_most_five_in_a_hundred(name: str) -> None:
    kind = KINDS[name]
    numbers = kind.draw(17)
    with among(LOOKS):
        holds, fails = first_verdicts(*kind.rule(*p_values(numbers, kind.bound, kind.exact)))
        for k in range(120):  # the rule for all batches at once is what the judge does
            verdicts = (kind.judge(numbers[k, :n]) for n in LOOKS)
            first = next((verdict for verdict in verdicts if verdict is not None), None)
            assert first is (True if holds[k] else False if fails[k] else None)
    wrong = (holds & kind.wrong[0] | fails & kind.wrong[1]).mean()
    print(f"{name}: wrong in {100 * wrong:.2f} % of {BATCHES} batches at {len(LOOKS)} looks")
    assert wrong <= too_many(ALPHA)


@pytest.mark.parametrize(("says", "most"), [("holds", too_many(ALPHA)), ("does not hold", too_many(ALPHA / 2.0))])
def test_sameness_at_its_margin(says: str, most: float) -> None:
    """Whether the difference lies at the margin from without or from within: no more than 5 %, and 2.5 %."""
    margin = 0.8
    numbers = normal((margin,), 23)
    with among(LOOKS):
        inside, beyond = p_values(-numbers, -margin, False)  # that it lies below the margin, and above it
        holds, fails = first_verdicts(inside[..., 0], 2.0 * beyond[..., 0])
        for k in range(120):
            verdicts = (equivalent(numbers[k, :n, 0], margin).agrees for n in LOOKS)
            first = next((verdict for verdict in verdicts if verdict is not None), None)
            assert first is (True if holds[k] else False if fails[k] else None)
    wrong = (holds if says == "holds" else fails).mean()
    print(f"sameness at its margin: {says} in {100 * wrong:.2f} % of {BATCHES} batches")
    assert wrong <= most


def test_a_published_number_that_is_one_more_of_ours() -> None:
    numbers = normal((0.0,), 31)[..., 0]
    told = np.random.default_rng(32).normal(size=BATCHES)
    refuted = np.zeros(BATCHES, dtype=bool)
    with among(LOOKS):
        for n in [n for n in LOOKS if n >= FEWEST_FORETELLING]:
            some = numbers[:, :n]
            reach = special.stdtrit(n - 1, 1.0 - nominal(ALPHA / 2.0)) * some.std(axis=1, ddof=1) * math.sqrt(1 + 1 / n)
            outside = np.abs(told - some.mean(axis=1)) > reach
            assert [one_more(some[k], told[k]).agrees is False for k in range(40)] == outside[:40].tolist()
            refuted |= outside
    print(f"a published number: wrongly refuted in {100 * refuted.mean():.2f} % of {BATCHES} batches")
    assert refuted.mean() <= too_many(ALPHA)


def test_looking_without_a_plan_errs_too_often() -> None:
    """The same numbers, each look tested as if it were the only one: some 18 %."""
    kind = KINDS["a difference"]
    holds, fails = first_verdicts(*kind.rule(*p_values(kind.draw(17), kind.bound, kind.exact)))
    assert (holds | fails).mean() > 0.15


def test_the_power_against_one_test_of_fixed_n() -> None:
    """An effect of 0.8 standard deviations: 56 repeats decide all, most are decided by fewer; seven decide few."""
    numbers = normal((0.8,), 41)
    above, _ = p_values(numbers, 0.0, False)
    fixed = (2.0 * above[:, 0, 0] < ALPHA).mean()
    with among(LOOKS):
        above, _ = p_values(numbers, 0.0, False)
    shown = 2.0 * above[..., 0] < ALPHA
    power, needed = shown.any(axis=1).mean(), np.array(LOOKS)[np.argmax(shown, axis=1)]
    print(
        f"effect 0.8: shown by {LOOKS[0]} repeats in {100 * fixed:.0f} %, until decided in {100 * power:.2f} %; "
        f"repeats needed: median {np.median(needed):g}, mean {needed.mean():.1f}"
    )
    assert fixed < 0.5 < 0.99 < power
    assert np.median(needed) <= 21


def test_intervals_hold_at_all_looks_together() -> None:
    """The 95 % interval of a mean covers it at every look in 95 % of batches (three standard errors)."""
    numbers = np.random.default_rng(9).normal(size=(1000, LOOKS[-1]))
    covered = 0
    with among(LOOKS):
        for batch in numbers:
            decisions = [exceeds(batch[:n]) for n in LOOKS]
            covered += all(each.low <= 0.0 <= each.high for each in decisions)
    assert covered / len(numbers) >= 0.95 - 3.0 * math.sqrt(0.95 * 0.05 / len(numbers))


def test_without_a_plan_nothing_has_changed() -> None:
    values = np.array([0.2, 0.5, 0.1, 0.7, 0.4])
    decision = exceeds(values)
    assert decision.p_holds == pytest.approx(stats.ttest_1samp(values, 0.0).pvalue)
    assert (decision.low, decision.high) == pytest.approx(statistics.mean_interval(values)[1:])
