"""The points of a stage run in worker processes, all of their trials in one batch, each kept as it ends."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from flocking.errors import InputError
from flocking.types import Floats
from trials.batch import progress, worker
from trials.batch.batch import Work, run_batch
from trials.batch.folders import NO_FILES, Files
from trials.batch.kinds import kinds
from trials.batch.store import Row, Store
from trials.sensitivity.ledger import Ledger
from trials.sensitivity.model import Model, Part
from trials.sensitivity.quantity import NOTHING
from trials.types import Trial

REFUSED = "refused"
"""Name, before that of a stage, of what is settled of its points whose values do not fit together."""


class StoppedError(Exception):
    """A signal stopped the trials of an analysis, which can go on."""

    def __init__(self, number: int, told: str = "what has ended is kept") -> None:
        super().__init__(told)
        self.number = number
        """Of the signal."""
        self.folder: Path | None = None
        """Of the analysis."""


@dataclass(frozen=True)
class _Kept(Store):
    """Where the batch of a stage keeps its rows: in the ledger, without files."""

    keep: Callable[[Row, Mapping[str, float]], None] = lambda row, timing: None

    def files(self, index: int, record: bool) -> Files:
        return NO_FILES

    def add(self, row: Row, timing: Mapping[str, float]) -> None:
        self.keep(row, timing)


@dataclass
class _Point:
    """A point at work."""

    place: Floats
    parts: list[Part]
    rows: dict[int, Row]

    def left(self) -> list[Trial]:
        """Trials that have not ended."""
        return [trial for part in self.parts for trial in part.trials if trial.index not in self.rows]


def run_points(model: Model, ledger: Ledger, stage: str, design: Mapping[int, Floats], jobs: int) -> None:
    """Runs the points of a stage, by number, that the ledger lacks. A point whose values do not fit together has no
    outputs.

    Raises `StoppedError` where a signal stops it; what ended before is kept.
    """
    ended, work = ledger.points(stage), dict[int, _Point]()
    for number, place in design.items():
        if number in ended:
            continue
        try:
            parts = model.parts(place)
        except InputError as error:
            ledger.settle(f"{REFUSED} {stage} {number}", str(error))
            ledger.add_points(stage, {number: (place, [NOTHING] * len(model.claims))})
            continue
        trials = [trial for part in parts for trial in part.trials]
        work[number] = _Point(place, parts, ledger.rows(stage, number, trials))
        _close(model, ledger, stage, number, work[number])
    _run(model, ledger, stage, work, jobs)


def _run(model: Model, ledger: Ledger, stage: str, work: Mapping[int, _Point], jobs: int) -> None:
    """Runs what is left of these points in one batch."""
    numbers, origin, trials = itertools.count(1), dict[int, tuple[int, int]](), list[Trial]()
    planned = sum(len(part.trials) for point in work.values() for part in point.parts)
    for number, point in work.items():
        for trial in point.left():
            index = next(numbers)
            origin[index] = number, trial.index
            trials.append(dataclasses.replace(trial, index=index))
    if not trials:
        return

    def keep(row: Row, timing: Mapping[str, float]) -> None:
        number, own = origin[row.index]
        mine = dataclasses.replace(row, index=own)
        ledger.add_trial(stage, number, mine, timing.get("seconds", 0.0))
        work[number].rows[own] = mine
        _close(model, ledger, stage, number, work[number])

    with progress.shown(planned, planned - len(trials)) as shown:
        summary = run_batch(
            trials,
            _Kept(ledger.folder, {}, ledger.connection, keep),
            shown,
            jobs=jobs,
            work=Work(imports=worker.imports_of(trials), warm_up=kinds(trials)),
        )
    if summary.stopped:
        ended = planned - len(trials) + len(summary.rows)
        raise StoppedError(summary.stopped, f"{ended} of {planned} trials of this stage are kept")


def _close(model: Model, ledger: Ledger, stage: str, number: int, point: _Point) -> None:
    """Judges a point whose last trial has ended, and keeps it."""
    if not point.left():
        ledger.add_points(stage, {number: (point.place, model.outputs(point.parts, point.rows))})


def refused(ledger: Ledger) -> list[str]:
    """Why points were not run, a line each."""
    return ledger.settled_below(f"{REFUSED} ")
