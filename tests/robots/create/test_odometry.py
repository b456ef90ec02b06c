"""Whole millimetres and degrees per request, the remainder lost."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots.create import odometry
from robots.create.model import AXLE_TRACK, DIMENSIONS, WHEEL_RADIUS

GEAR = DIMENSIONS.gear


def wheels(distance_mm: float, angle_deg: float) -> tuple[float, float]:
    """Rotations (rad) of left and right wheel on an arc."""
    half = math.radians(angle_deg) * AXLE_TRACK / 2
    return (distance_mm / 1000 - half) / WHEEL_RADIUS, (distance_mm / 1000 + half) / WHEEL_RADIUS


@given(st.integers(-8, 8), st.integers(-4, 4))
def test_whole_units_are_reported_whole(distance, angle):
    assert odometry.request(GEAR, *wheels(distance, angle)) == (distance, angle)


@given(st.floats(-8, 8), st.floats(-4, 4))
def test_it_truncates_towards_zero_and_is_odd(distance, angle):
    got = odometry.request(GEAR, *wheels(distance, angle))
    for value, whole in zip((distance, angle), got, strict=True):
        assert abs(whole) <= abs(value) + 2 * odometry.WHOLE
        assert abs(value) - abs(whole) < 1.0
        assert whole == 0 or math.copysign(1, whole) == math.copysign(1, value)
    assert odometry.request(GEAR, *wheels(-distance, -angle)) == (-got[0], -got[1])


def test_the_limits_of_what_a_15_ms_request_sees():
    """1 degree / 15 ms = 66.7 degrees/s and 1 mm / 15 ms = 66.7 mm/s."""
    limit = 1 / odometry.POLLING
    assert limit == pytest.approx(66.7, abs=0.05)
    assert odometry.request(GEAR, *wheels(0, 0.99 * limit * odometry.POLLING)) == (0, 0)
    assert odometry.request(GEAR, *wheels(0, 1.01 * limit * odometry.POLLING)) == (0, 1)
    assert odometry.request(GEAR, *wheels(0.99 * limit * odometry.POLLING, 0)) == (0, 0)


def test_poses_go_round_a_circle():
    """360 steps of 1 degree and 5 mm close a circle: chords of a regular polygon."""
    pose = (1.0, -2.0, 0.3)
    for _ in range(360):
        pose = odometry.moved(*pose, 0.005, math.radians(1))
    assert pose == pytest.approx((1.0, -2.0, 0.3 + 2 * math.pi), abs=1e-9)
