"""A run's measures by cell: for each combination of conditions, the mean over its repeats with an interval."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from flocking.types import Floats
from trials.evidence.runs import Run
from trials.evidence.statistics import mean_interval

PART = "/"
"""In a name: a number of a table that an experiment's own claims and figures read, and no measure by itself."""


class Cell(NamedTuple):
    """The repeats of one combination of conditions."""

    conditions: Mapping[str, Any]
    planned: int
    failed: int
    measures: Mapping[str, Floats]
    """By name, the measure in each finished trial; nan where there was nothing to measure."""

    @property
    def done(self) -> int:
        """Finished trials that did not fail."""
        return len(next(iter(self.measures.values()), ()))


class Mean(NamedTuple):
    """Over the repeats of a cell, with its 95 % interval by Student's t."""

    measured: float
    low: float
    high: float
    n: int


def cells(run: Run, known: Iterable[str]) -> list[Cell]:
    """The cells of a run in the order of its trials, unfinished ones too.

    `known`: the measures of its simulation, in the order in which they are shown; others follow by their names.
    """
    rows, order = {row.index: row for row in run.rows()}, tuple(known)
    groups: dict[tuple[tuple[str, Any], ...], list[int]] = {}
    for trial in run.trials:
        groups.setdefault(tuple(trial.conditions.items()), []).append(trial.index)
    found = []
    for conditions, indices in groups.items():
        ended = [rows[index] for index in indices if index in rows]
        done = [row for row in ended if row.status == "done"]
        names = [name for name in order if any(name in row.measures for row in done)]
        names += sorted({name for row in done for name in row.measures if PART not in name} - set(names))
        measures = {name: np.array([row.measures.get(name, np.nan) for row in done]) for name in names}
        found.append(Cell(dict(conditions), len(indices), len(ended) - len(done), measures))
    return found


def mean(cell: Cell, measure: str) -> Mean:
    """A measure's mean in a cell; nan where there is none."""
    values = cell.measures.get(measure, np.empty(0))
    finite = values[np.isfinite(values)]
    return Mean(*mean_interval(finite), len(finite))


def named(conditions: Mapping[str, Any]) -> str:
    """Conditions in a few words, where nothing else is compared with them: as `naming` of them alone."""
    return naming([conditions])(conditions)


def naming(all_conditions: Iterable[Mapping[str, Any]]) -> Callable[[Mapping[str, Any]], str]:
    """What tells the conditions of a run in a few words, as in `member-based, exclusion_m 0.5`.

    A key is told by its last word, or by as many as tell it from the other keys of all these conditions; a text stands
    without its key where no other key ends as its does; a user's file is told by its name, or by so much of its path
    as tells it from the others.
    """
    seen = list(all_conditions)
    keys = {key for conditions in seen for key in conditions}
    files = {value for conditions in seen for value in conditions.values() if is_file(value)}
    labels = {key: _tail(key, ".", keys) for key in keys}
    ends = [_last(key, ".") for key in keys]
    alone = {key for key in keys if ends.count(_last(key, ".")) == 1}
    short = {file: _tail(file, os.sep, files) for file in files}

    def words(conditions: Mapping[str, Any]) -> str:
        told = []
        for key, value in conditions.items():
            word = short.get(value) or shown_value(value) if isinstance(value, str) else shown_value(value)
            in_text = isinstance(value, str) and key in alone
            told.append(word if in_text else f"{labels.get(key, key)} {word}")
        return ", ".join(told) or "all"

    return words


def shown_value(value: Any) -> str:
    """A condition's value: a number in short, true or false, a text as it is, a user's file by its name."""
    if isinstance(value, bool):
        return str(value).lower()
    if is_file(value):
        return _last(value, os.sep)
    return f"{value:g}" if isinstance(value, int | float) else str(value)


def is_file(value: object) -> bool:
    """Whether a condition's value is the path of a user's own file or folder (a law's may have a + behind it)."""
    return isinstance(value, str) and (os.sep in value or value.removesuffix("+").endswith(".py"))


def _last(text: str, separator: str) -> str:
    return text.rstrip(separator).rsplit(separator, 1)[-1]


def _tail(text: str, separator: str, among: Iterable[str]) -> str:
    """The shortest end of `text`, cut at a separator, that no other of the texts `among` ends with."""
    others = [f"{separator}{other}" for other in among if other != text]
    parts = text.rstrip(separator).split(separator)
    for count in range(1, len(parts) + 1):
        tail = separator.join(parts[-count:])
        if not any(other.endswith(f"{separator}{tail}") for other in others):
            return tail
    return text
