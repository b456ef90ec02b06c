"""A run's measures by cell: for each combination of conditions, the mean over its repeats with an interval."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
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
    """Conditions in a few words: `member-based, exclusion_m 0.5`."""
    words = []
    for key, value in conditions.items():
        last = key.rsplit(".", 1)[-1]
        words.append(str(value) if isinstance(value, str) else f"{last} {value:g}")
    return ", ".join(words) or "all"
