"""The drive command and the kinematics beneath it."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from flocking.errors import InputError
from robots.create import drive
from robots.create.model import AXLE_TRACK, DIMENSIONS, MAX_SPEED

GEAR = DIMENSIONS.gear

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


@given(st.integers(-500, 500), RADII.filter(lambda r: abs(r) > 20))
def test_a_commands_own_twist_gives_the_same_motion_back(velocity, radius):
    """Radii above 20 mm; below, the whole-mm grid has several commands for nearly one motion."""
    wanted = drive.wheel_speeds(GEAR, *drive.meant(GEAR, velocity, radius))
    got = drive.wheel_speeds(
        GEAR, *drive.meant(GEAR, *drive.nearest_command(GEAR, *drive.meant(GEAR, velocity, radius)))
    )
    # Where the outer wheel saturates, the mean speed is no whole number of mm/s any more: one unit on each wheel,
    # scaled by what a unit of the mean speed does to the outer wheel (1 + track / 2 |R|).
    unit = 0.0005 * (1 + AXLE_TRACK / 2 / (abs(radius) / 1000)) + 1e-9
    assert got == pytest.approx(wanted, abs=2 * unit)


@given(st.floats(-0.5, 0.5), st.floats(-4.0, 4.0))
def test_the_nearest_command_is_close_and_legal(speed, turn_rate):
    velocity, radius = drive.nearest_command(GEAR, speed, turn_rate)
    drive.encode(velocity, radius)
    wanted = drive.saturated(GEAR, speed, turn_rate)
    got = drive.meant(GEAR, velocity, radius)
    # Straight in place of R > 4 m errs by at most track / 2 / 4 m = 3.2 % of the speed at each wheel, 2 m for 4 m
    # likewise; near the centre an arc and a turn in place differ by the mean speed, which is then below 20 mm/s.
    error = abs(got[0] - wanted[0]) + AXLE_TRACK / 2 * abs(got[1] - wanted[1])
    assert error < 0.5 * AXLE_TRACK / 4 + 0.021


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
