"""Robots that run: speed, turns, symmetry, falls; all with real contacts."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robots.one_legged import controller, stepping
from robots.one_legged import model as one_legged
from robots.one_legged.control import Gains
from robots.one_legged.ground import Ground, build
from tests.robots.one_legged.running import RUN_S, SPEEDS, Steady, heights, lined_up


def test_they_stay_upright_for_a_minute(steady: Steady) -> None:
    assert steady.ground.fleet.upright.all()
    assert np.isnan(steady.ground.fleet.fallen_at).all()
    assert steady.ground.fleet.causes == ("",) * len(SPEEDS)
    assert steady.ground.data.warning.number.sum() == 0
    assert steady.lowest > stepping.LOW + 0.1


def test_they_run_as_fast_as_they_are_told_within_a_few_hundredths(steady: Steady) -> None:
    """The control has no integral: 3 % is what docs/one_legged.md measures, and a half more."""
    np.testing.assert_allclose(steady.way[:, 0] / RUN_S, SPEEDS, rtol=0.045, atol=0.01)
    np.testing.assert_allclose(steady.way[:, 1] / RUN_S, 0.0, atol=0.005)


def test_faster_robots_are_faster(steady: Steady) -> None:
    assert (np.diff(steady.way[:, 0]) > 0.0).all()


def test_flights_take_the_time_that_is_wanted(steady: Steady) -> None:
    """Within two steps: a touchdown is only seen after a step. Stances take about half a period of mass and spring."""
    stance, flight = steady.ground.fleet.durations.T
    np.testing.assert_allclose(flight, Gains().flight_s, atol=2.1 * one_legged.TIMESTEP)
    half_period = math.pi * math.sqrt(one_legged.BODY_MASS / Gains().spring)
    assert ((0.8 * half_period < stance) & (stance < 1.3 * half_period)).all()
    np.testing.assert_allclose(steady.hops, RUN_S / (stance + flight), rtol=0.03)


def test_no_motor_comes_near_its_bound(steady: Steady) -> None:
    assert steady.forces[:2].max() < 0.8 * stepping.MOST_TORQUE
    assert steady.forces[2] < 0.9 * stepping.MOST_TWIST
    assert steady.forces[3] < 0.5 * stepping.MOST_FORCE


def test_a_speed_beyond_the_robots_is_limited() -> None:
    ground = build(lined_up(3))
    ground.fleet.desire_all(np.array([[9.0, 0.0], [controller.MAX_SPEED, 0.0], [0.0, -50.0]]))
    most = controller.MAX_SPEED
    np.testing.assert_allclose(ground.fleet.desired, [[most, 0.0], [most, 0.0], [0.0, -most]])
    ground.run(15.0)
    assert ground.fleet.upright.all()
    x = ground.fleet.poses(ground.data)[:, :2] - lined_up(3)[:, :2]
    assert x[0, 0] == pytest.approx(x[1, 0], rel=1e-6)
    with pytest.raises(ValueError, match="finite"):
        ground.fleet.desire(0, math.nan, 0.0)


def test_it_turns_to_a_new_direction() -> None:
    """Over a right angle at 2 m/s, and back to where it came from; its nose comes round."""
    ground = build(lined_up(2))
    fleet, data = ground.fleet, ground.data
    fleet.desire_all(np.array([[2.0, 0.0], [2.0, 0.0]]))
    ground.run(6.0)
    fleet.desire_all(np.array([[0.0, 2.0], [-2.0, 0.0]]))
    ground.run(6.0)
    start = fleet.poses(data)
    ground.run(4.0)
    way = (fleet.poses(data) - start)[:, :2] / 4.0
    np.testing.assert_allclose(way, [[0.0, 2.0], [-2.0, 0.0]], atol=0.15)
    heading = fleet.poses(data)[:, 2]
    assert heading[0] == pytest.approx(math.pi / 2, abs=0.1)
    assert abs(heading[1]) == pytest.approx(math.pi, abs=0.1)


def run(ground: Ground, velocities_w: np.ndarray, seconds: float) -> np.ndarray:
    """(N, 3) poses after robots were told to run so."""
    ground.fleet.desire_all(velocities_w)
    ground.run(seconds)
    return ground.fleet.poses(ground.data)


def test_mirrored_commands_give_mirrored_runs() -> None:
    """Over seven hops, to a micrometre: rounding errors grow from hop to hop."""
    poses = run(build(lined_up(2, apart=10.0)), np.array([[1.5, 1.0], [1.5, -1.0]]), 3.0)
    assert poses[0, 0] == pytest.approx(poses[1, 0], abs=1e-6)
    assert poses[0, 1] == pytest.approx(10.0 - poses[1, 1], abs=1e-6)
    assert poses[0, 2] == pytest.approx(-poses[1, 2], abs=1e-6)


def test_a_run_turns_with_its_start_and_its_command() -> None:
    angle = 0.7
    c, s = math.cos(angle), math.sin(angle)
    straight = run(build(np.zeros((1, 3))), np.array([[1.5, 1.0]]), 3.0)[0]
    turned = run(build(np.array([[0.0, 0.0, angle]])), np.array([[c * 1.5 - s, s * 1.5 + c]]), 3.0)[0]
    x, y = straight[:2]
    np.testing.assert_allclose(turned, [c * x - s * y, s * x + c * y, straight[2] + angle], atol=1e-6)


def test_a_robot_runs_alone_as_it_does_among_others() -> None:
    alone = run(build(lined_up(1), [0.1]), np.array([[2.0, 0.5]]), 3.0)[0]
    among = run(build(lined_up(5), [0.1, 0.0, 0.02, 0.05, 0.07]), np.tile([2.0, 0.5], (5, 1)), 3.0)[0]
    np.testing.assert_allclose(alone, among, atol=1e-6)


def test_robots_pass_through_one_another() -> None:
    """Section 4 of the publication: collisions have no effect."""
    ground = build(np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]))
    poses = run(ground, np.array([[1.0, 0.0], [-1.0, 0.0]]), 4.0)
    assert ground.fleet.upright.all()
    assert poses[0, 0] > poses[1, 0] + 1.0


def test_others_see_the_velocity_of_the_last_flight() -> None:
    ground = build(lined_up(1))
    fleet, data = ground.fleet, ground.data
    fleet.desire(0, 2.0, 0.0)
    ground.run(6.0)
    held, flights, stances, apart = None, 0, 0, 0.0
    for _ in range(400):
        ground.step()
        seen, actual = fleet.velocities(data)[0], fleet.actual_velocities(data)[0]
        if fleet.flying[0] and data.ncon == 0:
            np.testing.assert_array_equal(seen, actual)
            held, flights = seen, flights + 1
        elif held is not None:
            np.testing.assert_array_equal(seen, held)
            stances, apart = stances + 1, max(apart, abs(actual[0] - seen[0]))
    assert min(flights, stances) > 50
    assert apart > 0.05  # 0.1 m/s was measured


def test_a_gain_that_lets_it_fall_ends_as_data() -> None:
    """It goes on lying where it fell, and the others do not notice."""
    ground = build(lined_up(3), heights(3), gains=Gains(attitude=0.0))
    fleet, data = ground.fleet, ground.data
    fleet.desire_all(np.array([[2.0, 0.0], [1.0, 1.0], [0.0, -2.0]]))
    ground.run(20.0)
    assert not fleet.upright.any()
    assert ((fleet.fallen_at > 0.2) & (fleet.fallen_at < 20.0)).all()
    assert set(fleet.causes) <= set(stepping.CAUSES[1:])
    lying = fleet.poses(data)
    ground.run(5.0)
    np.testing.assert_allclose(fleet.poses(data)[:, :2], lying[:, :2], atol=0.1)
    assert (fleet.velocities(data) == 0.0).all()
    assert np.abs(data.qvel).max() < 5.0
    assert data.warning.number.sum() == 0


def test_one_that_falls_leaves_the_others_running() -> None:
    ground = build(lined_up(2))
    ground.fleet.desire_all(np.array([[2.0, 0.0], [2.0, 0.0]]))
    ground.run(3.0)
    ground.fleet.push(ground.data, 0, (0.0, 400.0, 0.0))
    ground.run(7.0)
    np.testing.assert_array_equal(ground.fleet.upright, [False, True])
    assert 3.0 < ground.fleet.fallen_at[0] < 5.0
    assert np.isnan(ground.fleet.fallen_at[1])
    alone = run(build(lined_up(2)), np.array([[2.0, 0.0], [2.0, 0.0]]), 10.0)
    np.testing.assert_allclose(ground.fleet.poses(ground.data)[1], alone[1], atol=1e-3)


def test_a_control_that_does_not_hold_at_all_does_not_upset_physics() -> None:
    for gains in (Gains(swing=1e5), Gains(attitude_damping=1e4), Gains(placement=-0.1)):
        ground = build(lined_up(4), heights(4), gains=gains)
        ground.fleet.desire_all(np.tile([2.0, 0.0], (4, 1)))
        ground.run(15.0)
        assert ground.data.warning.number.sum() == 0
        assert ground.data.time == pytest.approx(15.0)
        assert not ground.fleet.upright.all()


def test_half_the_time_step_gives_the_same_speeds_and_flights() -> None:
    """To 3 %: touchdown and lift-off are seen a step late, of 5 ms or of half of it."""
    means = []
    for timestep_s in (one_legged.TIMESTEP, one_legged.TIMESTEP / 2):
        ground = build(lined_up(3), heights(3), timestep_s=timestep_s)
        ground.fleet.desire_all(np.array([[1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]))
        ground.run(10.0)
        start = ground.fleet.poses(ground.data)
        ground.run(10.0)
        means.append((ground.fleet.poses(ground.data) - start)[:, 0] / 10.0)
        np.testing.assert_allclose(ground.fleet.durations[:, 1], 0.34, atol=2.1 * one_legged.TIMESTEP)
    np.testing.assert_allclose(*means, rtol=0.03)


def test_the_same_run_gives_the_same_numbers() -> None:
    first, second = (run(build(lined_up(3), heights(3)), np.tile([2.0, 0.0], (3, 1)), 3.0) for _ in range(2))
    np.testing.assert_array_equal(first, second)
