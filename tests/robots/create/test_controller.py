"""What a motion means for a differential drive."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flocking.types import Kind
from robots.create import BODY, controller, drive
from robots.create.model import DIMENSIONS, MAX_SPEED

DT = 0.1
GEAR = DIMENSIONS.gear
follow = BODY.follow
CRUISE = 0.25
NAN = math.nan
ANGLES = st.floats(-math.pi, math.pi)
LENGTHS = st.floats(0.11, 10.0)


def go_to(goal, pose, steps, noise=0.0, seed=0, command=(0.0, 0.0)):
    """A unicycle obeying `follow` towards a way-point: poses (steps + 1, 3) and commands (steps, 2)."""
    rng = np.random.default_rng(seed)
    poses, commands = [pose], []
    for _ in range(steps):
        x, y, heading = poses[-1]
        dx, dy = goal[0] - x, goal[1] - y
        ahead = dx * math.cos(heading) + dy * math.sin(heading) + noise * rng.standard_normal()
        left = -dx * math.sin(heading) + dy * math.cos(heading) + noise * rng.standard_normal()
        command = follow(int(Kind.WAY_POINT), ahead, left, CRUISE, *command, DT)
        middle = heading + command[1] * DT / 2
        poses.append(
            (x + command[0] * DT * math.cos(middle), y + command[0] * DT * math.sin(middle), heading + command[1] * DT)
        )
        commands.append(command)
    return np.array(poses), np.array(commands)


@pytest.mark.parametrize("bearing", np.radians([0, 10, -45, 90, -120, 179, 180, -180]))
@pytest.mark.parametrize("distance", [0.11, 0.3, 3.0])
def test_it_arrives_from_every_side_and_stays(bearing, distance):
    goal = distance * np.array([math.cos(bearing), math.sin(bearing)])
    steps = round((distance / CRUISE + 8.0) / DT)
    poses, commands = go_to(goal, (0.0, 0.0, 0.0), steps)
    assert np.hypot(*(poses[-1, :2] - goal)) <= controller.DEPART
    assert not commands[-10:].any()
    distances = np.hypot(*(poses[:, :2] - goal).T)
    # It never drives away: it turns in place first. 1 mm: the chord of one update's arc.
    assert np.diff(distances).max() < 1e-3
    # One way of turning only, from start to arrival.
    turns = commands[np.abs(commands[:, 1]) > 1e-3, 1]
    assert (
        np.all(turns > 0)
        or np.all(turns < 0)
        or len(turns) == 0
        or np.abs(turns[np.sign(turns) != np.sign(turns[0])]).max() < 0.3
    )


@given(ANGLES, LENGTHS, st.floats(0.01, 0.5))
def test_left_and_right_are_alike(bearing, distance, cruise):
    x, y = distance * math.cos(bearing), distance * math.sin(bearing)
    v, w = follow(int(Kind.WAY_POINT), x, y, cruise, 0.0, 0.0, DT)
    mirrored = follow(int(Kind.WAY_POINT), x, -y, cruise, 0.0, 0.0, DT)
    if abs(bearing) < 3.14:
        assert mirrored == pytest.approx((v, -w), abs=1e-12)
    assert 0.0 <= v <= cruise
    assert abs(w) <= controller.MAX_TURN_RATE
    assert w * y >= 0.0


@given(ANGLES)
def test_it_turns_in_place_while_the_way_point_is_behind(bearing):
    v, w = follow(int(Kind.WAY_POINT), math.cos(bearing), math.sin(bearing), CRUISE, 0.0, 0.0, DT)
    if abs(bearing) >= math.pi / 2:
        assert v == pytest.approx(0.0, abs=1e-12)
        assert w != 0.0
    else:
        assert v > 0.0


def test_the_blend_has_no_jump():
    """Commands 0.001 rad apart differ by no more than the gains say: K for ω, cruise for v (with room for both)."""
    bearings = np.arange(-math.pi + 0.01, math.pi - 0.01, 1e-3)
    commands = np.array([follow(int(Kind.WAY_POINT), math.cos(b), math.sin(b), CRUISE, 0.0, 0.0, DT) for b in bearings])
    assert np.abs(np.diff(commands, axis=0)).max() < 1.5e-3 * controller.TURN_GAIN


def test_a_robot_at_rest_near_its_way_point_does_not_stir():
    """A robot that has stopped ignores way-points within the distance at which it would depart."""
    rng = np.random.default_rng(1)
    for angle, distance in zip(
        rng.uniform(-math.pi, math.pi, 500), rng.uniform(0, controller.DEPART, 500), strict=True
    ):
        x, y = distance * math.cos(angle), distance * math.sin(angle)
        assert follow(int(Kind.WAY_POINT), x, y, CRUISE, 0.0, 0.0, DT) == (0.0, 0.0)


def test_noise_near_the_way_point_does_not_make_it_jitter():
    """After arrival within 3 cm, noise of 2 cm on both axes passes `DEPART` once in 500 updates or less: it stands.

    P(r > 0.1 m − 0.03 m) = exp(−0.07² / (2 × 0.02²)) = 0.2 % at worst; 4 of 400 updates have p < 0.01.
    """
    _, commands = go_to((1.0, 0.4), (0.0, 0.0, 0.0), 500, noise=0.02, seed=3)
    assert np.count_nonzero(commands[100:].any(axis=1)) <= 4


def test_noise_far_from_the_way_point_only_wobbles():
    """3 cm of noise at a metre and more: bearing noise below 0.03 rad, so turn rates below 5 sigma of K times that."""
    _, commands = go_to((6.0, 0.0), (0.0, 0.0, 0.0), 150, noise=0.03, seed=4)
    assert np.abs(commands[:, 1]).max() < 5 * controller.TURN_GAIN * 0.03
    assert commands[:, 0].min() > 0.99 * CRUISE


def test_a_way_point_straight_behind_does_not_dither():
    """Noise puts it left and right in turn; the robot goes round one way."""
    poses, commands = go_to((-2.0, 0.0), (0.0, 0.0, 0.0), 20, noise=0.1, seed=5)
    turning = commands[:10, 1]
    assert np.all(np.sign(turning) == np.sign(turning[0]))
    assert abs(poses[-1, 2]) > 2.5


def test_hold_keeps_and_stop_stops():
    assert follow(int(Kind.HOLD), NAN, NAN, CRUISE, 0.2, -0.7, DT) == (0.2, -0.7)
    assert follow(int(Kind.STOP), NAN, NAN, CRUISE, 0.2, -0.7, DT) == (0.0, 0.0)


@given(st.floats(0.06, 0.5))
def test_velocity_ahead_is_taken_as_it_is(speed):
    assert follow(int(Kind.VELOCITY), speed, 0.0, CRUISE, 0.0, 0.0, DT) == (speed, 0.0)


def test_no_velocity_is_rest():
    assert follow(int(Kind.VELOCITY), 0.0, 0.0, CRUISE, 0.2, 0.1, DT) == (0.0, 0.0)


@given(ANGLES, st.floats(0.0, 1.0), st.sampled_from([Kind.VELOCITY, Kind.HEADING, Kind.ACCELERATION]))
def test_limits_hold_for_every_kind(angle, size, kind):
    numbers = (angle, size) if kind == Kind.HEADING else (10 * size * math.cos(angle), 10 * size * math.sin(angle))
    v, w = follow(int(kind), *numbers, CRUISE, 0.3, 0.5, DT)
    assert max(map(abs, drive.wheel_speeds(GEAR, v, w))) <= MAX_SPEED + 1e-12
    assert abs(w) <= controller.MAX_TURN_RATE + 1e-12


def test_saturation_keeps_the_radius():
    """Twice the speed asked for, beyond the wheels' limit: the same v / ω as below it."""
    bearing = 0.3
    slow = follow(int(Kind.VELOCITY), 0.4 * math.cos(bearing), 0.4 * math.sin(bearing), CRUISE, 0.0, 0.0, DT)
    limited = drive.saturated(GEAR, slow[0] * 2, slow[1] * 2)
    assert limited[0] / limited[1] == pytest.approx(slow[0] / slow[1])
    assert max(drive.wheel_speeds(GEAR, *limited)) == pytest.approx(MAX_SPEED)


def test_a_heading_is_reached_and_held():
    heading, command = 0.0, (0.0, 0.0)
    commands = []
    for _ in range(60):
        command = follow(int(Kind.HEADING), 2.0 - heading, 0.0, CRUISE, *command, DT)
        heading += command[1] * DT
        commands.append(command)
    assert abs(2.0 - heading) <= controller.AIMED * 1.01
    assert commands[-1] == (0.0, 0.0)
    assert min(c[1] for c in commands) >= 0.0
    # At rest it holds until the heading is clearly off.
    assert follow(int(Kind.HEADING), 0.9 * controller.TURN_AWAY, 0.0, CRUISE, 0.0, 0.0, DT) == (0.0, 0.0)
    assert follow(int(Kind.HEADING), 1.1 * controller.TURN_AWAY, 0.0, CRUISE, 0.0, 0.0, DT)[1] > 0.0


def test_acceleration_ahead_adds_up():
    command = (0.0, 0.0)
    for _ in range(10):
        command = follow(int(Kind.ACCELERATION), 0.3, 0.0, CRUISE, *command, DT)
    assert command == pytest.approx((0.3, 0.0))


def test_acceleration_sideways_turns_at_a_over_v_and_keeps_the_speed():
    a, v = 0.1, 0.3
    speed, turn_rate = follow(int(Kind.ACCELERATION), 0.0, a, CRUISE, v, 0.0, DT)
    assert turn_rate == pytest.approx(a / v, rel=1e-3)  # atan(a dt / v) for a dt / v = 0.033
    assert speed == pytest.approx(math.hypot(v, a * DT))


def test_braking_ends_at_rest_not_in_reverse():
    command = (0.3, 0.0)
    speeds = []
    for _ in range(10):
        command = follow(int(Kind.ACCELERATION), -0.5, 0.0, CRUISE, *command, DT)
        speeds.append(command[0])
    assert min(speeds) >= 0.0
    assert speeds[5] == pytest.approx(0.0, abs=1e-9)
