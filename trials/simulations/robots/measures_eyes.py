"""What is measured of a trial in which a body carries cameras: estimates beside the truth, and who ends where."""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial.distance import cdist

from flocking.angles import wrapped
from flocking.measures import formation
from flocking.types import Floats
from robots import body as bodies
from trials.simulations.robots.fields import of_group
from trials.simulations.robots.resolved import Resolved
from trials.simulations.robots.seen import exact_inputs
from trials.types import Measure, Trial, TrialResult

FLOCK_CUT_M = 4 * 0.3048
"""Robots farther apart belong to different flocks: Kirchner 2006, section 3.3, 48 pixels of its simulation and the 104
of the collapsed safety bubble, 38.1 to a foot."""

LEAD = "lead"

ABOUT: dict[str, Measure] = {
    "bearing_error": Measure("rad", "of an input: how far its bearing is from the true one, of a cone in images, mean"),
    "distance_error": Measure("", "of an input: amount by which its distance errs, of the true one, mean"),
    "distance_bias": Measure("", "the same with its sign: above 0, estimates are too long"),
    "flocks": Measure("", "number of flocks at the end (single linkage, 4 feet)"),
    "one_flock_share": Measure("", "share of the second half in which all robots are one flock"),
    "final_distance": Measure(
        "m", "from the lead robot (of a group `lead`, or the first) to the others at the end, mean"
    ),
    "final_distance_least": Measure("m", "the same, the least"),
    "final_distance_most": Measure("m", "the same, the greatest"),
    "final_distance_counted": Measure(
        "m", "the mean final distance by the robots' odometry from where they were put down"
    ),
    "unseen_share": Measure(
        "", "of the updates of robots that see by images, all but the lead's: share without an input"
    ),
    "closest": Measure("m", "the least distance between two robots' centres in the trial"),
}


def has_eyes(trial: Trial) -> bool:
    """Whether any body of a trial carries cameras."""
    return any("cameras" in bodies.load(of_group(group).body).mounts for group in trial.groups)


def eyes(result: TrialResult) -> dict[str, float]:
    """The measures of `ABOUT`."""
    found = dict.fromkeys(ABOUT, math.nan) | _estimates(result) | _unseen(result)
    poses = result.poses_w
    if len(poses) == 0 or not np.isfinite(poses).all():
        return found
    positions = poses[..., :2]
    late = result.times >= result.times[-1] / 2.0
    flocks = formation.number_of_groups(positions[late], FLOCK_CUT_M)
    found |= {"flocks": float(flocks[-1]), "one_flock_share": float(np.mean(flocks == 1))}
    if positions.shape[1] > 1:
        of = lead(result)
        away = _away(positions[-1], of)
        counted = result.odometry[-1] if len(result.odometry) else np.full_like(poses[-1], math.nan)
        found |= {
            "final_distance": float(away.mean()),
            "final_distance_counted": float(_away(_placed(poses[0], counted), of).mean()),
            "final_distance_least": float(away.min()),
            "final_distance_most": float(away.max()),
            "closest": min(_closest(each) for each in positions),
        }
    return found


def _away(places: Floats, of: int) -> Floats:
    """(N − 1,) how far the others are from the robot of that index, m."""
    return np.asarray(np.hypot(*(np.delete(places, of, axis=0) - places[of]).T))


def _placed(starts: Floats, counted: Floats) -> Floats:
    """(N, 2) where robots are that were put down at `starts` (N, 3), by what their odometry has counted (N, 3)."""
    c, s = np.cos(starts[:, 2]), np.sin(starts[:, 2])
    x, y = counted[:, 0], counted[:, 1]
    return starts[:, :2] + np.stack([c * x - s * y, s * x + c * y], axis=1)


def _unseen(result: TrialResult) -> dict[str, float]:
    """The share of updates without an input."""
    groups = [group for group in result.trial.groups for _ in range(group.count)]
    sees = np.array([Resolved(group).reads_images and group.name != LEAD for group in groups])
    mine = sees[result.updates.robots] if len(result.updates.robots) else np.zeros(0, np.bool_)
    if not mine.any():
        return {}
    return {"unseen_share": float(np.mean(np.diff(result.updates.input_starts)[mine] == 0))}


def lead(result: TrialResult) -> int:
    """The robot that leads: the first of the group `lead`, or of all."""
    return next((k for k, name in enumerate(result.robot_names) if name.startswith(f"{LEAD}-")), 0)


def _closest(places: Floats) -> float:
    apart = cdist(places, places)
    np.fill_diagonal(apart, np.inf)
    return float(apart.min())


def _estimates(result: TrialResult) -> dict[str, float]:
    updates = result.updates
    counts = np.diff(updates.input_starts)
    owned = updates.input_owners >= 0
    if not owned.any():
        return {}
    of_update = np.repeat(np.arange(len(counts)), counts)[owned]
    owners, inputs = updates.input_owners[owned].astype(np.int64), updates.input_positions[owned].astype(np.float64)
    exact = exact_inputs(result, updates.times, updates.robots, updates.poses_w)[of_update, owners]
    errors = wrapped(np.arctan2(inputs[:, 1], inputs[:, 0]) - np.arctan2(exact[:, 1], exact[:, 0]))
    away = np.maximum(np.hypot(exact[:, 0], exact[:, 1]), 1e-3)
    relative = np.hypot(inputs[:, 0], inputs[:, 1]) / away - 1.0
    sound = np.isfinite(errors) & np.isfinite(relative)
    if not sound.any():
        return {}
    return {
        "bearing_error": float(np.abs(errors[sound]).mean()),
        "distance_error": float(np.abs(relative[sound]).mean()),
        "distance_bias": float(relative[sound].mean()),
    }
