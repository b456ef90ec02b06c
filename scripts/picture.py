"""Draws the picture at the top of the README: six robots in the corridor, from a trial that the script runs.

    python -m scripts.picture [--out docs/herd.png] [--trial 43] [--at TIME]

It shows one moment: robots with their headings and the path behind them, the latest scan of each coloured by
intensity, the inputs that one focal member got from its detection, its way-point, and the rule that chose it.
Without --at, the moment is chosen: all robots near one another, many of them detected, a HA way-point.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flocking.types import Floats, Kind
from trials.simulations.columns import in_world, member_colours
from trials.simulations.robots.recorded_senses import INTENSITY_PALETTE, intensity_levels, scan_points
from trials.types import Scans, TrialResult

BACKGROUND, WALL, TEXT = "#0e1117", "#6e7b8b", "#d7dde4"
TRAIL_S = 12.0
WIDTH = 2.0
"""No robot farther than this from the herd's centre along or across, m, where such a moment exists."""
INPUT_COLOUR, WAY_POINT_COLOUR = "#ffffff", "#ffb000"


def main() -> None:
    """Runs the trial and writes the picture."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path("docs/herd.png"))
    parser.add_argument("--trial", type=int, default=43, help="of detection-case-study, from 1")
    parser.add_argument("--at", type=float, default=None, metavar="TIME", help="s")
    given = parser.parse_args()

    from trials.design import plan
    from trials.simulations.robots.loop import run_trial

    trial = plan("detection-case-study").trials[given.trial - 1]
    result = run_trial(trial, scans="all")
    focal, time = moment(result) if given.at is None else (_nearest_focal(result, given.at), given.at)
    draw(result, focal, time, given.out)
    print(f"{given.out}: trial {trial.index}, {time:.1f} s, focal member {result.robot_names[focal]}")


def moment(result: TrialResult) -> tuple[int, float]:
    """The focal member and the time (s) to show: a HA way-point, many members detected, all near and moving."""
    updates = result.updates
    sample = np.clip(np.searchsorted(result.times, updates.times) - 1, 0, len(result.times) - 1)
    positions = result.poses_w[sample, :, :2]
    width = np.abs(positions - positions.mean(axis=1, keepdims=True)).max(axis=(1, 2))
    detected = (updates.member_states == 1).sum(axis=1)
    rules = np.array([result.rules[k][rule] for k, rule in zip(updates.robots, updates.rules, strict=True)])
    before = np.maximum(sample - round(TRAIL_S / float(result.times[1] - result.times[0])), 0)
    moved = np.hypot(*(positions - result.poses_w[before, :, :2]).mean(axis=1).T)
    score = detected + 2.0 * moved + 2.0 * (rules == "hamilton")
    score -= 50.0 * (width > WIDTH) + 100.0 * (updates.times < TRAIL_S)
    best = int(np.argmax(np.where(updates.kinds == Kind.WAY_POINT, score, -np.inf)))
    return int(updates.robots[best]), float(updates.times[best])


def draw(result: TrialResult, focal: int, time: float, path: Path) -> None:
    """Writes a picture of the herd from above at a time (s)."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    sample = int(np.argmin(np.abs(result.times - time)))
    poses = result.poses_w[sample]
    middle = poses[:, :2].mean(axis=0)
    half = float(np.clip(np.abs(poses[:, 0] - middle[0]).max() + 0.9, 2.6, 5.0))
    low, high = _floor(result, middle)
    figure, axes = plt.subplots(figsize=(10.0, 10.0 * (high - low) / (2.0 * half) + 0.35), facecolor=BACKGROUND)
    axes.set_facecolor(BACKGROUND)
    for x0, y0, x1, y1 in result.walls_w:
        axes.plot([x0, x1], [y0, y1], color=WALL, linewidth=3.0, solid_capstyle="butt", zorder=2)
    colours = _hex(member_colours(len(result.robot_names)))
    if result.scans is not None:
        _draw_scans(axes, result.scans, focal, time, len(result.robot_names))
    for k, colour in enumerate(colours):
        _draw_robot(axes, result, k, sample, colour)
    words = _draw_decision(axes, result, focal, time)
    axes.set_xlim(middle[0] - half, middle[0] + half)
    axes.set_ylim(low, high)
    axes.set_aspect("equal")
    axes.axis("off")
    name = result.robot_names[focal]
    x, y = poses[focal, :2]
    axes.text(x, y + float(result.radii[focal]) + 0.05, name, color=TEXT, ha="center", fontsize=9, zorder=11)
    pipeline = result.trial.groups[0].pipeline
    caption = f"{time:.1f} s, {pipeline} detection. White: what {name} detects; arrow: its way-point ({words})"
    figure.text(0.02, 0.02, caption, color=TEXT, fontsize=10)
    figure.subplots_adjust(0.0, 0.06, 1.0, 1.0)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=120, facecolor=BACKGROUND)
    plt.close(figure)


def _draw_scans(axes: Any, scans: Scans, focal: int, time: float, robots: int) -> None:
    """The latest scan of each robot; that of the focal member with its beams."""
    directions = np.stack([np.cos(scans.angles), np.sin(scans.angles)]).astype(np.float32)
    for k in range(robots):
        before = np.flatnonzero((scans.robots == k) & (scans.times <= time + 1e-9))
        if len(before) == 0:
            continue
        row = before[-1:]
        ranges, poses = scans.ranges[row], scans.poses_w[row]
        hit = np.isfinite(ranges[0])
        points = scan_points(ranges, poses, directions)[0, hit]
        shades = _hex(INTENSITY_PALETTE[intensity_levels(scans.intensities[row])[0, hit]])
        if k == focal:
            beams = np.stack([np.broadcast_to(poses[0, :2], points.shape), points], axis=1)
            from matplotlib.collections import LineCollection

            axes.add_collection(LineCollection(list(beams), colors="#9fd3ff", linewidths=0.35, alpha=0.16, zorder=1))
        axes.scatter(points[:, 0], points[:, 1], s=7 if k == focal else 3, c=shades, linewidths=0, zorder=3)


def _draw_robot(axes: Any, result: TrialResult, k: int, sample: int, colour: str) -> None:
    from matplotlib.collections import LineCollection
    from matplotlib.patches import Circle

    x, y, heading = result.poses_w[sample, k]
    radius = float(result.radii[k])
    since = np.searchsorted(result.times, result.times[sample] - TRAIL_S)
    way = result.poses_w[since : sample + 1, k, :2]
    if len(way) > 1:
        pieces = np.stack([way[:-1], way[1:]], axis=1)
        fade = np.linspace(0.0, 0.9, len(pieces))
        axes.add_collection(LineCollection(list(pieces), colors=colour, linewidths=2.2, alpha=fade, zorder=4))
    axes.add_patch(Circle((x, y), radius, facecolor=colour, edgecolor="#0e1117", linewidth=1.2, zorder=6))
    nose = np.array([[x, y], [x + radius * np.cos(heading), y + radius * np.sin(heading)]])
    axes.plot(nose[:, 0], nose[:, 1], color=BACKGROUND, linewidth=3.0, solid_capstyle="round", zorder=7)


def _draw_decision(axes: Any, result: TrialResult, focal: int, time: float) -> str:
    """Draws inputs and way-point of the focal member's latest update; returns its rule in words."""
    updates = result.updates
    mine = np.flatnonzero((updates.robots == focal) & (updates.times <= time + 1e-9))
    if len(mine) == 0:
        return "no update yet"
    u = int(mine[-1])
    pose = updates.poses_w[u : u + 1]
    inputs = updates.input_positions[updates.input_starts[u] : updates.input_starts[u + 1]]
    inputs_w = in_world(inputs, np.repeat(pose, len(inputs), axis=0))
    few = len(inputs) <= 12
    axes.scatter(
        inputs_w[:, 0],
        inputs_w[:, 1],
        s=90 if few else 9,
        facecolors="none",
        edgecolors=INPUT_COLOUR,
        linewidths=1.5 if few else 0.8,
        zorder=9,
    )
    if updates.kinds[u] == Kind.WAY_POINT:
        aim = in_world(updates.motions[u : u + 1], pose)[0]
        axes.annotate(
            "",
            xy=(aim[0], aim[1]),
            xytext=(pose[0, 0], pose[0, 1]),
            arrowprops={"arrowstyle": "-|>", "color": WAY_POINT_COLOUR, "linewidth": 2.0, "mutation_scale": 16},
            zorder=10,
        )
    return f"rule: {result.rules[focal][updates.rules[u]]}"


def _floor(result: TrialResult, middle: Floats) -> tuple[float, float]:
    """Lower and upper edge of the picture, m: just outside the walls beside the herd, or the herd itself."""
    ys = result.walls_w[:, [1, 3]].ravel() if len(result.walls_w) else np.array([])
    below, above = ys[ys < middle[1]], ys[ys > middle[1]]
    low = float(below.max()) if len(below) else float(middle[1]) - 1.5
    high = float(above.min()) if len(above) else float(middle[1]) + 1.5
    return max(low, float(middle[1]) - 3.0) - 0.15, min(high, float(middle[1]) + 3.0) + 0.15


def _nearest_focal(result: TrialResult, time: float) -> int:
    """The robot nearest to the herd's centre at a time (s)."""
    poses = result.poses_w[int(np.argmin(np.abs(result.times - time)))]
    return int(np.argmin(np.hypot(*(poses[:, :2] - poses[:, :2].mean(axis=0)).T)))


def _hex(colours: NDArray[np.uint32]) -> list[str]:
    return [f"#{colour:08x}" for colour in colours.tolist()]


if __name__ == "__main__":
    main()
