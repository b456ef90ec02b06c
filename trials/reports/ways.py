"""Drawings of herds too large to tell members apart: their ways from start to end, curves of a measure over a
condition; and the trials that a drawing shows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from flocking.errors import InputError
from flocking.types import Floats
from trials.evidence.runs import Run
from trials.evidence.statistics import mean_interval
from trials.reports import figures as draw
from trials.reports.figures import Canvas
from trials.simulations.tracks import period_of, strips
from trials.types import TrialResult

START_COLOUR, END_COLOUR, WAY_COLOUR = "#0072b2", "#009e73", "#999999"
DRAWN_MOMENTS = 100
"""Of a way, at most."""


class Curve(NamedTuple):
    """One line of a plot: at each x the values of the repeats."""

    label: str
    x: Sequence[float]
    values: Sequence[Floats]


def ways(panels: Sequence[tuple[str, TrialResult | None]], columns: int = 4) -> Canvas:
    """All members' ways, one panel a trial: blue where they start, green where they end, as Fine 2015's figure 4.5."""
    from matplotlib.collections import LineCollection

    columns = min(columns, len(panels))
    canvas, axes = draw.grid(len(panels), columns, width=9.6, height=9.6 / columns)
    for axis, (title, result) in zip(axes, panels, strict=True):
        axis.set_title(title, loc="left")
        axis.set_aspect("equal", adjustable="datalim")
        if result is None:
            draw.absent(axis)
            continue
        every = max(1, (len(result.times) - 1) // DRAWN_MOMENTS)
        pieces, _ = strips(result.poses_w[::every, :, :2], period_of(result))
        axis.add_collection(LineCollection(list(pieces), colors=WAY_COLOUR, lw=0.4, zorder=1))
        draw.walls(axis, result)
        for moment, colour in ((0, START_COLOUR), (-1, END_COLOUR)):
            axis.plot(*result.poses_w[moment, :, :2].T, "s", color=colour, ms=2.0, mew=0.0, zorder=2)
        axis.tick_params(labelsize=6)
    return canvas


def curves(
    panels: Mapping[str, Sequence[Curve]],
    x_label: str,
    logarithmic: bool = False,
    bounds: tuple[float, float] | None = None,
) -> Canvas:
    """Means over the repeats with their 95 % intervals over a condition: a panel a measure, a line a curve."""
    canvas, axes = draw.grid(len(panels), len(panels), width=max(6.4, 4.4 * len(panels)), height=3.6)
    for axis, (title, lines) in zip(axes, panels.items(), strict=True):
        axis.set_title(title, loc="left")
        axis.set_xlabel(x_label)
        for rank, curve in enumerate(lines):
            colour = draw.SERIES_COLOURS[rank % len(draw.SERIES_COLOURS)]
            means = np.array([mean_interval(values) for values in curve.values]).reshape(-1, 3)
            axis.plot(curve.x, means[:, 0], "-o", color=colour, ms=2.5, lw=0.9, label=curve.label)
            axis.vlines(curve.x, means[:, 1], means[:, 2], color=colour, lw=0.9)
        if logarithmic:
            axis.set_xscale("log")
        if bounds is not None:
            axis.set_ylim(*bounds)
    handles, labels = axes[0].get_legend_handles_labels()
    if any(labels):
        canvas.legend(handles, labels, loc="outside upper center", ncols=min(5, len(labels)), frameon=False)
    return canvas


def first_result(run: Run, conditions: Mapping[str, Any]) -> TrialResult | None:
    """The series of the first finished trial with these conditions among its own; None if there is none."""
    done = {row.index for row in run.rows() if row.status == "done"}
    for trial in run.trials:
        if trial.index in done and conditions.items() <= trial.conditions.items():
            try:
                return run.series(trial.index)
            except InputError:  # its file is lost: the figure says that there is none
                return None
    return None


def curve_of(run: Run, measure: str, over: str, label: str, conditions: Mapping[str, Any]) -> Curve:
    """A measure of the finished trials with these conditions over another condition."""
    found: dict[float, list[float]] = {}
    rows = {row.index: row for row in run.rows() if row.status == "done"}
    for trial in run.trials:
        if trial.index in rows and over in trial.conditions and conditions.items() <= trial.conditions.items():
            found.setdefault(float(trial.conditions[over]), []).append(rows[trial.index].measures[measure])
    xs = sorted(found)
    return Curve(label, xs, [np.array(found[x]) for x in xs])
