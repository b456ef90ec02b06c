"""The cone tests drawn: distances beside appendix A's, and what each segmentation still finds."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from sensing.camera.cones import RADIUS_M
from sensing.camera.lens import PIXELS_PER_DEGREE
from trials.evidence.claims import published
from trials.evidence.runs import Cells, Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import ROBOT_COLOURS, Figure, Place
from trials.studies.monocular.cone_claims import AXES, DISTANCE, KEYS, KINDS, NOMINAL, PROJECTION
from trials.studies.monocular.design import FOOT

UNITS = {
    "light": "light, of the nominal",
    "distance_m": "distance, m",
    "hidden": "hidden share of the width",
    "speed_m_s": "speed, m/s",
}
FEWEST_PIXELS, MOST_PIXELS = 14, 200


def distance_figures(run: Run, folder: Path) -> list[Figure]:
    """Estimated against true distances, with the steps of whole pixels and the published means."""
    return by_arm(run, folder, (DISTANCE, PROJECTION), _distances)


def _distances(run: Run, place: Place) -> list[Figure]:
    cells = Cells(run.trials, run.rows(), (DISTANCE, PROJECTION))
    canvas, (axis, *_) = draw.grid(1, 1, width=6.4, height=4.8)
    for pixels in range(FEWEST_PIXELS, MOST_PIXELS):
        away = RADIUS_M / math.tan(math.radians(pixels / PIXELS_PER_DEGREE) / 2.0) - RADIUS_M
        axis.axhline(away / FOOT, color="lightgrey", lw=0.5, zorder=0)
    for number, projection in enumerate(dict.fromkeys(cell[1] for cell in cells.planned())):
        mine = [cell for cell in cells.planned() if cell[1] == projection]
        values = [(cell[0] / FOOT, value / FOOT) for cell in mine for value in cells.array("distance", *cell)]
        true, found = np.array(values).T
        axis.plot(true, found, "o", color=ROBOT_COLOURS[number], ms=3, label=projection)
    rows = np.array(published(__package__, "kirchner2006", "appendix_a")["rows"])
    axis.plot(rows[:, 0], rows[:, 1:6].mean(axis=1), "x", color="black", ms=6, label="published")
    axis.plot([0, 6.2], [0, 6.2], color="grey", lw=0.8)
    axis.set_xlabel("true distance (ft)")
    axis.set_ylabel("estimated (ft)")
    axis.set_ylim(0, 12)
    axis.legend(fontsize=7, frameon=False)
    caption = "Dots: tests; crosses: the publication's means; grey lines: whole pixels by equation 3.5."
    return [draw.save(canvas, place, "distances", "Distances of a cone", caption)]


def robustness_figures(run: Run, folder: Path) -> list[Figure]:
    """Detection rate, false inputs and errors along each axis, a line a kind."""
    return by_arm(run, folder, KEYS, _robustness)


def _robustness(run: Run, place: Place) -> list[Figure]:
    cells = Cells(run.trials, run.rows(), KEYS)
    found = []
    for measure, name, title in (
        ("detected", "detected", "Detection rate"),
        ("pixels_found", "pixels", "Share of the cone's pixels"),
        ("false_inputs", "false", "False inputs a look"),
        ("distance_deviates", "distance-error", "Error of the distance"),
        ("bearing_error", "bearing-error", "Error of the bearing"),
    ):
        canvas, axes = draw.grid(len(AXES), 2, width=9.6, height=6.4)
        for number, axis_of in enumerate(AXES):
            _lines(axes[number], cells, measure, number)
            axes[number].set_xlabel(UNITS[axis_of])
            axes[number].set_ylabel(title.lower())
        axes[0].legend(fontsize=6, frameon=False)
        caption = "Mean over the repeats; what is not varied is nominal: light 1, 1.5 m, nothing hidden, at rest."
        found.append(draw.save(canvas, place, name, title, caption))
    return found


def _lines(axis: Any, cells: Cells, measure: str, varied: int) -> None:
    nominal = tuple(NOMINAL.values())
    for number, (kind, given) in enumerate(KINDS.items()):
        rows = []
        for cell in cells.planned():
            at = cell[3:]
            if cell[:3] != tuple(given.values()) or any(at[k] != nominal[k] for k in range(4) if k != varied):
                continue
            values = cells.array(measure, *cell)
            values = values[np.isfinite(values)]
            if len(values):
                rows.append((at[varied], float(values.mean())))
        if rows:
            axis.plot(*zip(*sorted(rows), strict=True), "o-", ms=3, lw=1, color=ROBOT_COLOURS[number], label=kind)
