"""The figures of a run with several arms: those of each arm, told apart by what was varied."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from trials.evidence.runs import Part, Run, arms
from trials.evidence.summary import naming
from trials.reports.figures import Figure, Place
from trials.reports.ways import first_result
from trials.types import TrialResult

MOST_PANELS = 60
"""Of one drawing."""
TITLE_LETTERS = 28
"""In a line of a panel's title, which then does not run into the next panel's."""


def by_arm(run: Run, folder: Path, keys: Sequence[str], drawn: Callable[[Run, Place], list[Figure]]) -> list[Figure]:
    """The figures of each arm of a run: of each combination of the conditions other than `keys`, named by them."""
    words, made = naming(trial.conditions for trial in run.trials), list[Figure]()
    rows = {row.index: row for row in run.rows()}
    for number, (arm, trials) in enumerate(arms(run, keys), start=1):
        place = Place(folder, f"-{number}" if number > 1 else "", words(arm) if arm else "")
        finished = [rows[trial.index] for trial in trials if trial.index in rows]
        made += drawn(Part(run, trials, finished), place)
    return made


def planned(run: Run, conditions: Mapping[str, Any]) -> bool:
    """Whether a run has trials, finished or not, with these among their conditions."""
    return any(conditions.items() <= trial.conditions.items() for trial in run.trials)


def panels(run: Run, wanted: Sequence[tuple[str, Mapping[str, Any]]]) -> list[tuple[str, TrialResult | None]]:
    """The first finished trial of each cell to be drawn, with its title; None where there is none yet.

    Drawn are those of the `wanted` cells that the run has, and the cells in which one of the wanted conditions has a
    value that none of them has: another law, say. Where there is neither, every cell is.
    """
    usual: dict[str, set[Any]] = {}
    for _, cell in wanted:
        for key, value in cell.items():
            usual.setdefault(key, set()).add(value)
    words, every = naming(trial.conditions for trial in run.trials), dict[tuple[Any, ...], Mapping[str, Any]]()
    for trial in run.trials:
        every.setdefault(tuple(trial.conditions.items()), trial.conditions)

    def headed(cell: Mapping[str, Any]) -> str:
        return textwrap.fill(words(cell), TITLE_LETTERS)

    drawn = [(title, cell) for title, cell in wanted if planned(run, cell)]
    drawn += [
        (headed(cell), cell)
        for cell in every.values()
        if any(key in usual and value not in usual[key] for key, value in cell.items())
    ]
    drawn = drawn or [(headed(cell), cell) for cell in every.values()]
    if len(drawn) > MOST_PANELS:
        title, cell = drawn[MOST_PANELS - 1]
        drawn[MOST_PANELS - 1 :] = [(f"{title} (and {len(drawn) - MOST_PANELS} cells more)", cell)]
    return [(title, first_result(run, cell)) for title, cell in drawn]
