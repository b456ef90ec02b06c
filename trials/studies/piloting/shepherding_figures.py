"""The figures of `shepherding`: the share that arrives by what guides the herd, and moments of a trial of each."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from trials.evidence.runs import Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import Figure, Place
from trials.studies.piloting.design import MEASURE, SHEEPDOGS
from trials.studies.piloting.drawn import GUIDED, GUIDING, mean, named, snapshots
from trials.studies.piloting.shepherding_claims import KEYS
from trials.types import TrialResult

MOMENTS = 4
COLOURS = {MEASURE: GUIDED, "astray_share": GUIDING}
LABELS = {MEASURE: "arrive", "astray_share": "leave the corridor before"}


def figures(run: Run, folder: Path) -> list[Figure]:
    """The shares by task, and moments of a trial of each guide in each task, for each arm of the run."""
    return by_arm(run, folder, KEYS, _both)


def _both(run: Run, place: Place) -> list[Figure]:
    tasks = list(dict.fromkeys(str(trial.conditions[KEYS[0]]) for trial in run.trials))
    found = [_shares(run, place, tasks)]
    return found + [_moments(run, place, task) for task in tasks if _first(run, task)]


def _label(cell: tuple[object, ...]) -> str:
    _, guides, rule, count = cell
    return f"{rule}, {count}" if guides == SHEEPDOGS else str(guides)


def _cells(run: Run, task: str) -> list[tuple[object, ...]]:
    of = (tuple(map(trial.conditions.get, KEYS)) for trial in run.trials)
    return [cell for cell in dict.fromkeys(of) if cell[0] == task]


def _shares(run: Run, place: Place, tasks: list[str]) -> Figure:
    done = [row for row in run.rows() if row.status == "done"]
    canvas, axes = draw.grid(len(tasks), 2, width=8.0, height=2.9 * ((len(tasks) + 1) // 2))
    for axis, task in zip(axes, tasks, strict=False):
        cells = _cells(run, task)
        for side, (measure, colour) in enumerate(COLOURS.items()):
            for x, cell in enumerate(cells):
                own = np.array([row.measures[measure] for row in done if tuple(map(row.conditions.get, KEYS)) == cell])
                mean(axis, x + 0.1 * (2 * side - 1), own, colour)
            axis.plot([], [], "o", color=colour, label=LABELS[measure])
        axis.set_title(task, loc="left")
        axis.set_xticks(range(len(cells)), [_label(cell) for cell in cells], rotation=30, ha="right", fontsize=7)
        axis.set_ylim(-0.05, 1.1)
    axes[0].legend(frameon=False)
    caption = "Mean share of the herd, with 95 % intervals; the number is that of the sheepdogs."
    return draw.save(canvas, place, "shares", "Formations and sheepdogs", caption)


def _first(run: Run, task: str) -> list[tuple[str, TrialResult]]:
    """Of each guide of a task, its first trial whose series is there."""
    found = []
    for cell in _cells(run, task):
        own = [t.index for t in run.trials if tuple(map(t.conditions.get, KEYS)) == cell]
        results = (run.series(index) for index in own)
        result = next((each for each in results if each is not None), None)
        if result is not None:
            found.append((_label(cell), result))
    return found


def _moments(run: Run, place: Place, task: str) -> Figure:
    canvas = snapshots(_first(run, task), MOMENTS)
    caption = (
        "Green: the herd and its ways; red: robots that guide it; dotted: the trajectory. The first trial of each."
    )
    return draw.save(canvas, place, f"moments-{named(task)}", f"Guides in {named(task)}", caption, dots=True)
