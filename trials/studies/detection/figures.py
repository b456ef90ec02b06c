"""The figures of the detection case study: which trials each shows. Fine 2015, figures 2.5 to 2.9."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from flocking.errors import InputError
from trials.evidence.runs import Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import Canvas, Figure, Place
from trials.studies.detection.conditions import EXCLUSION, KEYS, MEMBER, PIPELINE, SENSOR
from trials.types import Trial, TrialResult

PUBLISHED = ((MEMBER, 0.0, "2.6"), (SENSOR, 0.0, "2.7"), (SENSOR, 0.5, "2.8"), (SENSOR, 1.0, "2.9"))
"""Cells of the publication's figures of inputs."""


class Shown:
    """The series of the finished trials of one arm, each read once."""

    def __init__(self, run: Run, trials: Sequence[Trial]) -> None:
        done = {row.index for row in run.rows() if row.status == "done"}
        self._run = run
        self._finished = [trial for trial in trials if trial.index in done]
        self._read: dict[int, TrialResult | None] = {}

    def first(
        self, pipeline: Any, exclusion: Any, repeat: int | None = None, formation: str | None = None
    ) -> TrialResult | None:
        """Of the first finished trial of a cell, of any repeat and formation unless told; None if there is none."""
        for trial in self._finished:
            cell = (trial.conditions.get(PIPELINE), trial.conditions.get(EXCLUSION))
            if (
                cell == (pipeline, exclusion)
                and repeat in (None, trial.repeat)
                and formation in (None, trial.formation)
            ):
                return self._series(trial.index)
        return None

    def _series(self, index: int) -> TrialResult | None:
        if index not in self._read:
            try:
                self._read[index] = self._run.series(index)
            except InputError:  # its file is lost: the figure says that there is none
                self._read[index] = None
        return self._read[index]


def figures(run: Run, folder: Path) -> list[Figure]:
    """Inputs over time, trajectories and formations of each arm of the run, written to `folder`/figures."""
    return by_arm(run, folder, KEYS, _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    trials = run.trials
    shown = Shown(run, trials)
    repeat = min((trial.repeat for trial in trials), default=1)
    cells = list(dict.fromkeys((trial.conditions.get(PIPELINE), trial.conditions.get(EXCLUSION)) for trial in trials))
    ways = [(_cell_name(pipeline, at), shown.first(pipeline, at, repeat)) for pipeline, at in cells]
    drawn: dict[tuple[Any, Any], str] = {
        (pipeline, at): f" (figure {number})" for pipeline, at, number in PUBLISHED if (pipeline, at) in cells
    }
    drawn = drawn or dict.fromkeys(cells, "")  # another law or detection: none of the publication's cells
    inputs = [(f"{_cell_name(*cell)}{number}", shown.first(*cell)) for cell, number in drawn.items()]
    rows = []
    for formation in dict.fromkeys(trial.formation for trial in trials):
        results = [(_cell_name(*cell), shown.first(*cell, formation=formation)) for cell in drawn]
        first = next((result for _, result in results if result is not None), None)
        ends = [(f"end\n{name}", result, 1.0) for name, result in results]
        rows.append((formation, [("start", first, 0.0), *ends]))
    found = [
        draw.save(
            inputs_over_time(inputs),
            place,
            "inputs",
            "Inputs' distances over time",
            "One dot an input let through to the law, one colour a robot, black: belongs to nobody. "
            "As figures 2.6 to 2.9 of Fine 2015; one trial each.",
            dots=True,
        ),
        draw.save(
            draw.trajectories(ways),
            place,
            "trajectories",
            "Trajectories",
            f"All cells of repeat {repeat}: same start and noise. A dot where each robot ends.",
        ),
    ]
    if rows:
        caption = "Each starting formation, and where it ends in the cells of figures 2.6 to 2.9. Discs are to scale."
        found.append(draw.save(draw.formations(rows), place, "formations", "Formations", caption))
    return found


def inputs_over_time(panels: Sequence[tuple[str, TrialResult | None]]) -> Canvas:
    """Distances of all inputs over time, one panel a trial: one dot an input, one colour a robot.

    As figures 2.6 to 2.9 of Fine 2015. A panel whose trial is None says so.
    """
    columns = min(2, len(panels))
    canvas, axes = draw.grid(len(panels), columns, width=8.4, height=2.3, share=True)
    farthest = 0.0
    for axis, (title, result) in zip(axes, panels, strict=True):
        axis.set_title(title, loc="left")
        if result is None:
            draw.absent(axis)
            continue
        updates = result.updates.as_selected()
        of_update = np.repeat(np.arange(len(updates.times)), np.diff(updates.input_starts))
        positions = updates.input_positions.astype(np.float64)
        distances, who = np.hypot(positions[:, 0], positions[:, 1]), updates.robots[of_update]
        times, made_up = updates.times[of_update], updates.input_owners < 0
        axis.plot(times[made_up], distances[made_up], ",", color="black", alpha=0.5, rasterized=True)
        for robot, colour in zip(range(len(result.robot_names)), itertools.cycle(draw.ROBOT_COLOURS), strict=False):
            own = (who == robot) & ~made_up
            axis.plot(times[own], distances[own], ",", color=colour, rasterized=True)
        farthest = max(farthest, float(distances.max(initial=0.0)))
    axes[0].set_ylim(0.0, 1.03 * farthest or 1.0)
    for axis in axes[-columns:]:
        axis.set_xlabel("time (s)")
    for axis in axes[::columns]:
        axis.set_ylabel("distance of inputs (m)")
    return canvas


def _cell_name(pipeline: Any, at: Any) -> str:
    return ", ".join([*([str(pipeline)] if pipeline else []), *([f"{at:g} m"] if at is not None else [])]) or "all"
