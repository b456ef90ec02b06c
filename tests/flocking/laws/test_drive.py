"""Drive: legs one after the other as they stand, turns in place until they are done, and stops by its own odometry."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flocking import lawentry
from flocking.errors import InputError
from flocking.types import Kind
from tests.flocking.laws.asking import ask, run

DT = 0.1


def told(motion: tuple[float, ...], speed_now: float) -> tuple[float, float]:
    """Speed and turn rate that an acceleration makes of the present speed, m/s and rad/s."""
    _, x, y, _ = motion
    forward, sideways = speed_now + x * DT, y * DT
    return math.hypot(forward, sideways), math.atan2(sideways, forward) / DT


@given(st.floats(0.01, 1.0), st.floats(-2.0, 2.0))
def test_a_leg_is_driven_at_its_speed_and_turn_rate_from_the_first_update_on(speed: float, rate: float) -> None:
    memory, now = np.zeros(lawentry.load("drive").memory), 0.0
    for _ in range(5):
        motion, rule = ask("drive", memory=memory, leg_1_m_s=speed, leg_1_rad_s=rate)
        assert (motion.kind, rule) == (Kind.ACCELERATION, "drive")
        now, turn_rate = told(motion, now)
        assert now == pytest.approx(speed)
        assert turn_rate == pytest.approx(rate, abs=1e-9)


def test_legs_follow_one_another_and_those_of_no_time_are_left_out() -> None:
    legs = {"leg_1_s": 0.3, "leg_1_m_s": 0.2, "leg_2_s": 0.0, "leg_2_m_s": 0.9, "leg_3_s": 0.2, "leg_3_m_s": 0.4}
    legs |= {"leg_4_s": 0.2, "leg_6_s": 0.1, "leg_6_m_s": 0.1}
    memory, now, speeds = np.zeros(lawentry.load("drive").memory), 0.0, []
    for _ in range(10):
        motion, _ = ask("drive", memory=memory, **legs)
        now = 0.0 if motion.kind == Kind.STOP else told(motion, now)[0]
        speeds.append(now)
    np.testing.assert_allclose(speeds, [0.2] * 3 + [0.4] * 2 + [0.0] * 2 + [0.1] + [0.0] * 2)


def test_a_turn_in_place_follows_its_aim_and_ends_when_it_is_done() -> None:
    """Played back by a robot that turns towards its aim at twice the angle a second, as bodies do."""
    memory, turned, rate, rules = np.zeros(lawentry.load("drive").memory), 0.0, 0.0, []
    for _ in range(60):
        motion, rule = ask("drive", memory=memory, turn_rate=rate, leg_1_s=4.0, leg_1_m_s=0.0, leg_1_rad_s=-0.4)
        rules.append(rule)
        rate = 2.0 * motion.x if motion.kind == Kind.HEADING else 0.0
        turned += rate * DT
        assert rate >= -0.4 - 1e-9
    assert turned == pytest.approx(-1.6, abs=0.03)
    assert rules[0] == "turn in place"
    assert rules[-1] == "stand"
    assert 4.0 < DT * rules.index("stand") < 5.5


def test_a_turn_that_something_blocks_is_given_up() -> None:
    memory = np.zeros(lawentry.load("drive").memory)
    rules = [ask("drive", memory=memory, leg_1_s=2.0, leg_1_m_s=0.0, leg_1_rad_s=1.0)[1] for _ in range(80)]
    assert rules.index("stand") == pytest.approx((2.0 + 5.0) / DT, abs=1)


@pytest.mark.parametrize("error", [0.0, 0.05, -0.05])
def test_it_stops_for_good_where_its_odometry_says_so(error: float) -> None:
    """At 0.5 m/s and 0.2 rad/s by its wheels: one that takes them for larger has gone less far then."""
    for stop in ({"stop_m": 2.0}, {"stop_rad": 0.8}):
        memory, updates = np.zeros(lawentry.load("drive").memory), 0
        script = {"leg_1_s": 60.0, "leg_1_m_s": 0.5, "leg_1_rad_s": 0.2, "radius_error": error, **stop}
        while ask("drive", memory=memory, own_velocity=(0.5, 0.0), turn_rate=0.2, **script)[1] == "drive":
            updates += 1
        assert updates == pytest.approx(40 / (1.0 + error), abs=1)
        for _ in range(5):
            assert ask("drive", memory=memory, **script)[1] == "stand"


def test_nobody_and_nothing_near_changes_its_way() -> None:
    assert ask("drive", [[0.4, -0.2]], obstacles=[[0.3, 0.0]], contacts=(True, True)) == ask("drive")


def test_a_kinematic_member_drives_a_straight_and_an_arc() -> None:
    legs = {"leg_1_s": 4.0, "leg_1_m_s": 0.5, "leg_2_s": 5.0, "leg_2_m_s": 0.4, "leg_2_rad_s": 0.2}
    history = run("drive", np.array([[1.0, 2.0, 0.0]]), steps=120, dt=DT, given=legs)
    track = history.positions_w[:, 0]
    np.testing.assert_allclose(track[40], (3.0, 2.0), atol=1e-9)
    end = 3.0 + 2.0 * math.sin(1.0), 2.0 + 2.0 * (1.0 - math.cos(1.0))
    np.testing.assert_allclose(track[90], end, atol=0.05)
    np.testing.assert_array_equal(track[91:], np.broadcast_to(track[91], track[91:].shape))


def test_impossible_legs_are_refused() -> None:
    for refused in ({"leg_1_s": -1.0}, {"leg_2_m_s": -0.1}, {"leg_3_rad_s": 2.5}, {"radius_error": 0.6}):
        with pytest.raises(InputError, match=next(iter(refused))):
            lawentry.load("drive").parameters(refused)
