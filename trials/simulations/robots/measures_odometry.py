"""How well robots that reckon by their odometry know where they are: what it says at the end beside the truth."""

from __future__ import annotations

import math

import numpy as np

from trials.types import Measure, TrialResult

ABOUT = {
    "counted_way": Measure("m", "from a robot's start to where its odometry puts it at the end, mean over the herd"),
    "true_way": Measure("m", "from a robot's start to where it is at the end, mean over the herd"),
    "counted_turn": Measure("rad", "by how much a robot has turned by its odometry, mean over the herd"),
    "true_turn": Measure("rad", "by how much a robot has turned, mean over the herd"),
    "moved_ahead": Measure(
        "m", "where a robot is at the end, along the way that it faced at first, mean over the herd"
    ),
    "moved_aside": Measure("m", "likewise, to the left of that way"),
    "lost": Measure("m", "how far a robot is from where its odometry puts it at the end, mean over the herd"),
}
"""Of trials with robots whose `own_motion` is their odometry."""


def reckoned(result: TrialResult) -> dict[str, float]:
    """The measures of this file; nan of a trial that was not sampled to its end."""
    if len(result.times) == 0 or not np.isfinite(result.poses_w[[0, -1]]).all():
        return dict.fromkeys(ABOUT, math.nan)
    start, end = result.poses_w[0], result.poses_w[-1]
    counted = result.odometry[-1] - result.odometry[0]
    c, s = np.cos(start[:, 2]), np.sin(start[:, 2])
    x, y = (end - start)[:, :2].T
    moved = np.column_stack([c * x + s * y, c * y - s * x])
    return {
        "counted_way": float(np.hypot(*counted[:, :2].T).mean()),
        "true_way": float(np.hypot(*moved.T).mean()),
        "counted_turn": float(counted[:, 2].mean()),
        "true_turn": float((end - start)[:, 2].mean()),
        "moved_ahead": float(moved[:, 0].mean()),
        "moved_aside": float(moved[:, 1].mean()),
        "lost": float(np.hypot(*(moved - counted[:, :2]).T).mean()),
    }
