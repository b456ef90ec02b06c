"""The number of a claim: positive exactly where its estimate holds."""

from __future__ import annotations

import math

import numpy as np
import pytest

from trials.evidence.claims import Entry
from trials.evidence.outcomes import Outcome, above, more, near, ratio, same
from trials.evidence.statistics import Decision
from trials.sensitivity.quantity import lacking, output, slack

RNG = np.random.default_rng(4)
AROUND = RNG.normal(0.0, 0.05, 40)


def entry(*outcomes: Outcome, test: str = "", words: tuple[str, ...] = ()) -> Entry:
    nan = math.nan
    return Entry("s", "q", "c", "p", nan, nan, nan, 0, None, test, nan, outcomes=outcomes, words=words)


@pytest.mark.parametrize(
    ("outcome", "wanted"),
    [
        (more("x", AROUND - AROUND.mean() + 0.3, 0.1), 2.0),
        (more("x", AROUND - AROUND.mean() - 0.1, 0.1), -2.0),
        (same("x", AROUND - AROUND.mean() - 0.05, 0.1), 0.5),
        (same("x", AROUND - AROUND.mean() + 0.4, 0.1), -3.0),
        (near("x", AROUND - AROUND.mean() + 3.23, 3.0, 0.15), 1.0 - 0.23 / 0.15),
        (above("x", AROUND - AROUND.mean() + 0.7, 0.5, 0.1), 2.0),
        (ratio("x", AROUND - AROUND.mean() + math.log(1.21), 1.1), 1.0),
    ],
)
def test_the_slack_is_the_distance_to_the_bound_in_margins(outcome: Outcome, wanted: float) -> None:
    assert slack(outcome) == pytest.approx(wanted)
    if outcome.decision.agrees is not None:
        assert (slack(outcome) > 0.0) == outcome.decision.agrees


def test_a_claim_has_the_least_slack_of_the_outcomes_that_decide() -> None:
    outcomes = (
        more("x", AROUND - AROUND.mean() + 0.3, 0.1),
        same("y", AROUND - AROUND.mean() + 0.05, 0.1),
        same("z", AROUND - AROUND.mean() + 9.0, 0.1, decides=False),
    )
    assert output(entry(*outcomes)).slack == pytest.approx(0.5)
    assert lacking(entry(*outcomes)) == ""


def test_a_claim_without_such_a_number_says_why() -> None:
    nan = math.nan
    share = Outcome("x", Decision(True, 0.0, 1.0, 0.9, 0.8, 1.0, 9, nan), "share", nan, nan, True)
    assert lacking(entry(share)) == lacking(entry()) == "it counts verdicts, and has no estimate of its own"
    assert lacking(entry(test="undecided: no links")) == "no links"
    assert lacking(entry(words=("run", "another"))) == "it needs trials of another"
    assert math.isnan(output(entry()).slack)
    assert math.isnan(output(entry(same("x", np.full(5, nan), 0.1))).slack)
