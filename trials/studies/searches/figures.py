"""The figures of the searches: curves, where they looked, and what their archives hold."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from trials.evidence.runs import Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import SERIES_COLOURS, Figure, Place
from trials.simulations.searches import fields
from trials.simulations.searches.loop import curve_of
from trials.studies.searches.design import METHOD
from trials.types import Trial


def figures(run: Run, folder: Path) -> list[Figure]:
    """The curves, and the archives of the first repeat, for each arm of the run."""
    return by_arm(run, folder, (METHOD,), _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    done = {row.index for row in run.rows() if row.status == "done"}
    by_method: dict[str, list[tuple[Trial, Any]]] = {}
    for trial in run.trials:
        if trial.index in done:
            by_method.setdefault(fields.of_trial(trial).method, []).append((trial, run.series(trial.index).tables))
    return [_curves(by_method, place), _archives(by_method, place)] if by_method else []


def _curves(by_method: dict[str, list[tuple[Trial, Any]]], place: Place) -> Figure:
    canvas, (axis,) = draw.grid(1, 1, width=6.4, height=3.4)
    for (method, trials), colour in zip(by_method.items(), SERIES_COLOURS, strict=False):
        curves = [curve_of(trial, tables) for trial, tables in trials]
        shortest = min(len(best) for _, best in curves)
        each = np.array([best[:shortest] for _, best in curves])
        for best in each:
            axis.step(curves[0][0][:shortest], best, where="post", color=colour, lw=0.4, alpha=0.5)
        axis.step(curves[0][0][:shortest], each.mean(axis=0), where="post", color=colour, lw=1.6, label=method)
    axis.set_xlabel("simulations")
    axis.set_ylabel("robustness of the best so far, on new starts")
    axis.set_ylim(-0.02, 1.02)
    axis.legend(frameon=False)
    caption = (
        "Thick: the mean of the repeats. The search itself sees other starts, and takes for best what did best there."
    )
    return draw.save(canvas, place, "curves", "Best so far against simulations", caption)


def _archives(by_method: dict[str, list[tuple[Trial, Any]]], place: Place) -> Figure:
    """Elites over the first two descriptors, coloured by their robustness on new starts; dots are all points."""
    canvas, axes = draw.grid(len(by_method), 2, width=7.2, height=2.9)
    shown = None
    for axis, (method, trials) in zip(axes, by_method.items(), strict=True):
        trial, tables = trials[0]
        names, cells = fields.archive_of(trial)
        (x0, x1), (y0, y1) = tables["bounds"][:2]
        best = np.full(cells, -np.inf)
        places = np.unravel_index(tables["cells"], cells)
        np.maximum.at(best, places, tables["elites_anew"])
        flat = best.reshape(*cells[:2], -1).max(axis=2)
        held = np.ma.masked_invalid(np.where(np.isfinite(flat), flat, np.nan))
        shown = axis.imshow(held.T, origin="lower", extent=(x0, x1, y0, y1), aspect="auto", vmin=0.0, vmax=1.0)
        axis.plot(*tables["descriptors"][:, :2].T, ".", color="#000000", ms=1.5)
        axis.set_title(method, loc="left")
        axis.set_xlabel(names[0])
        axis.set_ylabel(names[1])
    canvas.colorbar(shown, ax=axes, label="robustness on new starts", shrink=0.7)
    caption = "The first repeat of each method. A cell is coloured by its elite, on new starts; dots: all points tried."
    return draw.save(canvas, place, "archives", "What the archives hold", caption)
