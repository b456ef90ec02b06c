"""A run until decided: which trials come next, when claims are decided, and that interruption changes nothing."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from flocking.types import Floats
from tests.trials.made_up_run import MadeUpRow, MadeUpRun
from trials.evidence.claims import Entry, Question, all_must_hold, answers
from trials.evidence.looks import among, planned_looks
from trials.evidence.outcomes import Outcome, above, same
from trials.evidence.runs import Cells, Run, UndecidedError
from trials.evidence.statistics import exceeds
from trials.evidence.until_decided import Course, changed, course, laid_down
from trials.simulations.kinematic import fields
from trials.types import Trial

KEY = "herd.law.keep_m"
LOOKS = planned_looks(4, 20)
CELLS = ("plain", "strong", "weak")
MARGIN = 1.2


def trials() -> list[Trial]:
    """Three cells of twenty repeats."""
    found = []
    for repeat in range(1, LOOKS[-1] + 1):
        for cell in CELLS:
            base = fields.trial("made-up", repeat, [fields.group("snn", 3)])
            found.append(dataclasses.replace(base, index=len(found) + 1, conditions={KEY: cell}))
    return found


def measured(trial: Trial, effects: dict[str, float]) -> MadeUpRow:
    """What a trial measures depends on its cell and repeat alone."""
    noise = np.random.default_rng((trial.repeat, CELLS.index(str(trial.conditions[KEY])))).normal()
    value = effects.get(str(trial.conditions[KEY]), 0.0) + 0.7 * float(noise)
    return MadeUpRow(trial.index, "done", "", trial.repeat, dict(trial.conditions), {"order": value})


def _difference(cells: Cells, cell: str) -> Floats:
    return cells.difference("order", (cell,), ("plain",))


def claims(run: Run) -> list[Entry]:
    """The strong cell is above the plain one; the weak one is the same as it; a third claim needs another run."""

    def questions(cells: Cells) -> list[Question]:
        def stronger() -> list[Outcome]:
            return [above("d", _difference(cells, "strong"), 0.0, MARGIN)]

        def alike() -> list[Outcome]:
            return [same("d", _difference(cells, "weak"), MARGIN)]

        def unanswerable() -> list[Outcome]:
            raise UndecidedError("needs trials of another experiment", ("run", "other"))

        return [
            Question("made up", "strong", "more", all_must_hold("t", stronger)),
            Question("made up", "weak", "same", all_must_hold("t", alike)),
            Question("made up", "other", "?", all_must_hold("t", unanswerable)),  # type: ignore[arg-type]
        ]

    return answers(run, (KEY,), questions)


def run_to_the_end(effects: dict[str, float], at_once: int = 10**9) -> tuple[Course, list[int]]:
    """Runs what is missing, at most so many trials at a time and the last ones first; the course and the trials run."""
    all_trials, rows = trials(), list[MadeUpRow]()
    while True:
        state = course(MadeUpRun(all_trials, rows), claims, LOOKS)
        if not state.missing:
            return state, sorted(row.index for row in rows)
        for trial in state.missing[-at_once:]:
            rows.append(measured(trial, effects))


def test_a_clear_claim_is_decided_at_the_first_look_and_its_cells_stop() -> None:
    state, ran = run_to_the_end({"strong": 4.0, "weak": 0.2})
    strong, weak, other = state.entries
    assert strong.agrees is True
    assert strong.n == LOOKS[0]
    assert len(strong.looks) == 1
    by_cell = {cell: [t.repeat for t in trials() if t.index in ran and t.conditions[KEY] == cell] for cell in CELLS}
    assert by_cell["strong"] == list(range(1, LOOKS[0] + 1))
    assert by_cell["weak"] == by_cell["plain"] == list(range(1, weak.n + 1))  # the pairs of a claim stay together
    assert weak.n == weak.looks[-1].n > LOOKS[0]
    assert [look.n for look in weak.looks] == list(LOOKS[: len(weak.looks)])
    assert (other.agrees, other.looks, other.words) == (None, (), ("run", "other"))
    assert not state.open()


def test_the_verdict_is_that_of_the_first_look_that_has_one() -> None:
    """By hand: the test of the planned looks, on growing samples."""
    effects = {"strong": 0.5, "weak": 0.0}
    state, _ = run_to_the_end(effects)
    values = {
        cell: np.array([measured(t, effects).measures["order"] for t in trials() if t.conditions[KEY] == cell])
        for cell in CELLS
    }
    with among(LOOKS):
        decisions = [exceeds((values["strong"] - values["plain"])[:n]) for n in LOOKS]
    first = next((k for k, decision in enumerate(decisions) if decision.agrees is not None), len(LOOKS) - 1)
    entry = state.entries[0]
    assert (entry.agrees, entry.n) == (decisions[first].agrees, LOOKS[first])
    assert [look.measured for look in entry.looks] == pytest.approx([each.measured for each in decisions[: first + 1]])
    assert [look.low for look in entry.looks] == pytest.approx([each.low for each in decisions[: first + 1]])


@pytest.mark.parametrize("at_once", [1, 5, 7])
def test_the_order_of_trials_and_interruptions_change_nothing(at_once: int) -> None:
    effects = {"strong": 0.9, "weak": 0.1}
    (whole, all_of_it), (pieces, also) = run_to_the_end(effects), run_to_the_end(effects, at_once)
    assert all_of_it == also
    assert [entry.as_json() for entry in whole.entries] == [entry.as_json() for entry in pieces.entries]


def test_what_was_known_before_is_not_judged_again() -> None:
    effects, all_trials, rows = {"strong": 0.9, "weak": 0.1}, trials(), list[MadeUpRow]()
    state: Course | None = None
    calls = []

    def counted(run: Run) -> list[Entry]:
        calls.append(max(trial.repeat for trial in run.trials))
        return claims(run)

    while state is None or state.missing:
        state = course(MadeUpRun(all_trials, rows), counted, LOOKS, state)
        rows += [measured(trial, effects) for trial in state.missing]
    assert [entry.as_json() for entry in state.entries] == [e.as_json() for e in run_to_the_end(effects)[0].entries]
    assert calls == sorted(calls)
    assert set(calls) == set(LOOKS[: state.taken])


def test_a_claim_that_stays_open_ends_with_the_budget() -> None:
    state, ran = run_to_the_end({"strong": 4.0, "weak": MARGIN})
    weak = state.entries[1]
    assert weak.agrees is None
    assert weak.n == LOOKS[-1]
    assert state.open() == [weak]
    assert state.missing == ()
    assert len(ran) == LOOKS[0] + 2 * LOOKS[-1]


def test_failed_trials_are_left_out_and_the_run_goes_on() -> None:
    all_trials, rows = trials(), list[MadeUpRow]()
    while (state := course(MadeUpRun(all_trials, rows), claims, LOOKS)).missing:
        for trial in state.missing:
            row = measured(trial, {"strong": 15.0, "weak": 0.0})
            rows.append(dataclasses.replace(row, status="failed", measures={}) if trial.repeat == 2 else row)
    assert state.entries[0].agrees is True
    assert state.entries[0].n == LOOKS[0] - 1


def test_the_plan_holds_each_outcome_with_its_margin_before_any_trial() -> None:
    plan = laid_down(MadeUpRun(trials(), []), claims, LOOKS, "20")
    assert plan["looks"] == list(LOOKS)
    assert plan["levels"]["two-sided"] < 0.05 == plan["levels"]["of the whole"]
    strong, weak, other = plan["claims"]
    assert weak["outcomes"] == [{"label": "d", "kind": "equivalent", "threshold": 0.0, "margin": MARGIN}]
    assert strong["outcomes"][0]["kind"] == "exceeds"
    assert other["outcomes"] == []
    entries = run_to_the_end({})[0].entries
    assert changed(plan, entries) == []
    weak["outcomes"][0]["margin"] = 2 * MARGIN
    (line,) = changed(plan, entries)
    assert "weak" in line
    assert "margin" in line


def test_a_run_without_rows_wants_all_cells_of_the_first_look() -> None:
    state = course(MadeUpRun(trials(), []), claims, LOOKS)
    assert [trial.repeat for trial in state.missing] == [r for r in range(1, LOOKS[0] + 1) for _ in CELLS]
    assert state.entries == ()


def test_nothing_is_decided_while_most_repeats_could_not_be_measured() -> None:
    """Three trials of a hundred that happen to be alike would prove anything."""
    all_trials, rows = trials(), list[MadeUpRow]()
    while (state := course(MadeUpRun(all_trials, rows), claims, LOOKS)).missing:
        for trial in state.missing:
            row = measured(trial, {"strong": 50.0, "weak": 0.0})
            rows.append(dataclasses.replace(row, measures={}) if trial.repeat > 5 else row)
    strong = state.entries[0]
    assert (strong.agrees, strong.n, strong.looks[0].n) == (True, 4, 4)
    weak = state.entries[1]
    assert [look.n for look in weak.looks] == [4, 5, 5, 5, 5]
    assert weak.agrees is None
