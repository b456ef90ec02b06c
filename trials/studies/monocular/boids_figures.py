"""Figures of Kirchner's simulation: 3.8 to 3.11, where robots are at the end and which are a flock; 4.6 and 4.7, before
and after a failure; and the number of flocks over time. In pixels, as published."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from flocking.errors import InputError
from trials.evidence.runs import Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm, panels
from trials.reports.figures import Canvas, Figure, Place
from trials.reports.ways import Curve, curves
from trials.simulations.kinematic import fields, flocks
from trials.simulations.kinematic.loop import FAILED_S
from trials.studies.monocular.boids import (
    COUNT,
    NORMAL_M,
    OBSTACLES,
    PIXEL_M,
    PREDATOR,
    SHORT_M,
    VIEW,
    WITH_OBSTACLES,
    WITH_PREDATOR,
)
from trials.studies.monocular.boids_claims import FAILING, KEYS, MIDDLE
from trials.types import TrialResult

COLOURS = {"herd": "#1f4fd6", PREDATOR: "#d62728", OBSTACLES: "#999999"}
FAILED, BOX = "#000000", "#009e73"
ROOM_PX = 9.0
"""Between a flock and its box."""
DISC_PX = 20.0
SIGHTS = ((NORMAL_M, "normal sight"), (SHORT_M, "short sight"))
ARROWS = {"scale": 22.0, "width": 0.009, "pivot": "mid"}
"""Of headings: a twenty-second of a panel's width."""
MOMENTS_CAPTION = (
    "The first seed of each setting after one minute; pixels of 8 mm, as figures 3.8 to 3.11 of Kirchner 2006. Blue: "
    "the robots; red: the predator; grey: obstacles. A box holds each flock of two or more."
)
FAILURE_CAPTION = (
    "The first seed in which all nine were one flock: the last second before the robot in the middle failed, and five "
    "seconds after, as figures 4.6 and 4.7 of Kirchner 2006. Black, in a black box: robots that failed."
)
TIME_CAPTION = "Mean over the seeds with its 95 % interval, a robot by itself counted as a flock."


def figures(run: Run, folder: Path) -> list[Figure]:
    """The end of a trial of each setting, and the number of flocks over time."""
    return by_arm(run, folder, KEYS, _after_a_minute)


def _after_a_minute(run: Run, place: Place) -> list[Figure]:
    wanted = [
        (f"{count}, {words}", {COUNT: count, VIEW: view, WITH_PREDATOR: 1, WITH_OBSTACLES: 0})
        for view, words in SIGHTS
        for count in (3, 20)
    ]
    others = ((1, 7, "with obstacles"), (0, 0, "no predator"), (0, 7, "obstacles alone"))
    wanted += [
        (f"20, {words}", {COUNT: 20, VIEW: NORMAL_M, WITH_PREDATOR: predators, WITH_OBSTACLES: obstacles})
        for predators, obstacles, words in others
    ]
    shown = panels(run, wanted)
    lines = dict(wanted[:4])
    return [
        draw.save(
            moments([(title, result, -1) for title, result in shown]),
            place,
            "ends",
            "After one minute",
            MOMENTS_CAPTION,
        ),
        draw.save(over_time(run, lines, every=5), place, "flocks", "Number of flocks over time", TIME_CAPTION),
    ]


def sight_figures(run: Run, folder: Path) -> list[Figure]:
    """The number of flocks over twenty minutes."""
    return by_arm(run, folder, (VIEW,), _over_twenty_minutes)


def _over_twenty_minutes(run: Run, place: Place) -> list[Figure]:
    lines = {words: {VIEW: view} for view, words in SIGHTS}
    return [draw.save(over_time(run, lines, every=20), place, "flocks", "Number of flocks over time", TIME_CAPTION)]


def failure_figures(run: Run, folder: Path) -> list[Figure]:
    """Before and after the failure in the middle, and the number of flocks over time."""
    return by_arm(run, folder, FAILING, _around_a_failure)


def _around_a_failure(run: Run, place: Place) -> list[Figure]:
    done = {row.index: row for row in run.rows() if row.status == "done"}
    made = []
    for trial in run.trials:
        time = float(trial.conditions.get(MIDDLE, fields.NEVER))
        if trial.index in done and time > 0.0 and done[trial.index].measures["flocks_before"] == 1.0:
            result, given = _series(run, trial.index), fields.flocks_of(trial)
            if result is None:
                continue
            after = time + (given.after_s if given is not None else 0.0)
            shown = [(f"before, seed {trial.repeat}", result, int((result.times < time).sum()) - 1)]
            shown.append((f"after, seed {trial.repeat}", result, int(np.searchsorted(result.times, after))))
            made.append(draw.save(moments(shown), place, "failure", "A failure in the middle of nine", FAILURE_CAPTION))
            break
    cells = {tuple(trial.conditions.items()): dict(trial.conditions) for trial in run.trials}
    lines = {_words(cell): cell for cell in cells.values()}
    return [
        *made,
        draw.save(over_time(run, lines, every=5), place, "flocks", "Number of flocks over time", TIME_CAPTION),
    ]


def _series(run: Run, index: int) -> TrialResult | None:
    """The series of a trial; None where it is lost."""
    try:
        return run.series(index)
    except InputError:
        return None


def _words(cell: Mapping[str, Any]) -> str:
    count, middle, chance = (cell.get(key, 0.0) for key in FAILING)
    if middle > 0.0:
        return f"{count}, one fails at {middle:g} s"
    return f"{count}, {chance:.2%} a step" if chance > 0.0 else f"{count}, none fails"


def moments(shown: Sequence[tuple[str, TrialResult | None, int]]) -> Canvas:
    """A panel a moment (title, trial, its number among those kept): places, headings, walls, and a box a flock."""
    from matplotlib.collections import LineCollection
    from matplotlib.patches import Circle, Rectangle

    columns = min(4, len(shown))
    canvas, axes = draw.grid(len(shown), columns, width=9.6, height=9.6 / columns)
    for axis, (title, result, moment) in zip(axes, shown, strict=True):
        axis.set_title(title, loc="left")
        axis.set_aspect("equal", adjustable="datalim")
        axis.tick_params(labelsize=6)
        if result is None:
            draw.absent(axis)
            continue
        axis.add_collection(LineCollection(list(result.walls_w.reshape(-1, 2, 2) / PIXEL_M), colors="#555555", lw=0.8))
        poses, time = result.poses_w[moment], float(result.times[moment])
        places, headings = poses[:, :2] / PIXEL_M, poses[:, 2]
        noses = np.stack([np.cos(headings), np.sin(headings)], axis=1)
        works = flocks.works_at(time, result.tables.get(FAILED_S, np.full(len(poses), np.nan)))
        first = 0
        for group in result.trial.groups:
            own = slice(first, first + group.count)
            first += group.count
            if group.name == OBSTACLES:
                for x, y in places[own]:
                    axis.add_patch(Circle((x, y), DISC_PX, color=COLOURS[OBSTACLES], lw=0.0))
                continue
            colours = [
                COLOURS.get(group.name, COLOURS["herd"]) if works[k] else FAILED for k in range(*own.indices(first))
            ]
            axis.quiver(*places[own].T, *noses[own].T, color=colours, **ARROWS)
        for low, high in boxes(result, moment):
            axis.add_patch(Rectangle(tuple(low), *(high - low), fill=False, ec=BOX, lw=0.8))
        for x, y in places[: result.trial.groups[0].count][~works[: result.trial.groups[0].count]]:
            axis.add_patch(
                Rectangle((x - ROOM_PX, y - ROOM_PX), 2 * ROOM_PX, 2 * ROOM_PX, fill=False, ec=FAILED, lw=0.8)
            )
        axis.autoscale_view()
    return canvas


def boxes(result: TrialResult, moment: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """The lower left and the upper right corner, px, about each flock of two or more of the first group."""
    given = fields.flocks_of(result.trial) or flocks.Parameters()
    count = result.trial.groups[0].count
    places = result.poses_w[moment, :count, :2]
    works = flocks.works_at(float(result.times[moment]), result.tables.get(FAILED_S, np.full(count, np.nan))[:count])
    found = flocks.flocks_at(places, works, given.gap_m)
    members = [places[found.labels == flock] / PIXEL_M for flock in np.flatnonzero(found.sizes > 1)]
    return [(own.min(axis=0) - ROOM_PX, own.max(axis=0) + ROOM_PX) for own in members]


def over_time(run: Run, lines: Mapping[str, Mapping[str, Any]], every: int) -> Canvas:
    """The number of flocks at one kept moment in `every`, a line a setting."""
    done = {row.index for row in run.rows() if row.status == "done"}
    drawn = []
    for label, cell in lines.items():
        kept = [
            _series(run, trial.index)
            for trial in run.trials
            if trial.index in done and cell.items() <= trial.conditions.items()
        ]
        found = [result for result in kept if result is not None]
        counts = [numbers(result, every) for result in found]
        if counts:
            drawn.append(Curve(label, found[0].times[::every].tolist(), list(np.array(counts, dtype=float).T)))
    return curves({"flocks": drawn}, "time (s)")


def numbers(result: TrialResult, every: int) -> list[int]:
    """The number of flocks of the first group at one kept moment in `every`."""
    given = fields.flocks_of(result.trial) or flocks.Parameters()
    count = result.trial.groups[0].count
    failed_s = result.tables.get(FAILED_S, np.full(count, np.nan))[:count]
    found = []
    for time, poses in zip(result.times[::every], result.poses_w[::every], strict=True):
        works = flocks.works_at(float(time), failed_s)
        found.append(len(flocks.flocks_at(poses[:count, :2], works, given.gap_m).sizes))
    return found
