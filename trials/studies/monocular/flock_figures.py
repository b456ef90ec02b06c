"""Where robots with eyes end after a minute, and into how many flocks each way of seeing divides them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from trials.evidence.runs import Cells, Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm, panels
from trials.reports.figures import Figure, Place
from trials.studies.monocular.design import BODY
from trials.studies.monocular.flock_claims import COUNT, KEYS, NEAREST, OCCLUSION, PIPELINE

WAYS = 8


def figures(run: Run, folder: Path) -> list[Figure]:
    """Flocks by way of seeing, and the ways of the first trials by eyes."""
    return by_arm(run, folder, KEYS, _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    cells = Cells(run.trials, run.rows(), KEYS)
    herds = list(dict.fromkeys(cell[:2] for cell in cells.planned()))
    canvas, axes = draw.grid(len(herds), 2, width=9.6, height=2.6 * ((len(herds) + 1) // 2))
    for axis, herd in zip(axes, herds, strict=False):
        mine = [cell for cell in cells.planned() if cell[:2] == herd]
        for row, cell in enumerate(mine):
            flocks = cells.array("flocks", *cell)
            flocks = flocks[np.isfinite(flocks)]
            if len(flocks):
                axis.plot(flocks, np.full(len(flocks), row), "o", color="grey", ms=3, alpha=0.5)
                axis.plot(flocks.mean(), row, "D", color="black", ms=5)
        axis.set_yticks(range(len(mine)), [_told(cell) for cell in mine], fontsize=7)
        axis.set_xlabel("flocks after a minute")
        axis.set_title(f"{herd[0]} {'Pioneers' if herd[1] else 'Creates'}", loc="left")
    caption = "Dots: trials; diamonds: means. Flocks are divided by gaps of more than four feet."
    found = [draw.save(canvas, place, "flocks", "Flocks after a minute", caption)]
    shown = panels(run, [(_told(cell), _conditions(cell)) for cell in cells.planned() if cell[2] != "perfect"][:WAYS])
    if any(result is not None for _, result in shown):
        drawing = draw.trajectories(shown, columns=2)
        found.append(draw.save(drawing, place, "ways", "Ways by eyes", "First trials; a dot where each robot ends."))
    return found


def _conditions(cell: tuple[object, ...]) -> dict[str, object]:
    named = zip((COUNT, BODY, PIPELINE, NEAREST, OCCLUSION), cell, strict=True)
    return {key: value for key, value in named if value is not None}


def _told(cell: tuple[object, ...]) -> str:
    _, _, pipeline, nearest, occlusion = cell
    hidden = "" if occlusion is None else ", hidden by others" if occlusion else ", nobody hides"
    return f"{pipeline}, {'nearest' if nearest else 'all'}{hidden}"
