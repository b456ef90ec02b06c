"""What robots are told of their neighbours' velocities: errors in closed form, desired ones by perfect detection."""

from __future__ import annotations

import math

import numpy as np
import pytest

from flocking.errors import InputError
from flocking.types import Kind, Members, Motion, Obstacles
from sensing.types import Detection, WorldTruth
from trials.simulations import check, run_trial
from trials.simulations.robots import desires, fields, measures_velocities
from trials.simulations.robots.log import Log
from trials.studies.robot_herds import herd_sensed
from trials.types import Trial

QUARTER = math.pi / 2.0


def herd(pipeline: str = "perfect", velocities: str = "actual", law: str = "hodgins-brogan", **own: float) -> Trial:
    group = fields.group(law, 3, pipeline=pipeline, velocities=velocities, **own)
    return fields.trial("made-up", 1, [group], world="open-floor", duration_s=2.0)


def test_errors_of_a_made_up_log() -> None:
    log = Log(herd(), 3, "none")
    actual, desired = np.array([[0.0, 0.0], [0.3, 0.4], [0.0, 0.0]]), np.array([[0.0, 0.0], [0.3, 0.0], [0.0, 1.2]])
    told = np.array([[0.0, 0.0], [9.0, 9.0], [0.5, 0.0]])
    log.told(told, np.array([1, -1, 2]), actual, desired, dropped=1)
    found = measures_velocities.of_velocities(log.velocities())
    assert found == pytest.approx(
        {
            "told_off_actual": 0.5,  # 0.5 and 0.5: what belongs to nobody errs from nothing
            "told_off_actual_q50": 0.5,
            "told_off_desired": math.sqrt((0.3**2 + 1.3**2) / 2.0),
            "told_off_desired_q50": 0.8,
            "actual_off_desired": math.sqrt((0.4**2 + 1.2**2) / 2.0),
            "no_velocity_share": 0.25,
        }
    )
    assert found.keys() == measures_velocities.ABOUT.keys()


def test_nobody_told_of_is_nothing_to_measure() -> None:
    found = measures_velocities.of_velocities(Log(herd(), 3, "none").velocities())
    assert all(math.isnan(value) for value in found.values())


def test_what_a_motion_desires() -> None:
    before = np.array([7.0, 8.0])
    sideways = desires.desired_w(Motion(int(Kind.VELOCITY), 0.1, 0.2, 0), (0.0, 0.0), QUARTER, before)
    np.testing.assert_allclose(sideways, [-0.2, 0.1], atol=1e-15)
    ahead = desires.desired_w(Motion(int(Kind.HEADING), 1.0, 0.9, 0), (0.3, 1.0), QUARTER, before)
    np.testing.assert_allclose(ahead, [0.0, 0.3], atol=1e-15)
    np.testing.assert_array_equal(
        desires.desired_w(Motion(int(Kind.HOLD), math.nan, math.nan, 0), (0.3, 1.0), QUARTER, before), before
    )


def test_the_mean_of_what_is_told_is_that_of_the_desired_velocities() -> None:
    poses = np.array([[0.0, 0.0, QUARTER], [0.0, 1.0, 0.0], [0.0, 2.0, 0.0]])
    actual, desired = np.array([[0.0, 0.0], [0.1, 0.0], [0.2, 0.3]]), np.array([[5.0, 5.0], [0.5, 0.0], [0.2, 0.1]])
    truth = WorldTruth(poses, actual, np.full(3, 0.165), 0, np.empty((0, 4)), None, desired)
    ids = np.array([1, 2])
    members = Members(poses[ids, :2], np.zeros(2), np.zeros(2), desires.turned(actual[ids], -QUARTER), ids)
    detection = Detection(members, Obstacles(np.empty((0, 2))), np.empty(0, np.int64))
    told = desires.turned(members.velocities + desires.shift(detection, truth), QUARTER)
    np.testing.assert_allclose(told.mean(axis=0), desired[ids].mean(axis=0), atol=1e-15)
    np.testing.assert_allclose(told[1] - told[0], actual[2] - actual[1], atol=1e-15)


def test_perfect_detection_tells_the_truth_and_other_laws_are_not_measured() -> None:
    measures = run_trial(herd()).measures
    assert measures["told_off_actual"] == pytest.approx(0.0, abs=1e-12)
    assert measures["told_off_desired"] == pytest.approx(measures["actual_off_desired"]) != 0.0
    assert measures["no_velocity_share"] == 0.0
    assert "told_off_actual" not in run_trial(herd(law="snn")).measures


def test_desired_velocities_are_told_by_perfect_detection_alone() -> None:
    told = run_trial(herd(velocities="desired", start_moving=False, informed=1, goal_x_m=100.0)).measures
    assert told["told_off_actual"] > 0.0
    with pytest.raises(InputError, match="no sensor shows them"):
        check(herd("member-based", "desired"))


def test_the_law_of_a_body_keeps_the_numbers_without_units() -> None:
    creates = herd_sensed.scaled("create")
    assert (creates.spacing_m, creates.nominal_m_s, creates.limit_m_s) == (0.8, 0.25, 0.5)
    for body in herd_sensed.BODIES:
        law = herd_sensed.scaled(body)
        assert law.range_m / law.spacing_m == pytest.approx(24.0 / 2.5, rel=1e-3)
        assert law.kp_per_s * law.spacing_m / law.nominal_m_s == pytest.approx(0.5 * 2.5 / 2.0, rel=5e-3)
