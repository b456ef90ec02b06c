"""Curves of the link tension index: precision and recall over time, and its calibration."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from trials.reports import figures as draw
from trials.reports.figures import Canvas
from trials.simulations.kinematic.links import BINS, HORIZONS, POSITIVE
from trials.studies.link_tension.estimates import Finished, Ratio, base_rate, bin_names, precision, recall, reliability

FEWEST_LINKS = 10
"""In a bin, below which its share is not drawn."""


class Line(NamedTuple):
    """One curve: its trials, and how its links are judged."""

    label: str
    conditions: Mapping[str, Any]
    kind: str = "ever"
    reading: str = "printed"
    horizon: float = 1.0
    """Of a calibration."""
    start: int = 0


def over_time(found: Finished, panels: Mapping[str, Sequence[Line]]) -> Canvas:
    """Precision (upper row) and recall (lower row) over the horizon, with the share of links that broke."""
    columns = len(panels)
    canvas, axes = draw.grid(2 * columns, columns, width=9.6, height=2.2)
    for column, (title, lines) in enumerate(panels.items()):
        for row, (name, estimate) in enumerate((("precision", precision), ("recall", recall))):
            axis = axes[row * columns + column]
            axis.set_title(f"{title}\n{name}", loc="left", fontsize=6)
            for rank, line in enumerate(lines):
                colour = draw.SERIES_COLOURS[rank]
                at = [found.counts(line.conditions, line.start, h, line.kind, line.reading) for h in HORIZONS]
                _curve(axis, HORIZONS, [estimate(some) for some in at], colour, line.label, 1.0 + 0.03 * rank)
                if row == 0:
                    axis.plot(HORIZONS, [base_rate(some).measured for some in at], ":", color=colour, lw=0.8)
            axis.set_xscale("log")
            axis.set_xticks(HORIZONS, [f"{h:g}" for h in HORIZONS])
            axis.minorticks_off()
            axis.set_ylim(-0.05, 1.05)
            axis.tick_params(labelsize=6)
            if row == 1:
                axis.set_xlabel("units of time after the index", fontsize=6)
    _legend(canvas, axes)
    return canvas


def reliabilities(found: Finished, panels: Mapping[str, Sequence[Line]]) -> Canvas:
    """The share of the links of each bin of the index that broke."""
    canvas, axes = draw.grid(len(panels), min(3, len(panels)), width=9.6, height=2.6)
    for axis, (title, lines) in zip(axes, panels.items(), strict=True):
        axis.set_title(title, loc="left", fontsize=7)
        for rank, line in enumerate(lines):
            counts = found.counts(line.conditions, line.start, line.horizon, line.kind, line.reading)
            links = np.sum([one.links for one in counts], axis=0) if counts else np.zeros(BINS)
            shown = np.flatnonzero(links >= FEWEST_LINKS)
            shares = reliability(counts)
            _curve(axis, shown + 0.06 * rank, [shares[b] for b in shown], draw.SERIES_COLOURS[rank], line.label)
        axis.axvline(POSITIVE - 0.5, ls="--", lw=0.7, color="#777777")
        axis.set_xticks(range(BINS), bin_names(), rotation=60, ha="right", fontsize=5)
        axis.set_ylim(-0.05, 1.05)
    _legend(canvas, axes)
    return canvas


def _curve(axis: Any, x: Any, shares: Sequence[Ratio], colour: str, label: str, nudge: float = 1.0) -> None:
    xs = np.asarray(x, dtype=np.float64) * nudge
    axis.plot(xs, [s.measured for s in shares], "-o", color=colour, ms=2.5, lw=0.9, label=label)
    axis.vlines(xs, [s.low for s in shares], [s.high for s in shares], color=colour, lw=0.9)


def _legend(canvas: Canvas, axes: Sequence[Any]) -> None:
    named = {label: handle for axis in axes for handle, label in zip(*axis.get_legend_handles_labels(), strict=True)}
    if named:
        canvas.legend(list(named.values()), list(named), loc="outside upper center", ncols=6, frameon=False)
