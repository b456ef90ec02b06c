"""The figures of `piloting`: table 8.1 beside ours, and a time series of a trial of each cell (figures 8.7 to 8.10)."""

from __future__ import annotations

import numpy as np

from trials.evidence.claims import published
from trials.evidence.runs import FinishedTrial, Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import Figure, Place
from trials.studies.piloting.design import KEYS, MEASURE, PILOTS, WALLS
from trials.studies.piloting.drawn import snapshots
from pathlib import Path

COLOURS = {WALLS: "#0072b2", PILOTS: "#d55e00"}
LABELS = {WALLS: "walls", PILOTS: "robots"}
MOMENTS = 4


def figures(run: Run, folder: Path) -> list[Figure]:
    """The table and the time series, for each arm of the run."""
    return by_arm(run, folder, KEYS, _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    return [_table(run, place), *_series(run, place)]


def _done(run: Run) -> list[FinishedTrial]:
    return [row for row in run.rows() if row.status == "done"]


def _table(run: Run, place: Place) -> Figure:
    table, done = published(__package__, "fine2015", "table_8_1"), _done(run)
    tasks = list(dict.fromkeys(str(trial.conditions[KEYS[0]]) for trial in run.trials))
    canvas, (axis,) = draw.grid(1, 1, width=5.6, height=3.2)
    for side, guides in enumerate(LABELS):
        for k, task in enumerate(tasks):
            own = np.array([r.measures[MEASURE] for r in done if (r.conditions[KEYS[0]], r.conditions[KEYS[1]]) == (task, guides)])
            at = k + 0.16 * (2 * side - 1)
            shown = LABELS[guides] if k == 0 else None
            if len(own):
                reach = 2.262 * own.std(ddof=1) / len(own) ** 0.5 if len(own) > 1 else 0.0
                axis.errorbar([at], [own.mean()], [reach], fmt="o", color=COLOURS[guides], ms=4, label=shown)
            if task in table[guides]:
                axis.plot([at], [table[guides][task]], "x", color=COLOURS[guides], ms=6, label="published" if k == 0 and side else None)
    axis.set_xticks(range(len(tasks)), tasks)
    axis.set_ylim(-0.02, 1.05)
    axis.set_ylabel("share that arrives")
    axis.legend(frameon=False, loc="lower left")
    caption = "Mean share of the robots that follow the trajectory to the goal, with 95 % intervals of the mean; crosses: table 8.1 of Fine 2015."
    return draw.save(canvas, place, "table", "Table 8.1", caption)


def _series(run: Run, place: Place) -> list[Figure]:
    """Of each task, moments of the first trial in which most robots arrive, guided by walls above and by robots below."""
    found = []
    done = _done(run)
    for task in dict.fromkeys(str(trial.conditions[KEYS[0]]) for trial in run.trials):
        rows = []
        for guides in LABELS:
            own = [r for r in done if (r.conditions[KEYS[0]], r.conditions[KEYS[1]]) == (task, guides)]
            if own:
                best = max(own, key=lambda row: (row.measures[MEASURE], -row.index))
                result = run.series(best.index)
                if result is not None:
                    rows.append((LABELS[guides], result))
        if rows:
            caption = "Green: the robots that are guided; red: those that guide; yellow: walls that stand; dotted: the trajectory. The best trial of each; time from left to right."
            found.append(draw.save(snapshots(task, rows, MOMENTS), place, f"series-{task}", f"{task}, as in figures 8.7 to 8.10", caption, dots=True))
    return found
