"""The figures of the LCH experiment on robots: figures 4.2 and 4.3 of Fine 2015 redrawn from trials."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np

from trials.evidence.runs import Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm, panels
from trials.reports.figures import ROBOT_COLOURS, Canvas, Figure, Place
from trials.simulations.robots.measures_following import followed
from trials.studies.crowded_horizon.figures import VARIATIONS
from trials.studies.crowded_horizon.robots_claims import KEYS, LAW
from trials.types import TrialResult

SHARES = (0.0, 0.1, 0.2, 0.4, 0.6, 1.0)
"""Moments of a time series, of the trial."""
FOLLOWED_OVER_S = 1.0
"""Of a moment of following: each robot's last update within it counts."""


def figures(run: Run, folder: Path) -> list[Figure]:
    """The time series, the ways, and the two drawings of what robots do about nobody and about one."""
    return by_arm(run, folder, KEYS, _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    results = dict(panels(run, [(law, {LAW: law}) for law in VARIATIONS]))
    rows = []
    for law, result in results.items():
        length = result.times[-1] if result is not None else 0.0
        rows.append((law, [(f"{share * length:.0f} s", result, share) for share in SHARES]))
    caption = (
        "The first trial of each variation, about the herd's centre; discs are to scale. As figure 4.2 of Fine 2015."
    )
    found = [
        draw.save(draw.formations(rows), place, "time-series", "Time series", caption),
        draw.save(
            draw.trajectories(list(results.items()), columns=2),
            place,
            "trajectories",
            "Trajectories",
            "The same trials in the world: same start, same noise. A dot where each robot ends.",
        ),
    ]
    caption = (
        "Left: the ways of all robots while one of them (thick) saw nobody for the longest time; dots where they were "
        "then. Right: the moment at which most robots select one other alone (arrows). As figure 4.3 of Fine 2015."
    )
    blind, leading = (results.get(law) for law in ("lch-member-pose", "lch-group-bearing"))
    if blind is None and leading is None:
        return found
    drawing = mechanisms(blind, leading)
    return [*found, draw.save(drawing, place, "mechanisms", "Seeing nobody, following one", caption)]


def mechanisms(blind: TrialResult | None, leading: TrialResult | None) -> Canvas:
    """A robot that goes on because it sees nobody, and robots that follow one another."""
    canvas, (left, right) = draw.grid(2, 2, width=9.6, height=4.0)
    left.set_title("a member that sees nobody keeps its direction (lch-member-pose)", loc="left")
    right.set_title("follow the leader (lch-group-bearing)", loc="left")
    for axis, result, drawn in ((left, blind, _draw_blind), (right, leading, _draw_following)):
        axis.set_aspect("equal", adjustable="datalim")
        axis.set_xlabel("x (m)")
        if result is None:
            draw.absent(axis)
        else:
            drawn(axis, result)
    return canvas


def longest_blind(result: TrialResult) -> tuple[int, float, float]:
    """The robot that saw nobody for the longest time, and from when to when, s; (−1, 0, 0) if all saw always."""
    updates = result.updates
    best = (-1, 0.0, 0.0)
    for robot in range(len(result.robot_names)):
        own = np.flatnonzero(updates.robots == robot)
        own = own[np.argsort(updates.times[own], kind="stable")]
        none = np.diff(updates.input_starts)[own] == 0
        at = 0
        for blind, stretch in itertools.groupby(none.tolist()):
            count = len(list(stretch))
            first, last = updates.times[own[at]], updates.times[own[at + count - 1]]
            if blind and last - first > best[2] - best[1]:
                best = (robot, float(first), float(last))
            at += count
    return best


def most_followed(result: TrialResult) -> tuple[float, dict[int, int]]:
    """The first moment at which most robots select one other alone, s, and who follows whom."""
    updates = result.updates
    chosen, best = followed(result), (0.0, dict[int, int]())
    for time in result.times:
        recent = np.flatnonzero((updates.times <= time) & (updates.times > time - FOLLOWED_OVER_S))
        now = dict(zip(updates.robots[recent].tolist(), chosen[recent].tolist(), strict=True))
        pairs = {robot: whom for robot, whom in now.items() if whom >= 0}
        if len(pairs) > len(best[1]):
            best = (float(time), pairs)
    return best


def _draw_blind(axis: Any, result: TrialResult) -> None:
    robot, first, last = longest_blind(result)
    span = (result.times >= first) & (result.times <= last)
    if robot < 0 or not span.any():
        draw.absent(axis)
        return
    for k in range(len(result.robot_names)):
        way = result.poses_w[span, k]
        colour = ROBOT_COLOURS[k % len(ROBOT_COLOURS)]
        axis.plot(way[:, 0], way[:, 1], color=colour, lw=2.5 if k == robot else 0.8)
        _robot(axis, way[-1], result.radii[k], colour)
    axis.text(0.02, 0.98, f"{first:.1f} to {last:.1f} s", transform=axis.transAxes, va="top", fontsize=7)


def _draw_following(axis: Any, result: TrialResult) -> None:
    time, pairs = most_followed(result)
    if not pairs:
        draw.absent(axis)
        return
    poses = result.poses_w[int(np.searchsorted(result.times, time))]
    for k, pose in enumerate(poses):
        _robot(axis, pose, result.radii[k], ROBOT_COLOURS[k % len(ROBOT_COLOURS)])
    for robot, whom in pairs.items():
        axis.annotate("", poses[whom, :2], poses[robot, :2], arrowprops={"arrowstyle": "->", "lw": 0.8})
    axis.autoscale_view()
    axis.text(0.02, 0.98, f"{time:.1f} s", transform=axis.transAxes, va="top", fontsize=7)


def _robot(axis: Any, pose: Any, radius: float, colour: str) -> None:
    from matplotlib.patches import Circle

    axis.add_patch(Circle(pose[:2], radius, facecolor=colour, alpha=0.6))
    nose = pose[:2] + radius * np.array([np.cos(pose[2]), np.sin(pose[2])])
    axis.plot(*np.stack([pose[:2], nose]).T, color="black", lw=0.8)
