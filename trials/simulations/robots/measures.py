"""What is measured in one trial: numbers, each finite or nan (nan = there was nothing to measure it on).

Source of what is measured: Fine 2015, sections 2.4 and 2.5 (inputs, behaviour, smoothness, false negatives
and positives); the choices that it leaves open are named below and in docs/detection.md.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from flocking.measures import formation
from flocking.measures.groups import largest_share
from flocking.types import Bools, Floats, Ints, Kind
from sensing.truth import DETECTED, MISSED
from trials.simulations.robots.measures_following import following
from trials.types import Measure, TrialResult, Updates

NEAREST_BOUND = math.radians(15.0)
"""A way-point within this angle of the nearest input points at it. Choice (grade D): a Create's half-width,
0.165 m, seen from the repulsion distance, 0.66 m, the nearest at which a way-point towards a neighbour is
computed, is 14.5 degrees: within the bound, a robot heads for its neighbour's body. The shares are also given
at half and twice."""

GROUP_CUT_M = 1.32
"""Members farther apart belong to different groups (single linkage). Choice: twice the repulsion distance of
two body-lengths, so that one member missing from a chain does not break it."""

UPDATES_AT_ONCE = 16384
"""Updates whose inputs are taken together, so that a long trial takes no more memory than a short one."""

ABOUT: dict[str, Measure] = {
    "none_share": Measure("", "share of updates in which no input was let through to the law (last command kept)"),
    "snn_share": Measure("", "share of updates in which the SNN branch was computed"),
    "ha_share": Measure("", "share of updates in which the HA way-point was computed"),
    "perpendicular_share": Measure("", "share of updates in which the perpendicular way-point was computed"),
    "stop_share": Measure("", "share of updates that said stand still (SNN within the repulsion distance)"),
    "computed_snn_share": Measure("", "SNN branch among updates in the SNN or HA branch"),
    "ha_at_nearest_share": Measure("", "of the HA way-points: share that points at the nearest input (15 degrees)"),
    "ha_angle": Measure("rad", "mean angle between the HA way-point and the nearest input"),
    "effective_snn_share": Measure(
        "", "of the approaches (SNN or HA way-points): share that points at the nearest input (15 degrees)"
    ),
    "effective_snn_share_tight": Measure("", "the same with half the bound (7.5 degrees)"),
    "effective_snn_share_wide": Measure("", "the same with twice the bound (30 degrees)"),
    "effective_snn_share_late": Measure("", "effective_snn_share over the second half of the trial"),
    "effective_ha_share": Measure("", "of the approaches: share that points elsewhere; 1 - effective_snn_share"),
    "acts_as_snn_share": Measure(
        "", "of the updates with inputs: share that does what SNN would: heads for the nearest, or rests beside it"
    ),
    "acts_as_snn_share_late": Measure("", "acts_as_snn_share over the second half of the trial"),
    "reverted_share": Measure("", "of the updates with inputs: share in which the SNN branch was computed"),
    "smoothness": Measure(
        "m2", "variance of the chosen way-point about its drift, in the world; larger is less smooth"
    ),
    "smoothness_approach": Measure("m2", "the same of SNN and HA way-points only, without the perpendicular ones"),
    "way_point_variance": Measure("m2", "variance of the chosen way-point over the trial, body frame"),
    "way_point_bearing_variance": Measure("", "circular variance of the way-point's bearing, body frame"),
    "fn_share": Measure("", "false negatives: share of the visible members that were missed, per update"),
    "fn_beam_share": Measure("", "share of the beams on members that made no input"),
    "fp_update_share": Measure("", "false positives: share of updates with an input that belongs to nobody"),
    "fp_input_share": Measure("", "share of the inputs that belong to nobody"),
    "fp_beam_share": Measure("", "share of the beams behind inputs that belong to nobody"),
    "inputs_per_update": Measure("", "mean number of inputs that the selection let through to the law"),
    "members_per_update": Measure("", "mean number of members detected"),
    "one_member_share": Measure("", "share of updates with exactly one member detected"),
    "seen_distance_q25": Measure("m", "distance to the inputs, each member seen counting once: lower quartile"),
    "seen_distance_q50": Measure("m", "the same: median"),
    "seen_distance_q75": Measure("m", "the same: upper quartile"),
    "polarization": Measure("", "of the headings, mean over the second half"),
    "group_speed": Measure("m/s", "speed of the herd's centre, mean over the second half"),
    "mmd": Measure("m", "median distance from the herd's centre, mean over the second half"),
    "nearest_neighbour_distance": Measure("m", "mean over members and the second half"),
    "groups": Measure("", "number of groups (single linkage, 1.32 m), mean over the second half"),
    "straightness": Measure("", "1 = the herd stands on one line, mean over the second half"),
    "member_collisions": Measure("", "touches between two members"),
    "wall_collisions": Measure("", "touches of a wall"),
    "distance_travelled": Measure("m", "way of a robot, mean over the herd"),
    "largest_share": Measure("", "share of the robots in the largest group (1.32 m), mean over the second half"),
    "net_displacement": Measure("m", "how far the herd's centre is from its start, at the end"),
    "follow_share": Measure("", "of the way-points: share that is made from the inputs of one member alone"),
    "blind_turn_rad_s": Measure("rad/s", "turn rate of robots that have seen nobody for half a second, mean"),
}
"""Every measure, in the order in which they are shown."""
KEY_MEASURES = (
    "acts_as_snn_share",
    "reverted_share",
    "effective_ha_share",
    "straightness",
    "smoothness",
    "fn_share",
    "fp_update_share",
    "mmd",
)
"""The measures that a first look at a run needs."""
HEADINGS = {
    "acts_as_snn_share": "acts\nas SNN",
    "reverted_share": "computes\nSNN",
    "straightness": "straight",
    "smoothness": "smoothness\nm2",
    "fn_share": "false\nneg.",
    "fp_update_share": "false\npos.",
}
"""The measures that fit on a terminal, and the headings of their columns."""

LATE = (
    "polarization",
    "group_speed",
    "mmd",
    "nearest_neighbour_distance",
    "groups",
    "straightness",
    "largest_share",
)
"""Measures of the formation, each a mean over the second half of the trial."""


def measure(result: TrialResult) -> dict[str, float]:
    """The measures of one trial, by the names of `ABOUT`. `result.measures` is not read.

    Inputs are those that the neighbour selection let through to the law; members are those that were detected.
    """
    result = dataclasses.replace(result, updates=result.updates.as_selected())
    found = {
        **_behaviour(result),
        **_smoothness(result),
        **_detection(result.updates, len(result.robot_names)),
        **_formation(result),
        **following(result),
    }
    return {name: float(found[name]) for name in ABOUT}


def way_point_angles(updates: Updates) -> Floats:
    """(U,) angle between the way-point and the nearest input, rad in [0, π]; nan without way-point or
    input."""
    nearest = nearest_inputs(updates)
    x, y = updates.motions[:, 0], updates.motions[:, 1]
    crossed = nearest[:, 0] * y - nearest[:, 1] * x
    along = nearest[:, 0] * x + nearest[:, 1] * y
    return np.where(updates.kinds == Kind.WAY_POINT, np.abs(np.arctan2(crossed, along)), np.nan)


def nearest_inputs(updates: Updates) -> Floats:
    """(U, 2) the input nearest to the focal member at each update, m, body frame; nan where there is none."""
    nearest, rows = np.full((len(updates.times), 2), np.nan), nearest_rows(updates)
    nearest[rows >= 0] = updates.input_positions[rows[rows >= 0]]
    return nearest


def nearest_rows(updates: Updates) -> Ints:
    """(U,) which row of the inputs that is; −1 where there is none."""
    nearest = np.full(len(updates.times), -1, np.int64)
    for updates_now, inputs_now in _pieces(updates):
        counts = np.diff(updates.input_starts[updates_now.start : updates_now.stop + 1])
        some = np.flatnonzero(counts)
        if len(some) == 0:
            continue
        positions = updates.input_positions[inputs_now].astype(np.float64)
        squared = np.einsum("ki,ki->k", positions, positions)
        starts = updates.input_starts[updates_now][some] - inputs_now.start
        least = np.minimum.reduceat(squared, starts)
        candidates = np.flatnonzero(squared == np.repeat(least, counts[some]))
        nearest[updates_now][some] = inputs_now.start + candidates[np.searchsorted(candidates, starts)]
    return nearest


def _pieces(updates: Updates) -> Iterator[tuple[slice, slice]]:
    """The rows of updates and of their inputs, piece by piece."""
    for first in range(0, len(updates.times), UPDATES_AT_ONCE):
        last = min(first + UPDATES_AT_ONCE, len(updates.times))
        yield slice(first, last), slice(int(updates.input_starts[first]), int(updates.input_starts[last]))


def rule_is(result: TrialResult, name: str) -> Bools:
    """(U,) true where the rule of that name spoke; false for laws that have no such rule."""
    updates = result.updates
    codes = np.array([rules.index(name) if name in rules else -1 for rules in result.rules], dtype=np.int64)
    return updates.rules == codes[updates.robots]


def _speechless(result: TrialResult, name: str) -> Bools:
    """(U,) true for updates of laws that have no rule of that name."""
    has = np.array([name in rules for rules in result.rules], dtype=np.bool_)
    return ~has[result.updates.robots]


def _selected(updates: Updates) -> Ints:
    """(U,) how many inputs were selected for the law."""
    before = np.concatenate([[0], np.cumsum(updates.input_selected)])
    found: Ints = before[updates.input_starts[1:]] - before[updates.input_starts[:-1]]
    return found


def _behaviour(result: TrialResult) -> dict[str, Any]:
    updates = result.updates
    none, snn, hamilton, perpendicular = (
        rule_is(result, name) for name in ("none", "snn", "hamilton", "perpendicular")
    )
    none |= _speechless(result, "none") & (_selected(updates) == 0)
    stop = updates.kinds == Kind.STOP
    approach = (snn | hamilton) & (updates.kinds == Kind.WAY_POINT)
    with_inputs = np.diff(updates.input_starts) > 0
    angles = way_point_angles(updates)
    at_nearest = angles <= NEAREST_BOUND  # nan compares false
    late = updates.times >= _half(result)
    effective_snn = _share(at_nearest, approach)
    acts_as_snn = (at_nearest & approach) | (stop & snn)
    return {
        "none_share": _share(none),
        "snn_share": _share(snn),
        "ha_share": _share(hamilton),
        "perpendicular_share": _share(perpendicular),
        "stop_share": _share(stop),
        "computed_snn_share": _share(snn, snn | hamilton),
        "ha_at_nearest_share": _share(at_nearest, hamilton),
        "ha_angle": _mean(angles[hamilton & np.isfinite(angles)]),
        "effective_snn_share": effective_snn,
        "effective_snn_share_tight": _share(angles <= NEAREST_BOUND / 2.0, approach),
        "effective_snn_share_wide": _share(angles <= NEAREST_BOUND * 2.0, approach),
        "effective_snn_share_late": _share(at_nearest, approach & late),
        "effective_ha_share": 1.0 - effective_snn,
        "acts_as_snn_share": _share(acts_as_snn, with_inputs),
        "acts_as_snn_share_late": _share(acts_as_snn, with_inputs & late),
        "reverted_share": _share(snn, with_inputs),
    }


def _smoothness(result: TrialResult) -> dict[str, Any]:
    """Variances of the chosen way-point, each per robot, then averaged over the robots that have one.

    `smoothness` is half the mean square of the change from one way-point to the next (von Neumann et al.
    1941): the variance of the choice about its slow drift, in the world, so that neither the robot's own
    motion nor the approach to a neighbour counts as jitter. Only directly successive updates with way-points
    count. `way_point_variance` is the plain total variance (trace of the covariance) in the body frame.
    """
    updates, robots = result.updates, len(result.robot_names)
    order = np.lexsort((updates.times, updates.robots))
    approach = ~rule_is(result, "perpendicular")[order]
    who, motions = updates.robots[order], updates.motions[order]
    x, y, heading = updates.poses_w[order].T
    chosen = (updates.kinds[order] == Kind.WAY_POINT) & np.isfinite(motions).all(axis=1)
    c, s = np.cos(heading), np.sin(heading)
    x_w = x + c * motions[:, 0] - s * motions[:, 1]
    y_w = y + s * motions[:, 0] + c * motions[:, 1]
    pair = chosen[1:] & chosen[:-1] & (who[1:] == who[:-1])
    squared = np.diff(x_w) ** 2 + np.diff(y_w) ** 2
    jitter = _by_robot(squared[pair], who[1:][pair], robots) / 2.0
    pair &= approach[1:] & approach[:-1]
    approach_jitter = _by_robot(squared[pair], who[1:][pair], robots) / 2.0

    who, motions = who[chosen], motions[chosen]
    means = np.stack([_by_robot(motions[:, k], who, robots) for k in (0, 1)], axis=1)
    spread = ((motions - means[who]) ** 2).sum(axis=1)
    bearings = np.arctan2(motions[:, 1], motions[:, 0])
    resultant = np.hypot(_by_robot(np.cos(bearings), who, robots), _by_robot(np.sin(bearings), who, robots))
    return {
        "smoothness": _mean(jitter[np.isfinite(jitter)]),
        "smoothness_approach": _mean(approach_jitter[np.isfinite(approach_jitter)]),
        "way_point_variance": _mean(_by_robot(spread, who, robots)[np.bincount(who, minlength=robots) > 0]),
        "way_point_bearing_variance": _mean(1.0 - resultant[np.isfinite(resultant)]),
    }


def _detection(updates: Updates, robots: int) -> dict[str, Any]:
    detected = (updates.member_states == DETECTED).sum(axis=1)
    missed = int((updates.member_states == MISSED).sum())
    counts = np.diff(updates.input_starts)
    made_up = updates.input_owners < 0
    lit, unmade, false = (int(x.sum()) for x in (updates.beams_lit, updates.beams_missed, updates.beams_made_up))
    with_made_up = np.diff(np.append(0, np.cumsum(made_up))[updates.input_starts]) > 0
    quartiles = _seen_distances(updates, robots)
    return {
        "fn_share": _ratio(missed, missed + int(detected.sum())),
        "fn_beam_share": _ratio(unmade, lit),
        "fp_update_share": _share(with_made_up),
        "fp_input_share": _share(made_up),
        "fp_beam_share": _ratio(false, lit - unmade + false),
        "inputs_per_update": _mean(counts),
        "members_per_update": _mean(detected),
        "one_member_share": _share(detected == 1),
        "seen_distance_q25": quartiles[0],
        "seen_distance_q50": quartiles[1],
        "seen_distance_q75": quartiles[2],
    }


def _seen_distances(updates: Updates, robots: int) -> Floats:
    """(3,) quartiles of the distance to the inputs, m; the inputs of one owner in one update count once, by
    their mean distance (those of nobody as well), so that the number of readings a member makes has no
    weight."""
    means = []
    for updates_now, inputs_now in _pieces(updates):
        counts = np.diff(updates.input_starts[updates_now.start : updates_now.stop + 1])
        positions = updates.input_positions[inputs_now].astype(np.float64)
        distances = np.sqrt(np.einsum("ki,ki->k", positions, positions))
        key = np.repeat(np.arange(len(counts)), counts) * (robots + 1) + updates.input_owners[inputs_now] + 1
        inputs = np.bincount(key)
        seen = inputs > 0
        means.append(np.bincount(key, distances)[seen] / inputs[seen])
    distances = np.concatenate(means) if means else np.empty(0)
    return np.quantile(distances, (0.25, 0.5, 0.75)) if len(distances) else np.full(3, np.nan)


def _formation(result: TrialResult) -> dict[str, Any]:
    late = result.times >= _half(result)
    poses = result.poses_w[late]
    touches = result.contacts.others
    found = {
        "member_collisions": int((touches >= 0).sum()),
        "wall_collisions": int((touches < 0).sum()),
        "distance_travelled": _mean(formation.path_length(result.poses_w[..., :2])),
        "net_displacement": _mean(formation.net_displacement(result.poses_w[..., :2])[-1:]),
    }
    if len(poses) == 0 or not np.isfinite(poses).all():
        return found | dict.fromkeys(LATE, math.nan)
    positions = poses[..., :2]
    velocities = np.diff(positions, axis=0) / np.diff(result.times[late])[:, None, None]
    lines = formation.straightness(positions)
    return found | {
        "polarization": _mean(formation.polarization(poses[..., 2])),
        "group_speed": _mean(formation.group_speed(velocities)),
        "mmd": _mean(formation.mmd(positions)),
        "nearest_neighbour_distance": _mean(formation.nearest_neighbour_distance(positions)),
        "groups": _mean(formation.number_of_groups(positions, GROUP_CUT_M)),
        "straightness": _mean(lines[np.isfinite(lines)]),
        "largest_share": _mean(largest_share(positions, GROUP_CUT_M)),
    }


def _half(result: TrialResult) -> float:
    """When the second half of what was recorded begins, s."""
    return float(result.times[-1]) / 2.0 if len(result.times) else 0.0


def _by_robot(values: Floats, who: Ints, robots: int) -> Floats:
    """(N,) mean of the values of each robot; nan for a robot without any."""
    counts = np.bincount(who, minlength=robots)
    sums = np.bincount(who, values, minlength=robots)
    return np.where(counts > 0, sums / np.maximum(counts, 1), np.nan)


def _mean(values: Any) -> float:
    return float(np.mean(values)) if np.size(values) else math.nan


def _share(of: Bools, among: Bools | None = None) -> float:
    """Share of true values among all, or among those where `among` is true; nan where there are none."""
    if among is None:
        return _mean(of)
    return _ratio(int((of & among).sum()), int(among.sum()))


def _ratio(part: int, whole: int) -> float:
    return part / whole if whole > 0 else math.nan
