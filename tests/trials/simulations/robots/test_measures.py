"""The measures of a trial, on trials made by hand so that each has one right answer."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

import numpy as np
import pytest

from flocking.types import Floats, Kind
from sensing.truth import DETECTED, HIDDEN, MISSED
from trials.simulations import run_trial
from trials.simulations.robots import fields
from trials.simulations.robots.measures import ABOUT, measure, nearest_inputs, way_point_angles
from trials.types import Contacts, TrialResult, Updates

RULES = ("none", "snn", "hamilton", "perpendicular")
NAN = (math.nan, math.nan)
SINGLE = 1e-6
"""Inputs are kept in single precision."""

Row = tuple[float, int, int, int, tuple[float, float], Sequence[tuple[float, float, int]]]
"""time, robot, kind, rule, way-point, inputs (x, y, owner)"""


def trial_of(
    rows: Sequence[Row],
    update_poses: Floats | None = None,
    states: Sequence[Sequence[int]] | None = None,
    poses_w: Floats | None = None,
    beams: Sequence[tuple[int, int, int]] | None = None,
    others: Sequence[int] = (),
    robots: int = 2,
) -> TrialResult:
    """A finished trial with these updates; 10 s at 1 Hz, robots at rest 1 m apart unless told."""
    count = len(rows)
    inputs = [given for row in rows for given in row[5]]
    times = np.arange(11.0)
    if poses_w is None:
        poses_w = np.zeros((11, robots, 3))
        poses_w[:, :, 1] = np.arange(robots)
    made = np.array(beams if beams is not None else [(0, 0, 0)] * count, dtype=np.int64).reshape(-1, 3)
    updates = Updates(
        times=np.array([row[0] for row in rows], dtype=np.float64),
        robots=np.array([row[1] for row in rows], dtype=np.int64),
        kinds=np.array([row[2] for row in rows], dtype=np.int64),
        rules=np.array([row[3] for row in rows], dtype=np.int64),
        motions=np.array([row[4] for row in rows], dtype=np.float64).reshape(-1, 2),
        poses_w=np.zeros((count, 3)) if update_poses is None else update_poses,
        commands=np.zeros((count, 2)),
        input_starts=np.concatenate([[0], np.cumsum([len(row[5]) for row in rows])]).astype(np.int64),
        input_positions=np.array([g[:2] for g in inputs], dtype=np.float32).reshape(-1, 2),
        input_owners=np.array([g[2] for g in inputs], dtype=np.int16),
        input_selected=np.ones(len(inputs), dtype=np.bool_),
        member_states=np.array(states if states is not None else np.zeros((count, robots)), dtype=np.int8).reshape(
            -1, robots
        ),
        beams_lit=made[:, 0],
        beams_missed=made[:, 1],
        beams_made_up=made[:, 2],
    )
    touches = Contacts(
        times=np.zeros(len(others)),
        robots=np.zeros(len(others), dtype=np.int64),
        others=np.array(others, dtype=np.int64),
        points_w=np.zeros((len(others), 2)),
    )
    return TrialResult(
        trial=fields.trial("made-up", 1, [fields.group(count=robots)], world="open-floor", duration_s=10.0),
        times=times,
        poses_w=poses_w,
        odometry=poses_w,
        bumpers=np.zeros((11, robots, 2), dtype=bool),
        robot_names=tuple(f"herd-{k + 1}" for k in range(robots)),
        radii=np.full(robots, 0.165),
        rules=(RULES,) * robots,
        walls_w=np.empty((0, 4)),
        period_m=math.nan,
        updates=updates,
        contacts=touches,
        scans=None,
        measures={},
        outcome="done",
        reason="",
        timing={},
    )


def towards(degrees: float, distance: float = 2.0) -> tuple[float, float]:
    return distance * math.cos(math.radians(degrees)), distance * math.sin(math.radians(degrees))


def test_every_measure_is_named_and_a_float() -> None:
    found = measure(trial_of([]))
    assert list(found) == list(ABOUT)
    assert all(type(value) is float for value in found.values())
    assert found["member_collisions"] == 0.0
    assert math.isnan(found["ha_share"])
    assert math.isnan(found["smoothness"])


def test_shares_of_the_branches() -> None:
    found = measure(
        trial_of(
            [
                (1.0, 0, Kind.HOLD, 0, NAN, []),
                (2.0, 0, Kind.WAY_POINT, 1, (1.0, 0.0), [(1.0, 0.0, 1)]),
                (3.0, 0, Kind.STOP, 1, NAN, [(0.4, 0.0, 1)]),
                (4.0, 0, Kind.WAY_POINT, 2, (1.0, 0.5), [(1.0, 0.0, 1), (1.0, 2.0, 1)]),
                (5.0, 0, Kind.WAY_POINT, 3, (0.0, 0.66), [(0.4, 0.0, 1), (2.0, 0.0, 1)]),
            ]
        )
    )
    assert found["none_share"] == found["ha_share"] == found["perpendicular_share"] == 1 / 5
    assert found["snn_share"] == 2 / 5
    assert found["stop_share"] == 1 / 5
    assert found["computed_snn_share"] == 2 / 3
    assert found["effective_snn_share"] == 1 / 2  # atan(0.5) = 27 degrees is elsewhere
    assert found["effective_ha_share"] == 1 / 2
    assert found["acts_as_snn_share"] == 2 / 4  # the SNN way-point and the stop, of four updates with inputs
    assert found["acts_as_snn_share_late"] == 0.0  # the perpendicular one, from 5 s on
    assert found["reverted_share"] == 2 / 4
    assert found["ha_angle"] == pytest.approx(math.atan(0.5), abs=SINGLE)


def test_updates_without_an_input_are_counted_of_laws_too_that_have_no_rule_for_them() -> None:
    made = trial_of(
        [
            (1.0, 0, Kind.HOLD, 0, NAN, []),
            (2.0, 0, Kind.VELOCITY, 0, (1.0, 0.0), [(1.0, 0.0, 1)]),
            (3.0, 0, Kind.VELOCITY, 0, (1.0, 0.0), []),
            (4.0, 0, Kind.VELOCITY, 0, (1.0, 0.0), [(1.0, 0.0, 1), (1.0, 2.0, 1)]),
        ]
    )
    assert measure(dataclasses.replace(made, rules=(("go",),) * len(made.rules)))["none_share"] == 2 / 4


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_way_point_points_at_the_nearest_input_up_to_the_bound(side: float) -> None:
    """Brackets of the bound: 15 degrees, and half and twice of it."""
    rows: list[Row] = [
        (
            float(k),
            0,
            Kind.WAY_POINT,
            2,
            towards(side * (100.0 + degrees)),
            [(*towards(side * 100.0, 1.5), 1)],
        )
        for k, degrees in enumerate([0.0, 7.4, 7.6, 14.9, 15.1, 29.9, 30.1, 180.0])
    ]
    found = measure(trial_of(rows))
    assert found["effective_snn_share_tight"] == 2 / 8
    assert found["effective_snn_share"] == found["ha_at_nearest_share"] == 4 / 8
    assert found["effective_snn_share_wide"] == 6 / 8
    assert found["effective_snn_share_late"] == 0 / 3  # from 5 s on


def test_the_nearest_input_of_ragged_rows() -> None:
    rng = np.random.default_rng(8)
    counts = [0, 3, 0, 0, 7, 1, 0]
    inputs = [[(*rng.normal(size=2), 1) for _ in range(n)] for n in counts]
    result = trial_of([(float(u), 0, Kind.HOLD, 0, NAN, given) for u, given in enumerate(inputs)])
    found = nearest_inputs(result.updates)
    for row, given in zip(found, inputs, strict=True):
        if given:
            assert row == pytest.approx(min(given, key=lambda g: math.hypot(g[0], g[1]))[:2], abs=SINGLE)
        else:
            assert np.isnan(row).all()
    assert np.isnan(way_point_angles(result.updates)).all()


def test_a_fixed_way_point_is_smooth_however_the_robot_moves() -> None:
    """A robot that turns and drives about one point of the world: no jitter, but a variance in its own
    frame."""
    rng = np.random.default_rng(9)
    poses = np.column_stack([rng.normal(size=(20, 2)), rng.uniform(-9, 9, 20)])
    c, s = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    gap = np.array([4.0, 1.0]) - poses[:, :2]
    way_points = np.column_stack([c * gap[:, 0] + s * gap[:, 1], -s * gap[:, 0] + c * gap[:, 1]])
    rows: list[Row] = [(0.1 * k, 0, Kind.WAY_POINT, 1, (x, y), []) for k, (x, y) in enumerate(way_points)]
    found = measure(trial_of(rows, update_poses=poses))
    assert found["smoothness"] == pytest.approx(0.0, abs=1e-20)
    assert found["way_point_variance"] == pytest.approx(way_points.var(axis=0).sum(), rel=1e-12)
    assert found["way_point_bearing_variance"] > 0.1


def test_smoothness_estimates_the_variance_of_independent_jitter() -> None:
    """White noise of standard deviation 0.2 m on both axes about a slow drift: 2 x 0.04 m2.

    The estimator's variance is 3 sigma^4 / n an axis; two axes, the mean of two robots, n = 2000: the
    standard error is 0.04 sqrt(3 / 2000) = 0.0016. The bound is four of them.
    """
    rng = np.random.default_rng(10)
    rows: list[Row] = []
    for k in range(2000):
        for robot in (0, 1):
            x, y = np.array([2.0 + 1e-3 * k, 0.0]) + 0.2 * rng.normal(size=2)
            rows.append((0.1 * k + 0.01 * robot, robot, Kind.WAY_POINT, 2, (x, y), []))
    assert measure(trial_of(rows))["smoothness"] == pytest.approx(0.08, abs=4 * 0.0016)


def test_gaps_between_way_points_are_no_jitter() -> None:
    """Only directly successive way-points of one robot are compared."""
    rows: list[Row] = [
        (0.0, 0, Kind.WAY_POINT, 1, (1.0, 0.0), []),
        (0.1, 1, Kind.WAY_POINT, 1, (9.0, 0.0), []),
        (0.2, 0, Kind.STOP, 1, NAN, []),
        (0.3, 1, Kind.WAY_POINT, 1, (9.0, 0.2), []),
        (0.4, 0, Kind.WAY_POINT, 1, (5.0, 0.0), []),
    ]
    assert measure(trial_of(rows))["smoothness"] == pytest.approx(0.04 / 2)


def test_the_perpendicular_way_points_random_sign_can_be_left_out() -> None:
    rows: list[Row] = [
        (0.1 * k, 0, Kind.WAY_POINT, rule, way_point, [])
        for k, (rule, way_point) in enumerate(
            [(1, (2.0, 0.0)), (2, (2.0, 0.2)), (3, (0.0, 0.7)), (3, (0.0, -0.7)), (2, (2.0, 0.0)), (2, (2.0, 0.0))]
        )
    ]
    found = measure(trial_of(rows))
    assert found["smoothness_approach"] == pytest.approx(0.04 / 2 / 2)  # of two pairs, one of them at rest
    assert found["smoothness"] > 0.4


def test_false_negatives_and_positives() -> None:
    found = measure(
        trial_of(
            [
                (1.0, 0, Kind.HOLD, 0, NAN, [(1.0, 0.0, 1), (3.0, 0.0, 1), (0.0, 5.0, -1)]),
                (2.0, 1, Kind.HOLD, 0, NAN, [(4.0, 0.0, 0)]),
                (3.0, 0, Kind.HOLD, 0, NAN, []),
            ],
            states=[[HIDDEN, DETECTED, MISSED], [DETECTED, HIDDEN, HIDDEN], [HIDDEN, MISSED, MISSED]],
            beams=[(10, 4, 2), (10, 2, 0), (5, 5, 0)],
            robots=3,
        )
    )
    assert found["fn_share"] == 3 / 5
    assert found["fp_update_share"] == 1 / 3
    assert found["fp_input_share"] == 1 / 4
    assert found["fn_beam_share"] == 11 / 25
    assert found["fp_beam_share"] == 2 / 16
    assert found["inputs_per_update"] == 4 / 3
    assert found["members_per_update"] == 2 / 3
    assert found["one_member_share"] == 2 / 3
    # member 1 once, at the mean of 1 and 3 m; nobody's at 5 m; member 0 at 4 m
    assert found["seen_distance_q50"] == 4.0
    assert found["seen_distance_q25"] == 3.0
    assert found["seen_distance_q75"] == 4.5


def test_inputs_that_the_selection_kept_from_the_law_do_not_count() -> None:
    """The same trial twice: with what the selection held back, and without it."""
    near, far, phantom = (0.5, 0.0, 1), (1.0, 2.0, 1), (0.1, 0.1, -1)
    motion = (Kind.WAY_POINT, 2, (1.0, 2.0))
    whole = trial_of(
        [
            (1.0, 0, *motion, [near, far, phantom]),
            (2.0, 1, Kind.HOLD, 0, NAN, [phantom]),
            (3.0, 0, Kind.STOP, 1, NAN, [near]),
        ]
    )
    part = trial_of([(1.0, 0, *motion, [far]), (2.0, 1, Kind.HOLD, 0, NAN, []), (3.0, 0, Kind.STOP, 1, NAN, [near])])
    kept = np.array([False, True, False, False, True])
    limited = dataclasses.replace(whole, updates=dataclasses.replace(whole.updates, input_selected=kept))
    found, expected = measure(limited), measure(part)
    assert {name: found[name] for name in found} == pytest.approx(expected, nan_ok=True)
    assert found["acts_as_snn_share"] == 1.0
    assert found["fp_update_share"] == 0.0
    assert measure(whole)["acts_as_snn_share"] == 1 / 3


def test_a_trial_keeps_what_its_selection_let_through() -> None:
    herd = fields.group("snn", 4, pipeline="perfect", selection="nearest")
    updates = run_trial(fields.trial("made-up", 1, [herd], duration_s=1.0), reraise=True).updates
    counts, kept = np.diff(updates.input_starts), np.diff(updates.as_selected().input_starts)
    assert counts.max() > 1
    np.testing.assert_array_equal(kept, np.minimum(counts, 1))
    np.testing.assert_array_equal(nearest_inputs(updates.as_selected()), nearest_inputs(updates))


def test_formation_collisions_and_way() -> None:
    """Two robots abreast at 0.5 m/s, the left one backwards; one member touch, two of walls."""
    poses = np.zeros((11, 2, 3))
    poses[:, :, 0] = 0.5 * np.arange(11.0)[:, None]
    poses[:, 1, 1], poses[:, 1, 2] = 2.0, math.pi
    found = measure(trial_of([], poses_w=poses, others=[1, -1, -1]))
    assert found["polarization"] == pytest.approx(0.0, abs=1e-12)
    assert found["group_speed"] == pytest.approx(0.5)
    assert found["mmd"] == pytest.approx(1.0)
    assert found["nearest_neighbour_distance"] == pytest.approx(2.0)
    assert found["groups"] == 2.0
    assert found["straightness"] == pytest.approx(1.0, abs=1e-7)
    assert found["member_collisions"] == 1.0
    assert found["wall_collisions"] == 2.0
    assert found["distance_travelled"] == pytest.approx(5.0)


def test_a_diverged_trial_is_measured_without_a_warning() -> None:
    poses = np.zeros((11, 2, 3))
    poses[7:] = np.nan
    found = measure(trial_of([], poses_w=poses))
    assert math.isnan(found["mmd"])
    assert math.isnan(found["groups"])
