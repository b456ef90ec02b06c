"""What is measured in a kinematic trial of N members kept at T times: numbers, each finite or nan (nothing to measure).

A group is single linkage at the trial's `cut_m`. A mean is over the last `measured_share` of the trial.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from flocking.measures import formation, groups, hull, space
from flocking.types import Floats
from trials.simulations.kinematic.herd import Herd
from trials.types import Measure, TrialResult

MOST_MEASURED = 200
"""Moments that enter a mean over the last part of a trial, at most, evenly picked."""

ABOUT: dict[str, Measure] = {
    "polarization": Measure("", "length of the mean of the unit vectors along the headings"),
    "group_speed": Measure("m/s", "speed of the herd's centre"),
    "relative_speed": Measure("", "the same over the members' mean speed: 1 = all move alike"),
    "mmd": Measure("m", "median distance from the herd's centre"),
    "mmd_start": Measure("m", "the same at the start"),
    "mmd_end": Measure("m", "the same at the end"),
    "nearest_neighbour_distance": Measure("m", "mean over the members"),
    "groups": Measure("", "number of groups"),
    "groups_start": Measure("", "the same at the start"),
    "groups_end": Measure("", "the same at the end"),
    "largest_share": Measure("", "share of the members in the largest group"),
    "largest_share_end": Measure("", "the same at the end"),
    "split_entropy": Measure("", "how evenly the members are split into groups: 0 one group, 1 equal ones"),
    "hull_area": Measure("m2", "area of the convex hull"),
    "mixing": Measure("", "how well groups, or informed and other members, are mixed: 0 apart, 1 at random"),
    "net_displacement": Measure("m", "how far the herd's centre is from its start, at the end"),
    "directedness": Measure("", "the same over the members' mean way: 0 the centre stays, 1 all go straight on"),
    "distance_travelled": Measure("m", "way of a member, mean over the herd"),
    "goal_alignment": Measure("", "cosine between the way of the herd's centre and the direction of the goal"),
}
"""Every measure, in the order in which they are shown."""
KEY_MEASURES = ("polarization", "relative_speed", "mmd", "groups", "largest_share", "net_displacement")
"""Those that a first look at a run needs."""


def measure(result: TrialResult, herd: Herd) -> dict[str, float]:
    """The measures of one trial, by the names of `ABOUT`. Reads no `result.measures`."""
    if not np.isfinite(result.poses_w).all():
        return dict.fromkeys(ABOUT, math.nan)
    period = herd.space.size_m if herd.space.kind == "periodic" else None
    positions, cut = result.poses_w[..., :2], herd.fields.cut_m
    first = min(len(positions) - 1, math.floor((1.0 - herd.fields.measured_share) * (len(positions) - 1)))
    picked = np.unique(np.linspace(first, len(positions) - 1, MOST_MEASURED).round().astype(np.int64))
    late = positions[picked]
    labels = groups.group_labels(late, cut, period)
    sizes = groups.group_sizes(labels)
    start = groups.group_sizes(groups.group_labels(positions[0], cut, period))
    speeds = _speeds(result, positions, first, period)
    found: dict[str, Any] = {
        "polarization": formation.polarization(result.poses_w[picked, :, 2]).mean(),
        "group_speed": speeds[0],
        "relative_speed": speeds[0] / speeds[1] if speeds[1] > 0.0 else math.nan,
        "mmd": formation.mmd(late, period).mean(),
        "mmd_start": formation.mmd(positions[0], period),
        "mmd_end": formation.mmd(positions[-1], period),
        "nearest_neighbour_distance": formation.nearest_neighbour_distance(late, period).mean(),
        "groups": (sizes > 0).sum(axis=-1).mean(),
        "groups_start": (start > 0).sum(),
        "groups_end": (sizes[-1] > 0).sum(),
        "largest_share": (sizes.max(axis=-1) / late.shape[1]).mean(),
        "largest_share_end": sizes[-1].max() / late.shape[1],
        "split_entropy": groups.share_entropy(sizes).mean(),
        "hull_area": hull.convex_hull(late[-1], period).area,
        "mixing": groups.mixing(late[-1], herd.kinds, k=1, period_m=period),
        "net_displacement": formation.net_displacement(positions, period)[-1],
        "directedness": formation.directedness(positions, period),
        "distance_travelled": formation.path_length(positions, period).mean(),
        "goal_alignment": _alignment(positions, first, herd, period),
    }
    return {name: float(found[name]) for name in ABOUT}


def _speeds(result: TrialResult, positions: Floats, first: int, period: float | None) -> tuple[float, float]:
    """Mean speed of the centre and mean speed of the members, m/s, over the last part."""
    times = result.times[first:]
    if len(times) < 2:
        return math.nan, math.nan
    way = space.unwrapped(positions[first:], period)
    velocities = np.diff(way, axis=0) / np.diff(times)[:, None, None]
    each = np.hypot(velocities[..., 0], velocities[..., 1])
    return float(formation.group_speed(velocities).mean()), float(each.mean())


def _alignment(positions: Floats, first: int, herd: Herd, period: float | None) -> float:
    """Of the centre's way over the last part with the direction from its beginning to the informed members' goal."""
    goals = np.concatenate([band.goals_w for band in herd.bands if band.goals_w is not None])
    goals = goals[np.isfinite(goals).all(axis=1)]
    if len(goals) == 0:
        return math.nan
    centres = space.unwrapped(positions[first:], period).mean(axis=1)
    x, y = centres[-1] - centres[0]
    to_x, to_y = goals.mean(axis=0) - centres[0]
    lengths = math.hypot(x, y) * math.hypot(to_x, to_y)
    return (x * to_x + y * to_y) / lengths if lengths > 0.0 else math.nan
