"""A run until decided: repeats are added in blocks until each claim is decided, and no longer than that.

At each planned look the claims that are still open are tested on as many repeats of all their cells; the first look
that decides a claim has the last word on it. What is run next follows from the rows that there are and from the plan
alone, so that a run that was killed and resumed, or was shared among any number of workers, comes to the same verdicts.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from trials.evidence import looks as levels
from trials.evidence.claims import CellName, Entry, Look
from trials.evidence.runs import FinishedTrial, Part, Run
from trials.evidence.statistics import ALPHA
from trials.types import Trial

Claims = Callable[[Run], list[Entry]]
"""A study's own: the entries of a run, the same claims in the same order whatever was measured."""
MEDIAN = " (median)"
"""What a label ends in where the numbers turn out to need an exact test."""


@dataclass(frozen=True)
class Course:
    """How far a run until decided has come."""

    looks: tuple[int, ...]
    """Repeats at each planned look."""
    taken: int = 0
    """Looks that were taken."""
    entries: tuple[Entry, ...] = ()
    """Each claim at the look that decided it, or else at the last that was taken."""
    missing: tuple[Trial, ...] = ()
    """Trials to run before the next look; none where the run is over."""

    def open(self) -> list[Entry]:
        """The claims that more repeats might decide."""
        return [entry for entry in self.entries if _is_open(entry)]


def course(run: Run, claims: Claims, looks: Sequence[int], before: Course | None = None) -> Course:
    """The course of a run with the rows that it has; `before`: what it was with fewer rows."""
    state = before or Course(tuple(looks))
    rows = {row.index: row for row in run.rows()}
    while state.taken < len(state.looks) and (state.open() or not state.taken):
        repeats, open_cells = state.looks[state.taken], _cells(state.open())
        wanted = [trial for trial in run.trials if not state.taken or _cell(trial) in open_cells]
        entries: list[Entry] = []
        missing = _missing(wanted, repeats, rows)
        if not missing:
            trials = [trial for trial in run.trials if trial.repeat <= repeats]
            part = Part(run, trials, [rows[trial.index] for trial in trials if trial.index in rows])
            entries = _entries_at(part, claims, state)
            asked = _cells([entry for entry in entries if _is_open(entry)])  # a claim may ask for more than it did
            missing = _missing([trial for trial in run.trials if _cell(trial) in asked], repeats, rows)
        if missing:
            return dataclasses.replace(state, missing=missing)
        state = dataclasses.replace(state, taken=state.taken + 1, entries=tuple(entries))
    return dataclasses.replace(state, missing=())


def laid_down(run: Run, claims: Claims, looks: Sequence[int], budget: str) -> dict[str, Any]:
    """The plan of a run before its first trial, as JSON: looks, levels, budget, and each claim's outcomes with margins.

    The outcomes are those of trials that measured nothing; `by repeats`: whether more repeats can decide a claim.
    """
    trials = [trial for trial in run.trials if trial.repeat <= looks[0]]
    return {
        "looks": list(looks),
        "levels": levels_of(looks),
        "budget": budget,
        "claims": [
            {
                "claim": f"{entry.source}; {entry.quantity.partition(':')[0]}",
                "arm": dict(entry.arm),
                "by repeats": bool(_of(trials[0].experiment, entry)),
                "outcomes": [
                    {"label": each.label, "kind": each.kind, "threshold": _plain(each.threshold), "margin": each.margin}
                    for each in entry.outcomes
                    if each.decides and math.isfinite(each.margin)
                ],
            }
            for entry in claims(Part(run, trials, [Unmeasured(trial.index, trial.repeat) for trial in trials]))
        ],
    }


def levels_of(looks: Sequence[int]) -> dict[str, float]:
    """The level of each look, two-sided and one-sided, and that of the whole."""
    with levels.among(looks):
        return {"two-sided": 2.0 * levels.nominal(ALPHA / 2), "one-sided": levels.nominal(ALPHA), "of the whole": ALPHA}


def changed(plan: Mapping[str, Any], entries: Sequence[Entry]) -> list[str]:
    """The claims that are no longer judged as laid down, in words, a line each."""
    lines = []
    for told, entry in zip(plan["claims"], entries, strict=False):
        name = f"{entry.source}; {entry.quantity.partition(':')[0]}"
        margins = {each["label"]: (each["threshold"], each["margin"]) for each in told["outcomes"]}
        now = {each.label.removesuffix(MEDIAN): (_plain(each.threshold), each.margin) for each in entry.outcomes}
        differ = [label for label in margins.keys() & now.keys() if margins[label] != now[label]]
        if told["claim"] != name:
            lines.append(f"claim {told['claim']!r} was planned, and {name!r} is judged in its place")
        elif differ:
            lines.append(f"{name}: {differ[0]}: its margin or threshold is not the one that was planned")
    return lines


@dataclass(frozen=True)
class Unmeasured:
    """The row of a trial that measured nothing."""

    index: int
    repeat: int
    status: str = "done"
    reason: str = ""
    conditions: Mapping[str, Any] = field(default_factory=dict)
    measures: Mapping[str, float] = field(default_factory=dict)


def _entries_at(part: Part, claims: Claims, state: Course) -> list[Entry]:
    """The claims at a look: open ones tested on the part, decided ones as they were."""
    with levels.among(state.looks):
        tested = claims(part)
    own = part.trials[0].experiment
    if any(not _of(own, entry) for entry in tested):  # on other runs' trials alone: these are not looked at repeatedly
        tested = [entry if _of(own, entry) else once for entry, once in zip(tested, claims(part), strict=True)]
    entries, number = [], state.taken + 1
    for k, entry in enumerate(tested):
        before = state.entries[k] if state.taken else None
        if before is not None and not _is_open(before):
            entries.append(before)
            continue
        entry = dataclasses.replace(entry, cells=_of(own, entry))
        fewest = min([outcome.decision.n for outcome in entry.outcomes if outcome.decides], default=entry.n)
        if entry.agrees is not None and 2 * fewest < state.looks[state.taken]:
            few = f"only {fewest} repeat{'s' * (fewest != 1)} could be measured"
            entry = dataclasses.replace(entry, agrees=None, test=f"{entry.test}; {few}")
        if entry.cells:
            path = (
                *(before.looks if before else ()),
                Look(entry.n, entry.measured, entry.low, entry.high, entry.agrees),
            )
            when = f"look {number} of {len(state.looks)}"
            told = f"decided at {when}" if entry.agrees is not None else f"undecided at {when}"
            entry = dataclasses.replace(entry, looks=path, test=f"{entry.test}; {told}")
        entries.append(entry)
    return entries


def _is_open(entry: Entry) -> bool:
    return entry.agrees is None and bool(entry.cells)


def _of(experiment: str, entry: Entry) -> frozenset[CellName]:
    """The cells that a claim has of the run's own experiment."""
    return frozenset(cell for cell in entry.cells if cell[0] == experiment)


def _cells(entries: Sequence[Entry]) -> frozenset[CellName]:
    return frozenset(cell for entry in entries for cell in entry.cells)


def _cell(trial: Trial) -> CellName:
    return trial.experiment, tuple(trial.conditions.items())


def _missing(trials: Sequence[Trial], repeats: int, rows: Mapping[int, FinishedTrial]) -> tuple[Trial, ...]:
    return tuple(trial for trial in trials if trial.repeat <= repeats and trial.index not in rows)


def _plain(value: float) -> float | None:
    return value if math.isfinite(value) else None
