"""From a question to the entry of a report: its number, its words, what it leaves out, and what it cannot answer."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import pytest

from flocking.errors import InputError
from flocking.types import Floats
from tests.trials.made_up_run import MadeUpRun, made_up_run
from trials.evidence.claims import Question, all_must_hold, answered, answers, claim_of, published
from trials.evidence.outcomes import Outcome, above, more, near, ratio, same
from trials.evidence.runs import Cells, arms

KEYS = ("herd.pipeline", "herd.law.exclusion_m")
CELL = ("member-based", 0.5)
NAN = math.nan


def run_of(exclusions: tuple[float, ...] = (0.0, 0.5), arms: tuple[dict[str, float], ...] = ({},)) -> MadeUpRun:
    return made_up_run(lambda pipeline, exclusion: {"mmd": 1.0 + exclusion}, exclusions=exclusions, arms=arms)


def cells_of(run: MadeUpRun) -> Cells:
    ((_, trials),) = arms(run, KEYS)
    return Cells(trials, run.rows(), KEYS)


def question(cells: Cells, number: float | None = None, of_outcome: float = NAN, decides: bool = True) -> Question:
    """Whether the MMD of a cell lies near 1.5."""

    def outcomes() -> list[Outcome]:
        outcome = near("MMD, m", cells.array("mmd", *CELL), 1.5, 0.1, decides)
        return [outcome._replace(published=of_outcome)]

    return Question("a source", "a quantity", "MMD: 1.5", all_must_hold("a test", outcomes), number)


def test_an_entry_holds_what_was_asked_and_what_was_measured() -> None:
    cells = cells_of(run_of())
    entry = answered(question(cells, number=1.5), [cells], {"herd.count": 3})
    assert (entry.source, entry.quantity, entry.claim) == ("a source", "a quantity: MMD, m", "MMD: 1.5")
    assert entry.measured == pytest.approx(1.5, abs=0.05)
    assert (entry.agrees, entry.n, entry.margin, entry.test) == (True, 7, 0.1, "a test")
    assert entry.as_json()["arm"] == {"herd.count": 3}


@pytest.mark.parametrize(
    ("number", "of_outcome", "expected"), [(None, NAN, "MMD: 1.5"), (1.5, NAN, 1.5), (None, 1.25, 1.25)]
)
def test_what_was_published_is_a_number_where_one_is_held_against_the_measured(
    number: float | None, of_outcome: float, expected: float | str
) -> None:
    cells = cells_of(run_of())
    entry = answered(question(cells, number, of_outcome), [cells], {})
    assert entry.published == expected
    assert entry.as_json()["published"] == expected


def test_a_question_that_cannot_be_answered_keeps_its_number_and_says_why() -> None:
    cells = cells_of(run_of(exclusions=(0.0,)))
    entry = answered(question(cells, number=1.5), [cells], {})
    assert entry.agrees is None
    assert entry.published == 1.5
    assert math.isnan(entry.measured)
    assert entry.as_json()["measured"] is None
    told = "herd.pipeline = member-based, herd.law.exclusion_m = 0.5"
    assert entry.test == f"undecided: the run has no trials with {told}"


def test_outcomes_without_a_say_decide_nothing() -> None:
    cells = cells_of(run_of())
    entry = answered(question(cells, decides=False), [cells], {})
    assert entry.agrees is None
    assert entry.test == "undecided: the run has no trials that decide it"


@pytest.mark.parametrize(
    "outcome",
    [
        lambda values: more("MMD, m", values, 0.0),
        lambda values: same("MMD, m", values, 0.0),
        lambda values: near("MMD, m", values, 1.5, 0.0),
        lambda values: above("MMD, m", values, 1.0, 0.0),
        lambda values: ratio("MMD, m", values, 1.0),
    ],
)
def test_an_outcome_without_a_margin_is_refused_in_one_line(outcome: Callable[[Floats], Outcome]) -> None:
    """None of them could be drawn: the figure of the claims counts in margins. A factor of 1 is none, either."""
    cells = cells_of(run_of())
    judge = all_must_hold("a test", lambda: [outcome(cells.array("mmd", *CELL))])
    told = r"^a source, a quantity: outcome 'MMD, m.*' has margin 0; expected one above 0: .*$"
    with pytest.raises(InputError, match=told) as refused:
        answered(Question("a source", "a quantity", "MMD: 1.5", judge), [cells], {})
    assert "\n" not in str(refused.value)


def test_failed_trials_of_the_cells_that_were_read_are_left_out_and_counted() -> None:
    run = run_of()
    read = next(row for row in run.finished if tuple(row.conditions[key] for key in KEYS) == CELL)
    other = next(row for row in run.finished if tuple(row.conditions[key] for key in KEYS) != CELL)
    run.finished = [dataclasses.replace(r, status="failed") if r in (read, other) else r for r in run.finished]
    cells = cells_of(run)
    assert cells.rows(*CELL)[read.repeat] is None
    entry = answered(question(cells), [cells], {})
    assert entry.n == 6
    assert entry.test == "a test; 1 failed trial left out"


def test_every_arm_is_asked_every_question() -> None:
    run = run_of(arms=({"herd.count": 3}, {"herd.count": 6}))
    entries = answers(run, KEYS, lambda cells: [question(cells), question(cells, number=1.5)])
    assert [(entry.arm["herd.count"], entry.published) for entry in entries] == [
        (3, "MMD: 1.5"),
        (3, 1.5),
        (6, "MMD: 1.5"),
        (6, 1.5),
    ]


def test_a_numbered_claim_brings_its_words_and_its_section() -> None:
    told = published("trials.studies.detection", "fine2015", "detection_case_study")
    judge = all_must_hold("a test", list)
    made = claim_of("trials.studies.detection", "fine2015", "detection_case_study", 3, "a quantity", judge)
    assert made.claim == told["claims"][2]
    assert made.source == f"fine2015 detection_case_study, claim 3 (section {told['sections'][2]})"


def test_cells_are_told_in_the_order_of_their_trials() -> None:
    cells = cells_of(run_of())
    assert cells.planned()[:2] == [("member-based", 0.0), ("member-based", 0.5)]
    assert len(cells.planned()) == 6
