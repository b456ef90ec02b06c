"""Moments of guided trials as small maps (figures 8.6 to 8.10 of Fine 2015)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from flocking.types import Floats
from generation.piloting import task as tasks
from trials.evidence import statistics
from trials.reports import figures as draw
from trials.simulations.robots import guided
from trials.types import TrialResult

GUIDED, GUIDING, WALL = "#009e73", "#d55e00", "#f0c000"
START, GOAL = "#0072b2", "#9ad7a5"


def named(task: str) -> str:
    """What a task is called in figures and in their files' names: that of a user's own file without its folder."""
    return Path(task).stem if tasks.is_file(task) else task


def snapshots(rows: Sequence[tuple[str, TrialResult]], moments: int) -> Any:
    """A canvas with a row of moments for each of the results, at equal times from the start on."""
    canvas, axes = draw.grid(len(rows) * moments, moments, width=2.2 * moments, height=2.5)
    for line, (label, result) in enumerate(rows):
        times = np.linspace(0.0, _last(result), moments)
        for k, time in enumerate(times):
            axis = axes[line * moments + k]
            moment(axis, result, time)
            axis.set_title(f"{label}, {time:.0f} s" if k == 0 else f"{time:.0f} s", loc="left", fontsize=7)
    return canvas


def whole(axis: Any, result: TrialResult) -> None:
    """Draws a whole trial as figure 8.6 does: all ways in black, robots where they end, and all walls of the plan."""
    found = guided.task_of(result.trial)
    for wall in result.walls_w:
        axis.plot(wall[[0, 2]], wall[[1, 3]], color="#888888", lw=0.6)
    for each in guided.plan_of(result.trial).walls:
        segment = each.segment(found)
        axis.plot(segment[::2], segment[1::2], color=WALL, lw=2.0, zorder=3)
    now = int(np.searchsorted(result.times, _last(result)).clip(0, len(result.times) - 1))
    for pilots, colour in ((False, GUIDED), (True, GUIDING)):
        ways = result.poses_w[: now + 1, guided.members(result.trial, pilots), :2]
        axis.plot(ways[..., 0], ways[..., 1], color="black", lw=0.4)
        axis.plot(*ways[-1].T, "o", color=colour, ms=3.5, mew=0.0, zorder=4)
    axis.plot(*found.trajectory.T, ":", color="black", lw=1.2)
    axis.plot([found.start.x_m], [found.start.y_m], "o", color=START, ms=7.0, mew=0.0)
    axis.plot(*found.goal.mean(axis=0), "o", color=GOAL, ms=7.0, mew=0.0)
    axis.set_aspect("equal")
    axis.set_xticks([])
    axis.set_yticks([])


def moment(axis: Any, result: TrialResult, time: float) -> None:
    """Draws where all robots and walls are at a time, s, and the herd's ways so far."""
    found = guided.task_of(result.trial)
    axis.plot(*found.trajectory.T, ":", color="black", lw=0.8)
    axis.fill(*found.goal.T, color="#009e73", alpha=0.15, lw=0.0)
    for began, ended, *segment in result.tables["standing"]:
        if began <= time and not ended <= time:
            axis.plot(segment[::2], segment[1::2], color=WALL, lw=2.0)
    for segment in held(result, time):
        axis.plot(segment[::2], segment[1::2], color=WALL, lw=1.2)
    robots_and_ways(axis, result, time)


def held(result: TrialResult, time: float) -> Floats:
    """(K, 4) the walls that pilots hold at a time, or are on their way to, m; none where walls stand themselves."""
    sent = result.tables.get("sent", np.empty((0, 5)))
    last = {int(robot): int(wall) for began, robot, wall, *_ in sent if began <= time}
    task, plan = guided.task_of(result.trial), guided.plan_of(result.trial)
    return np.array([plan.walls[wall].segment(task) for wall in sorted(set(last.values()))]).reshape(-1, 4)


def mean(axis: Any, x: float, values: Floats, colour: str) -> None:
    """Draws the mean of values (N,) at x with its 95 % interval; nothing for fewer than two."""
    if len(values) > 1:
        found = statistics.exceeds(values, 0.0)
        reach = [[values.mean() - found.low], [found.high - values.mean()]]
        axis.errorbar([x], [values.mean()], reach, fmt="o", color=colour, ms=4)


def robots_and_ways(axis: Any, result: TrialResult, time: float) -> None:
    """Draws the world, where all robots are at a time, s, and their ways so far."""
    for wall in result.walls_w:
        axis.plot(wall[[0, 2]], wall[[1, 3]], color="#888888", lw=0.6)
    now = int(np.searchsorted(result.times, time).clip(0, len(result.times) - 1))
    for pilots, colour in ((False, GUIDED), (True, GUIDING)):
        members = guided.members(result.trial, pilots)
        ways = result.poses_w[: now + 1, members, :2]
        axis.plot(ways[..., 0], ways[..., 1], color=colour, lw=0.4, alpha=0.6)
        axis.plot(*ways[-1].T, "o", color=colour, ms=2.6, mew=0.0)
    axis.set_aspect("equal")
    axis.set_xticks([])
    axis.set_yticks([])


def _last(result: TrialResult) -> float:
    """When the last stage had begun and the herd had its time to arrive, s; the trial's end at the latest."""
    stages = result.tables["stages"]
    left = 30.0
    return float(min(result.times[-1], stages[-1, 0] + left)) if len(stages) else float(result.times[-1])
