"""The drive command and the kinematics beneath it."""

import math
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flocking.errors import InputError
from robots.create import drive
from robots.create.model import AXLE_TRACK, DIMENSIONS, MAX_SPEED
from robots.create_small import model as create_small

GEAR = DIMENSIONS.gear
SMALL = create_small.DIMENSIONS.gear

SPEEDS = st.floats(-1.0, 1.0)
TURN_RATES = st.floats(-8.0, 8.0)
RADII = st.one_of(st.integers(-2000, 2000).filter(bool), st.just(drive.STRAIGHT))


def test_bytes_of_the_manuals_example():
    """Reverse at 200 mm/s on a radius of 500 mm: the manual's own worked example."""
    assert drive.encode(-200, 500) == bytes([137, 255, 56, 1, 244])


@pytest.mark.parametrize(
    ("velocity", "radius", "tail"), [(300, 0x8000, b"\x80\x00"), (300, -1, b"\xff\xff"), (300, 1, b"\x00\x01")]
)
def test_special_radii(velocity, radius, tail):
    assert drive.encode(velocity, radius)[3:] == tail


@given(st.integers(-500, 500), RADII)
def test_decode_undoes_encode(velocity, radius):
    assert drive.decode(drive.encode(velocity, radius)) == (velocity, radius)


@pytest.mark.parametrize(("velocity", "radius"), [(501, 0x8000), (-501, 100), (100, 2001), (100, -2001), (0, 40000)])
def test_out_of_range_is_refused(velocity, radius):
    with pytest.raises(InputError, match="expected"):
        drive.encode(velocity, radius)


@pytest.mark.parametrize("command", [b"", bytes([136, 0, 0, 0, 0]), bytes([137, 0, 0, 0]), bytes([137, 127, 0, 0, 1])])
def test_other_bytes_are_refused(command):
    with pytest.raises(InputError, match="expected"):
        drive.decode(command)


@given(SPEEDS, TURN_RATES)
def test_wheel_speeds_and_twist_are_inverse(speed, turn_rate):
    got = drive.twist(GEAR, *drive.wheel_speeds(GEAR, speed, turn_rate))
    assert got == pytest.approx((speed, turn_rate), abs=1e-12)


@given(SPEEDS, TURN_RATES, st.floats(0.05, 1.0))
def test_saturation_keeps_the_radius_and_the_limit(speed, turn_rate, limit):
    slow_speed, slow_turn = drive.saturated(GEAR._replace(top_speed=limit), speed, turn_rate)
    assert max(map(abs, drive.wheel_speeds(GEAR, slow_speed, slow_turn))) <= limit * (1 + 1e-12)
    assert slow_speed * turn_rate == pytest.approx(speed * slow_turn, abs=1e-12)  # v/ω = v'/ω' without the division
    assert slow_speed * speed >= 0.0
    assert slow_turn * turn_rate >= 0.0
    if max(map(abs, drive.wheel_speeds(GEAR, speed, turn_rate))) <= limit:
        assert (slow_speed, slow_turn) == (speed, turn_rate)


@given(st.integers(-500, 500), st.integers(-2000, 2000).filter(lambda r: abs(r) > 1))
def test_a_command_means_its_radius(velocity, radius):
    speed, turn_rate = drive.meant(GEAR, velocity, radius)
    assert speed == pytest.approx(turn_rate * radius / 1000, abs=1e-12)
    assert max(map(abs, drive.wheel_speeds(GEAR, speed, turn_rate))) <= MAX_SPEED * (1 + 1e-12)


def test_straight_and_in_place():
    for straight in (drive.STRAIGHT, drive.ALSO_STRAIGHT):
        assert drive.meant(GEAR, -120, straight) == (-0.12, 0.0)
    # In place each wheel runs at the velocity: ω = v / (track / 2); +1 is counter-clockwise.
    assert drive.meant(GEAR, 129, drive.IN_PLACE_LEFT) == (0.0, pytest.approx(2 * 0.129 / AXLE_TRACK))
    assert drive.meant(GEAR, 129, drive.IN_PLACE_RIGHT) == (0.0, pytest.approx(-2 * 0.129 / AXLE_TRACK))


@given(st.integers(-500, 500), RADII, st.sampled_from([GEAR, SMALL]))
def test_a_commands_own_twist_gives_the_same_motion_back(velocity, radius, gear):
    """To rounding, whatever the radius, and whether or not it was slowed."""
    wanted = drive.meant(gear, velocity, radius)
    got = drive.meant(gear, *drive.nearest_command(gear, *wanted))
    assert drive.wheel_speeds(gear, *got) == pytest.approx(drive.wheel_speeds(gear, *wanted), abs=1e-12)


@cache
def all_wheel_speeds(gear):
    """(C, 2) left and right, m/s, of every drive command, slowed where a wheel would pass the limit."""
    velocity = np.arange(-500, 501) / 1000.0
    radius = np.concatenate([np.arange(-2000, -1), np.arange(2, 2001)]) / 1000.0
    share = gear.axle_track / 2 / radius[:, None]
    arcs = np.stack([velocity * (1 - share), velocity * (1 + share)], axis=-1).reshape(-1, 2)
    speeds = np.concatenate([arcs, np.outer(velocity, (1, 1)), np.outer(velocity, (-1, 1))])
    return speeds * np.minimum(1.0, gear.top_speed / np.maximum(np.abs(speeds).max(axis=1), 1e-9))[:, None]


@pytest.mark.parametrize("gear", [GEAR, SMALL])
@pytest.mark.parametrize("fastest", [0.02, 0.1, 0.5, 1.5])
def test_no_command_is_nearer_than_the_nearest(gear, fastest):
    """Against all four million, by the greater miss of the two wheels: slow turns, where millimetres of radius are
    coarse, and twists at and beyond the wheels' limit."""
    rng = np.random.default_rng(1)
    for left, right in rng.uniform(-fastest, fastest, size=(12, 2)):
        speed, turn_rate = drive.twist(gear, left, right)
        wanted = drive.wheel_speeds(gear, *drive.saturated(gear, speed, turn_rate))
        velocity, radius = drive.nearest_command(gear, speed, turn_rate)
        drive.encode(velocity, radius)
        got = drive.wheel_speeds(gear, *drive.meant(gear, velocity, radius))
        least = np.abs(all_wheel_speeds(gear) - wanted).max(axis=1).min()
        assert np.abs(np.subtract(got, wanted)).max() <= least + 1e-12


def test_speed_and_radius_are_rounded_together():
    """0.0152 m/s at 2.003 rad/s: a turn in place misses by 15.6 mm/s, 16 mm/s on 8 mm by 0.8 + 0.129 × 3 = 1.19."""
    assert drive.nearest_command(GEAR, 0.0152, 2.003) == (16, 8)
    assert drive.nearest_command(GEAR, 0.0152, -2.003) == (16, -8)
    assert drive.nearest_command(GEAR, -0.0152, 2.003) == (-16, -8)


def test_a_command_beyond_the_limit_is_slowed_on_its_radius():
    """0.5 m/s on 0.2 m: the outer wheel would need 0.5 (1 + 0.129 / 0.2); it gets 0.5, and the robot 0.304 m/s."""
    slowed = 0.5 / (1 + AXLE_TRACK / 2 / 0.2)
    assert drive.meant(GEAR, 500, 200) == pytest.approx((slowed, slowed / 0.2), rel=1e-12)
    velocity, radius = drive.nearest_command(GEAR, 0.5, 2.5)
    assert drive.meant(GEAR, velocity, radius) == pytest.approx((slowed, slowed / 0.2), rel=1e-12)
    # straight and in place likewise, where a body is slower than the command's own limit
    assert drive.meant(SMALL, 500, drive.STRAIGHT) == pytest.approx((0.3, 0.0), rel=1e-12)
    assert drive.meant(SMALL, 500, 1) == pytest.approx((0.0, 2 * 0.3 / SMALL.axle_track), rel=1e-12)


@pytest.mark.parametrize(
    ("radius_m", "expected"),
    [(5.0, drive.STRAIGHT), (-4.2, drive.STRAIGHT), (3.0, 2000), (-2.4, -2000), (1.2344, 1234)],
)
def test_large_radii(radius_m, expected):
    assert drive.nearest_command(GEAR, 0.3, 0.3 / radius_m) == (300, expected)


def test_turns_in_place_and_rest():
    assert drive.nearest_command(GEAR, 0.0, 1.0) == (129, 1)
    assert drive.nearest_command(GEAR, 0.0, -1.0) == (129, -1)
    assert drive.nearest_command(GEAR, 0.0, 0.0)[0] == 0
    assert drive.nearest_command(GEAR, -0.2, 0.0) == (-200, drive.STRAIGHT)
    velocity, radius = drive.nearest_command(GEAR, -0.2, 0.4)  # backwards, turning left: centre on the right
    assert (velocity, radius) == (-200, -500)
    assert math.isclose(drive.meant(GEAR, velocity, radius)[1], 0.4)
