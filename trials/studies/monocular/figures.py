"""The paths of Kirchner's robots, as figures 4.1 to 4.5 draw them: the lead robot's solid, the followers' dashed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from trials.evidence.runs import Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm, panels
from trials.reports.figures import ROBOT_COLOURS, Figure, Place
from trials.simulations.robots.measures_eyes import lead
from trials.studies.monocular.design import BODIES, BODY, FOOT
from trials.types import TrialResult

KEYS = (BODY,)


def figures(run: Run, folder: Path) -> list[Figure]:
    """The paths in the first trial with each body, and distance and speed over time."""
    return by_arm(run, folder, KEYS, _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    shown = panels(run, [(body, {BODY: body}) for body in BODIES])
    canvas, axes = draw.grid(2 * len(shown), 2, width=9.6, height=3.6 * len(shown))
    for row, (body, result) in enumerate(shown):
        left, right = axes[2 * row], axes[2 * row + 1]
        left.set_title(body, loc="left")
        if result is None or len(result.times) == 0:
            draw.absent(left)
            draw.absent(right)
            continue
        _paths(left, result)
        _distances(right, result)
    caption = (
        "The first trial of each body, in feet, and the distance of the others from the lead robot over time. Dots: "
        "where they end. As figures 4.1 to 4.5 of Kirchner 2006."
    )
    return [draw.save(canvas, place, "paths", "Paths", caption)]


def _paths(axis: Any, result: TrialResult) -> None:
    axis.set_aspect("equal", adjustable="datalim")
    ahead = lead(result)
    for k, name in enumerate(result.robot_names):
        way = result.poses_w[:, k, :2] / FOOT
        colour = ROBOT_COLOURS[k % len(ROBOT_COLOURS)]
        axis.plot(way[:, 0], way[:, 1], color=colour, lw=1.2, ls="-" if k == ahead else "--", label=name)
        axis.plot(*way[-1], "o", color=colour, ms=4)
    axis.set_xlabel("x (ft)")
    axis.set_ylabel("y (ft)")
    axis.legend(fontsize=7, frameon=False)


def _distances(axis: Any, result: TrialResult) -> None:
    ahead = lead(result)
    first = result.poses_w[:, ahead, :2]
    for k in range(len(result.robot_names)):
        if k == ahead:
            continue
        away = np.hypot(*(result.poses_w[:, k, :2] - first).T) / FOOT
        axis.plot(result.times, away, color=ROBOT_COLOURS[k % len(ROBOT_COLOURS)], lw=1.2, ls="--")
    axis.axhline(3.0, color="grey", lw=0.8)
    axis.set_xlabel("time (s)")
    axis.set_ylabel("distance from the lead (ft)")
