"""Laws that were made for robots, of the Kobots and of flying wings: what their publications say or show."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flocking import lawentry
from flocking.types import NO_OBSTACLES, Floats, Members, Motion, Obstacles, Own
from tests.flocking.laws.flocks import ROUNDING, Flock, scattered, spread


class TestKobots:
    def pair(self, distance: float) -> Motion:
        flock = Flock("turgut", [[0.0, 0.0], [0.0, distance]])
        flock.headings[:] = 0.0
        return flock.decide(0)

    def test_a_neighbour_at_the_desired_level_does_not_turn_the_robot(self) -> None:
        rest = 0.32 - 0.2 * 3.0 / 7.0
        assert self.pair(rest).x == pytest.approx(0.0, abs=ROUNDING)
        assert self.pair(rest - 0.02).x < 0.0 < self.pair(rest + 0.02).x
        assert self.pair(0.4).x == 0.0

    def noisy(self, count: int, u: Floats, mirrored: bool = False, order: Floats | None = None) -> float:
        """The turn of a robot that hears so many with its own heading, all beyond the reach of its sensors."""
        module = lawentry.module_of("turgut")
        side = -1.0 if mirrored else 1.0
        around = np.linspace(0.3, 5.0, count)
        places = np.column_stack([np.cos(around), side * np.sin(around)]) * (1.0 + 0.1 * np.arange(count))[:, None]
        headings = side * 0.1 * np.sin(around)
        order = np.arange(count) if order is None else order
        members = Members(
            places[order], side * around[order], headings[order], np.zeros((count, 2)), np.full(count, -1)
        )
        parameters = module.Parameters(noise=0.5)
        own = Own(np.zeros(2), 0.0, 0.0, np.full(2, np.nan), np.zeros(2, dtype=np.bool_), 0.1, 0, 0)
        heard = np.array([[True], [False]]) & np.ones(count, dtype=np.bool_)
        motion = module.law(own, members, heard, NO_OBSTACLES, parameters, np.zeros(0), u)
        return float(motion.x)

    def test_noise_of_each_heading_averages_out_over_those_heard(self) -> None:
        draws = np.random.default_rng(16).random((3000, 2))
        angle = np.random.default_rng(17).normal(0.0, math.pi / 2.0, 200_000)
        error = np.arctan2(0.5 * np.sin(angle), 1.0 + 0.5 * np.cos(angle))
        for count in (1, 40):
            turns = [self.noisy(count, u) for u in draws]
            # of many: the sum of sines over that of cosines; the headings themselves have a mean of nearly 0
            expected = (
                np.std(error) if count == 1 else np.std(np.sin(error)) / np.mean(np.cos(error)) / math.sqrt(count)
            )
            # four standard errors of a standard deviation of 3000, and a share of 1 / count for what is left out
            assert np.std(turns) == pytest.approx(expected, rel=4.0 / math.sqrt(6000.0) + (count > 1) / count)

    def test_its_noise_is_mirrored_with_the_world_and_knows_no_order(self) -> None:
        rng = np.random.default_rng(18)
        for u in rng.random((20, 2)):
            turn = self.noisy(9, u)
            assert self.noisy(9, 1.0 - u, mirrored=True) == pytest.approx(-turn, abs=ROUNDING)
            assert self.noisy(9, u, order=rng.permutation(9)) == pytest.approx(turn, abs=ROUNDING)

    def test_headings_align_and_noise_keeps_them_apart(self) -> None:
        ordered = []
        for noise in (0.0, 3.0):
            flock = Flock("turgut", scattered(7, 0.5, 3.0, 11), noise=noise, dt=0.1)
            flock.run(60, np.random.default_rng(12))
            ordered.append(flock.polarization())
        assert ordered[0] > 0.99
        assert ordered[1] < 0.8

    def test_an_obstacle_ahead_on_the_left_turns_it_right_and_slows_it(self) -> None:
        flock = Flock("turgut", [[0.0, 0.0]])
        flock.headings[:] = 0.0
        flock.obstacles = Obstacles(np.array([[0.1, 0.09]]))
        motion = flock.decide(0)
        assert motion.x < 0.0
        assert 0.0 < motion.y < 0.07

    def test_uninformed_robots_are_carried_along(self) -> None:
        flock = Flock("gokce-sahin", scattered(6, 0.5, 2.5, 13), dt=0.1)
        flock.goals[:2] = [1e6, 0.0]
        flock.run(400)
        assert np.cos(flock.headings).min() > 0.95

    def test_a_flock_migrates_more_accurately_than_a_robot_alone(self) -> None:
        errors = []
        for count in (1, 12):
            positions = 0.5 * np.column_stack([np.arange(count) // 4, np.arange(count) % 4])
            flock = Flock("gokce-sahin", positions, dt=0.1, homing_noise_rad=1.0)
            flock.goals[:] = [1e6, 0.0]
            flock.headings[:] = 0.0
            rng, sines = np.random.default_rng(14), []
            for _ in range(150):
                flock.step(rng)
                sines.append(np.sin(flock.headings).mean())
            errors.append(np.std(sines))
        assert errors[1] < 0.5 * errors[0]


class TestHauert:
    def test_robots_with_a_common_goal_flock_at_their_fixed_speed(self) -> None:
        flock = Flock("hauert", scattered(10, 15.0, 80.0, 15), dt=0.1)
        flock.goals[:] = [800.0, 40.0]  # 300 m nearer after half a minute
        flock.velocities = 10.0 * np.column_stack([np.cos(flock.headings), np.sin(flock.headings)])
        flock.run(300)
        assert_allclose(np.hypot(*flock.velocities.T), 10.0, atol=ROUNDING)
        assert flock.polarization() > 0.95
        assert np.mean(np.cos(flock.headings)) > 0.9
        assert spread(flock.positions) < 100.0

    def test_the_weights_are_published_and_migration_takes_the_whole_vector(self) -> None:
        flock = Flock("hauert", [[0.0, 0.0], [20.0, 0.0]], dt=0.1, turn_rate_rad_s=1e3)
        flock.headings[:] = 0.0
        flock.velocities[1] = [0.0, 10.0]
        flock.goals[0] = [0.0, 250.0]
        # separation and cohesion along x; alignment, and half of a unit of migration, along y
        assert flock.decide(0).x == pytest.approx(math.atan2(1.0 + 250.0 / 500.0, 1.0 - 1.2), abs=ROUNDING)

    def test_no_turn_is_faster_than_the_turning_rate(self) -> None:
        flock = Flock("hauert", [[0.0, 0.0], [30.0, 0.0]], dt=0.1, turn_rate_rad_s=0.5)
        flock.headings = np.array([math.pi - 0.02, 0.0])
        flock.velocities = 10.0 * np.column_stack([np.cos(flock.headings), np.sin(flock.headings)])
        flock.goals[0] = [1e6, 0.0]
        assert abs(flock.decide(0).x) == pytest.approx(0.05)
        flock.headings[0] = 0.01
        assert flock.decide(0).x == pytest.approx(-0.01, abs=1e-3)
