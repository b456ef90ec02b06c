"""A run as claims and figures read it: its finished trials, by arm and by cell of conditions."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from flocking.types import Floats
from trials.types import Trial, TrialResult

CellName = tuple[str, tuple[tuple[str, Any], ...]]
"""A cell of a run: the experiment, and all conditions of its trials."""


class FinishedTrial(Protocol):
    """A row of a run's results (as `trials.batch.store.Row`)."""

    @property
    def index(self) -> int: ...
    @property
    def status(self) -> str: ...
    @property
    def reason(self) -> str: ...
    @property
    def repeat(self) -> int: ...
    @property
    def conditions(self) -> Mapping[str, Any]: ...
    @property
    def measures(self) -> Mapping[str, float]: ...


class Run(Protocol):
    """A run as the claims and figures read it (as `trials.batch.store.Store`)."""

    @property
    def folder(self) -> Path: ...
    @property
    def trials(self) -> list[Trial]:
        """All trials that the run is to have, finished or not."""

    def rows(self) -> Sequence[FinishedTrial]: ...
    def series(self, index: int) -> TrialResult: ...


@dataclass(frozen=True)
class Part:
    """Some trials of a run, as a run."""

    whole: Run
    trials: list[Trial]
    finished: Sequence[FinishedTrial]

    @property
    def folder(self) -> Path:
        """Of the whole run."""
        return self.whole.folder

    def rows(self) -> Sequence[FinishedTrial]:
        """Of these trials."""
        return self.finished

    def series(self, index: int) -> TrialResult:
        """Of one trial."""
        return self.whole.series(index)


class UndecidedError(Exception):
    """A claim cannot be judged on this run; the message says why."""

    def __init__(self, why: str, words: Sequence[str] = ()) -> None:
        """`words`: of the command of `herd` that would make up for it."""
        super().__init__(why)
        self.words = tuple(words)


def arms(run: Run, keys: Sequence[str]) -> list[tuple[dict[str, Any], list[Trial]]]:
    """The arms of a run: for each combination of the conditions other than `keys`, its values and its trials."""
    found: dict[tuple[tuple[str, Any], ...], list[Trial]] = {}
    for trial in run.trials:
        others = tuple((key, value) for key, value in trial.conditions.items() if key not in keys)
        found.setdefault(others, []).append(trial)
    return [(dict(others), trials) for others, trials in found.items()]


class Cells:
    """The finished trials of one arm of a run, by condition, in pairs by repeat.

    Failed trials are left out and counted; a trial that has not run yet makes what needs it `UndecidedError`.
    """

    def __init__(self, trials: Iterable[Trial], rows: Iterable[FinishedTrial], keys: Sequence[str]) -> None:
        """`keys`: the conditions, in the order in which `values` is given theirs."""
        self.keys = tuple(keys)
        self.trials = list(trials)
        finished = {row.index: row for row in rows}
        self._planned: dict[tuple[Any, ...], dict[int, FinishedTrial | None]] = {}
        self._names: dict[tuple[Any, ...], set[CellName]] = {}
        for trial in self.trials:
            cell = tuple(trial.conditions.get(key) for key in self.keys)
            self._planned.setdefault(cell, {})[trial.repeat] = finished.get(trial.index)
            self._names.setdefault(cell, set()).add((trial.experiment, tuple(trial.conditions.items())))
        self.used: set[tuple[Any, ...]] = set()
        """Cells that were asked for since the last `begin`."""

    def begin(self) -> None:
        """Forgets which cells were asked for."""
        self.used.clear()

    def names(self) -> set[CellName]:
        """The cells that were asked for since the last `begin`."""
        return {name for cell in self.used for name in self._names.get(cell, ())}

    def planned(self) -> list[tuple[Any, ...]]:
        """All cells in the order of their first trials, finished or not."""
        return list(self._planned)

    def levels(self, key: str) -> list[Any]:
        """The values of a condition that the run has, in order; `UndecidedError` if it varies no such thing."""
        column = self.keys.index(key)
        found = {cell[column] for cell in self._planned} - {None}
        if not found:
            raise UndecidedError(f"the run has no trials with {key}")
        return sorted(found)

    def rows(self, *cell: Any) -> dict[int, FinishedTrial | None]:
        """The finished trials of one cell by repeat, None for one that failed. Raises `UndecidedError`."""
        self.used.add(cell)
        if cell not in self._planned:
            told = ", ".join(f"{key} = {value}" for key, value in zip(self.keys, cell, strict=True))
            raise UndecidedError(f"the run has no trials with {told}")
        rows = self._planned[cell]
        if any(row is None for row in rows.values()):
            missing = sum(row is None for used in self.used for row in self._planned.get(used, {}).values())
            raise UndecidedError(f"{missing} of the trials that it needs have not run")
        return {repeat: row if row is not None and row.status == "done" else None for repeat, row in rows.items()}

    def values(self, measure: str, *cell: Any) -> dict[int, float]:
        """A measure of one cell by repeat; nan where it could not be measured or the trial failed."""
        return {
            repeat: row.measures.get(measure, math.nan) if row is not None else math.nan
            for repeat, row in self.rows(*cell).items()
        }

    def array(self, measure: str, *cell: Any) -> Floats:
        """(n,) the same without the repeats' numbers."""
        return np.array(list(self.values(measure, *cell).values()))

    def failed(self) -> int:
        """Failed trials in the cells that were asked for."""
        rows = [row for cell in self.used for row in self._planned.get(cell, {}).values()]
        return sum(row is not None and row.status != "done" for row in rows)

    def difference(self, measure: str, cell: tuple[Any, ...], other: tuple[Any, ...]) -> Floats:
        """(n,) `measure` in `cell` minus that in `other`, paired by repeat; nan where one of the two is missing."""
        first, second = self.values(measure, *cell), self.values(measure, *other)
        return np.array([first[repeat] - second[repeat] for repeat in sorted(first.keys() & second.keys())])

    def log_ratio(self, measure: str, cell: tuple[Any, ...], other: tuple[Any, ...]) -> Floats:
        """(n,) natural logarithm of `measure` in `cell` over that in `other`; nan where either is not positive."""
        first, second = self.values(measure, *cell), self.values(measure, *other)
        pairs = np.array([(first[r], second[r]) for r in sorted(first.keys() & second.keys())]).reshape(-1, 2)
        with np.errstate(divide="ignore", invalid="ignore"):
            logs = np.log(np.where(pairs > 0.0, pairs, np.nan))
        change: Floats = logs[:, 0] - logs[:, 1]
        return change
