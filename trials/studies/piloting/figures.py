"""The figures of `piloting`: table 8.1 beside ours, and a time series of a trial of each cell (figures 8.6 to 8.10)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from trials.evidence.claims import published
from trials.evidence.runs import FinishedTrial, Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import Figure, Place
from trials.studies.piloting.design import KEYS, MEASURE, PILOTS, WALLS
from trials.studies.piloting.drawn import mean, named, snapshots, whole
from trials.types import TrialResult

COLOURS = {WALLS: "#0072b2", PILOTS: "#d55e00"}
LABELS = {WALLS: "walls", PILOTS: "robots"}
MOMENTS = 4


def figures(run: Run, folder: Path) -> list[Figure]:
    """The table and the time series, for each arm of the run."""
    return by_arm(run, folder, KEYS, _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    return [_table(run, place), *_whole(run, place), *_series(run, place)]


def _done(run: Run, task: str, guides: str) -> list[FinishedTrial]:
    rows = [row for row in run.rows() if row.status == "done"]
    return [row for row in rows if tuple(map(row.conditions.get, KEYS)) == (task, guides)]


def _tasks(run: Run) -> list[str]:
    return list(dict.fromkeys(str(trial.conditions[KEYS[0]]) for trial in run.trials))


def _table(run: Run, place: Place) -> Figure:
    table, tasks = published(__package__, "fine2015", "table_8_1"), _tasks(run)
    canvas, (axis,) = draw.grid(1, 1, width=5.6, height=3.2)
    for side, (guides, colour) in enumerate(COLOURS.items()):
        at = np.arange(len(tasks)) + 0.16 * (2 * side - 1)
        for x, task in zip(at, tasks, strict=True):
            own = np.array([row.measures[MEASURE] for row in _done(run, task, guides)])
            mean(axis, x, own, colour)
        axis.plot(at, [table[guides].get(task, np.nan) for task in tasks], "x", color=colour, ms=6)
        axis.plot([], [], "o", color=colour, label=LABELS[guides])
    axis.plot([], [], "x", color="black", label="published")
    axis.set_xticks(range(len(tasks)), list(map(named, tasks)))
    axis.set_ylim(-0.02, 1.15)
    axis.set_ylabel("share that arrives")
    axis.legend(frameon=False, ncols=3, loc="upper left")
    caption = (
        "Mean share of the robots that follow the trajectory to the goal, with 95 % intervals of the mean; crosses: "
        "table 8.1 of Fine 2015."
    )
    return draw.save(canvas, place, "table", "Table 8.1", caption)


def _best(run: Run, task: str, guides: str) -> TrialResult | None:
    """The first of the trials of a cell in which most robots arrive; None where its series is gone."""
    own = sorted(_done(run, task, guides), key=lambda row: (-row.measures[MEASURE], row.index))
    return run.series(own[0].index) if own else None


def _whole(run: Run, place: Place) -> list[Figure]:
    """Of each task the best trial by robots, as in figure 8.6."""
    found = [(task, result) for task in _tasks(run) if (result := _best(run, task, PILOTS)) is not None]
    if not found:
        return []
    canvas, axes = draw.grid(len(found), 2, width=6.4, height=3.4 * ((len(found) + 1) // 2))
    for axis, (task, result) in zip(axes, found, strict=False):
        whole(axis, result)
        axis.set_title(named(task), loc="left")
    caption = (
        "Green: the robots that are guided; red: those that guide them, where they end; black: their ways; yellow: the "
        "walls that they take for templates; dotted: the trajectory, from blue to light green. The best trial of each, "
        "as in figure 8.6 of Fine 2015."
    )
    return [draw.save(canvas, place, "whole", "Formations in place of walls", caption, dots=True)]


def _series(run: Run, place: Place) -> list[Figure]:
    """Of each task, moments of the first of the trials in which most robots arrive, by walls above and robots below."""
    found = []
    caption = (
        "Green: the robots that are guided; red: those that guide; yellow: walls that stand, thin those that robots "
        "hold or are sent to; dotted: the trajectory. "
        "The best trial of each; time from left to right."
    )
    for task in _tasks(run):
        rows = []
        for guides, label in LABELS.items():
            result = _best(run, task, guides)
            if result is not None:
                rows.append((label, result))
        if rows:
            canvas, name = snapshots(rows, MOMENTS), f"{named(task)}, as in figures 8.6 to 8.10"
            found.append(draw.save(canvas, place, f"series-{named(task)}", name, caption, dots=True))
    return found
