"""Laws from control theory: what their publications prove or show."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

from flocking import lawentry
from flocking.types import Bools, Floats, Kind, Obstacles
from tests.flocking.laws.flocks import ROUNDING, Flock, rotation, scattered, spread
from trials.simulations.kinematic.fields import GroupNames


def energies(flock: Flock, potential: Callable[[Floats], Floats], steps: int) -> Floats:
    """Kinetic energy and the pairs' potentials, (steps,)."""
    found = []
    for _ in range(steps):
        found.append(0.5 * np.sum(flock.velocities**2) + np.sum(potential(flock.gaps())))
        flock.step()
    return np.array(found)


def path(count: int) -> Bools:
    """The graph in which each member is linked to the next."""
    return np.abs(np.subtract.outer(np.arange(count), np.arange(count))) == 1


def tanner_potential(gaps: Floats) -> Floats:
    return 1.0 / gaps**2 + np.log(gaps**2)


class TestTanner:
    @pytest.mark.parametrize("name", ["tanner-fixed", "tanner-switching"])
    def test_force_is_the_gradient_of_the_potential(self, name: str) -> None:
        flock = Flock(name, scattered(5, 0.5, 1.4, 1), alignment_per_s=0.0, closest_m=1e-6)
        h = 1e-5
        for axis in range(2):
            totals = []
            for sign in (1.0, -1.0):
                flock.positions[0, axis] += sign * h
                totals.append(tanner_potential(flock.gaps()).sum())
                flock.positions[0, axis] -= sign * h
            force = flock.world(0, flock.decide(0))[axis]
            # central differences err by h² times a third derivative of at most 1e4
            assert force == pytest.approx(-(totals[0] - totals[1]) / (2.0 * h), abs=1e-5)

    @pytest.mark.parametrize("name", ["tanner-fixed", "tanner-switching"])
    def test_energy_does_not_grow_and_all_move_with_the_mean_velocity(self, name: str) -> None:
        flock = Flock(name, scattered(6, 0.8, 2.0, 2), dt=0.005)
        flock.velocities = np.array([1.0, 0.0]) + np.random.default_rng(3).uniform(-0.4, 0.4, (6, 2))
        mean = flock.velocities.mean(axis=0)
        reach = getattr(flock.parameters, "range_m", math.inf)
        energy = energies(flock, lambda gaps: tanner_potential(np.minimum(gaps, reach)), 2500)
        assert np.max(np.diff(energy)) < ROUNDING
        assert energy[-1] < energy[0] - 0.1
        # overdamped modes fall at stiffness over damping, here 0.5/s or more: twelve seconds leave e^-6 of 0.5 m/s
        assert spread(flock.velocities) < 2e-3
        assert_allclose(flock.velocities.mean(axis=0), mean, atol=ROUNDING)

    def test_velocities_apart_are_drawn_together(self) -> None:
        flock = Flock("tanner-fixed", [[0.0, 0.0], [1.0, 0.0]])
        flock.velocities[1] = [0.0, 0.3]
        # at the distance of least potential, only the difference of velocity acts
        assert_allclose(flock.world(0, flock.decide(0)), [0.0, 0.3], atol=ROUNDING)

    def test_only_linked_members_act_and_only_within_range(self) -> None:
        fixed = Flock("tanner-fixed", [[0.0, 0.0], [0.5, 0.0], [9.0, 0.0]], linked=path(3)[::-1][:, ::-1])
        assert fixed.world(2, fixed.decide(2))[0] < 0.0
        fixed.linked = np.zeros((3, 3), dtype=np.bool_)
        assert fixed.decide(0).kind == Kind.HOLD
        switching = Flock("tanner-switching", [[0.0, 0.0], [1.99, 0.0], [-2.01, 0.0]])
        assert switching.world(0, switching.decide(0))[0] > 0.0


class TestJadbabaie:
    def test_its_weight_exceeds_the_number_of_agents_of_a_herd_by_default(self) -> None:
        assert lawentry.module_of("jadbabaie").Parameters().g > GroupNames().count

    def flock(self, name: str, **parameters: float) -> Flock:
        flock = Flock(name, np.column_stack([0.8 * np.arange(8), np.zeros(8)]), dt=1.0, speed_m_s=1e-9, **parameters)
        flock.headings = np.random.default_rng(5).uniform(-1.4, 1.4, 8)
        return flock

    def test_headings_converge_to_their_mean_as_the_graph_says(self) -> None:
        flock = self.flock("jadbabaie", g=4.0)
        start = flock.headings.copy()
        links = path(8).astype(float)
        once = np.eye(8) - (np.diag(links.sum(axis=0)) - links) / 4.0
        flock.run(300)
        assert_allclose(flock.headings, np.linalg.matrix_power(once, 300) @ start, atol=ROUNDING)
        # the second largest eigenvalue to the power of 300 of differences up to 2.8 rad
        left = np.sort(np.linalg.eigvalsh(once))[-2] ** 300 * 2.8 * math.sqrt(8.0)
        assert_allclose(flock.headings, start.mean(), atol=left)

    def test_groups_out_of_range_of_each_other_do_not_agree(self) -> None:
        flock = self.flock("jadbabaie", g=4.0)
        flock.positions[4:, 0] += 10.0
        halves = flock.headings[:4].mean(), flock.headings[4:].mean()
        flock.run(300)
        assert (flock.headings[0], flock.headings[7]) == pytest.approx(halves, abs=1e-3 * abs(halves[0] - halves[1]))

    def test_averages_over_the_seam_of_the_circle(self) -> None:
        flock = Flock("jadbabaie", [[0.0, 0.0], [0.5, 0.0]], g=2.0)
        flock.headings = np.radians([170.0, -170.0])
        flock.step()
        assert_allclose(np.cos(flock.headings), -1.0, atol=ROUNDING)

    def test_followers_take_up_the_leaders_heading(self) -> None:
        flock = self.flock("jadbabaie-leader")
        flock.roles[2] = 1
        start = flock.headings.copy()
        weights = path(8) + np.eye(8)
        weights[2] = np.eye(8)[2]
        once = weights / weights.sum(axis=1, keepdims=True)
        flock.run(40)
        assert_allclose(flock.headings, np.linalg.matrix_power(once, 40) @ start, atol=ROUNDING)
        flock.run(360)
        assert flock.headings[2] == start[2]
        # the slowest mode of five followers in a row behind a leader loses 3 % a step: 400 steps leave 1e-5
        assert_allclose(flock.headings, start[2], atol=1e-4)


class TestGaziPassino2003:
    def test_a_pair_rests_at_the_distance_where_attraction_and_repulsion_balance(self) -> None:
        rest = math.sqrt(0.2 * math.log(20.0))
        flock = Flock("gazi-passino-2003", [[0.0, 0.0], [0.1, 0.3]], dt=0.01)
        flock.run(600)
        # near rest the gap's error falls with e^(-12 t)
        assert flock.gaps()[0] == pytest.approx(rest, rel=1e-6)

    def test_the_centre_stays_and_all_end_up_within_the_proved_distance_of_it(self) -> None:
        flock = Flock("gazi-passino-2003", np.random.default_rng(8).uniform(0.0, 40.0, (10, 2)), dt=0.005)
        centre = flock.positions.mean(axis=0)
        bound = 20.0 * math.sqrt(0.2 / 2.0) * math.exp(-0.5)
        assert spread(flock.positions) > bound
        flock.run(300)
        assert spread(flock.positions) < bound
        assert_allclose(flock.positions.mean(axis=0), centre, atol=ROUNDING)


class TestGaziPassino2005:
    def row(self) -> Flock:
        return Flock("gazi-passino-2005", np.column_stack([[0.0, 0.2, 0.5, 4.0, 4.3, 9.0], np.full(6, 3.0)]))

    def test_asynchronous_members_come_to_the_comfortable_distance_and_never_touch(self) -> None:
        flock, rng = self.row(), np.random.default_rng(9)
        for _ in range(2000):
            i = int(rng.integers(6))
            motion = flock.decide(i)
            if motion.kind == Kind.WAY_POINT:
                flock.positions[i] += flock.world(i, motion)
            assert np.min(np.diff(flock.positions[:, 0])) > 0.1 - ROUNDING
        assert flock.decide(0).kind == Kind.STOP
        # a round in turn leaves 0.976² of the slowest mode, so that 333 rounds leave 1e-7 of it
        assert_allclose(flock.positions[:, 0], np.arange(6.0), atol=1e-4)
        assert_allclose(flock.positions[:, 1], 3.0, atol=ROUNDING)

    def test_positions_sensed_earlier_do_not_keep_the_row_from_its_rest(self) -> None:
        flock, rng = self.row(), np.random.default_rng(10)
        flock.positions[:, 0] = [0.0, 0.6, 1.5, 3.0, 3.9, 5.5]
        past = [flock.positions.copy()]
        for _ in range(3000):
            i = int(rng.integers(6))
            now = flock.positions
            flock.positions = past[-int(rng.integers(1, min(len(past), 8) + 1))].copy()
            flock.positions[i] = now[i]
            motion = flock.decide(i)
            flock.positions = now.copy()
            if motion.kind == Kind.WAY_POINT:
                flock.positions[i] += flock.world(i, motion)
            past.append(flock.positions)
        # as above, with delays of up to one and a half rounds
        assert_allclose(flock.positions[:, 0], np.arange(6.0), atol=1e-3)


class TestOlfatiSaber:
    def test_energy_does_not_grow_and_a_triangle_becomes_a_lattice(self) -> None:
        flock = Flock("olfati-saber", [[0.0, 0.0], [6.7, 0.0], [3.4, 6.3]], dt=0.02)
        flock.velocities = np.array([[0.1, 0.0], [-0.1, 0.1], [0.0, -0.1]])

        def norm(length: float) -> float:
            return (math.sqrt(1.0 + 0.1 * length**2) - 1.0) / 0.1

        def force(z: float) -> float:
            share = z / norm(8.4)
            bump = 1.0 if share < 0.2 else 0.5 * (1.0 + math.cos(math.pi * (share - 0.2) / 0.8))
            return bump * 5.0 * (z - norm(7.0)) / math.sqrt(1.0 + (z - norm(7.0)) ** 2)

        def potential(gaps: Floats) -> Floats:
            return np.array([quad(force, norm(7.0), norm(min(gap, 8.4)))[0] for gap in gaps])

        energy = energies(flock, potential, 300)
        # the integral by quadrature is right to about 1e-8
        assert np.max(np.diff(energy)) < 1e-7
        assert energy[-1] < 0.5 * energy[0]
        flock.run(1500)
        assert_allclose(flock.gaps(), 7.0, atol=0.01)
        assert spread(flock.velocities) < 0.01

    def test_the_centre_comes_to_the_goal_as_a_critically_damped_spring(self) -> None:
        k = 0.5
        flock = Flock("olfati-saber", scattered(5, 5.0, 14.0, 4), c1_per_s2=k**2, c2_per_s=2.0 * k, dt=0.005)
        flock.goals[:] = [30.0, -10.0]
        flock.velocities = np.random.default_rng(5).uniform(-1.0, 1.0, (5, 2))
        away, speed = flock.positions.mean(axis=0) - flock.goals[0], flock.velocities.mean(axis=0)
        for t in (1.0, 2.0, 4.0):
            flock.run(round(t / flock.dt) - round((t / 2.0 if t > 1.0 else 0.0) / flock.dt))
            expected = (away + (speed + k * away) * t) * math.exp(-k * t)
            # Euler's error: half a step of the fastest motion, 30 m times k
            assert_allclose(flock.positions.mean(axis=0) - flock.goals[0], expected, atol=0.5 * 0.005 * 30.0 * k)

    def test_members_without_a_goal_are_not_drawn_to_it(self) -> None:
        flock = Flock("olfati-saber", [[0.0, 0.0], [50.0, 0.0]])
        flock.goals[0] = [0.0, 9.0]
        assert flock.world(0, flock.decide(0))[1] > 0.0
        assert flock.decide(1).kind == Kind.HOLD


class TestAkamaNaruse:
    @pytest.mark.parametrize("spring", [1.0, 4.0])
    def test_an_undamped_pair_swings_out_as_far_as_its_energy_allows(self, spring: float) -> None:
        flock = Flock("akama-naruse", [[0.0, 0.0], [1.2, 0.0]], dt=1e-3, damper_per_s=0.0, spring_per_s2=spring)
        flock.velocities[1, 0] = 0.4
        farthest = 0.0
        for _ in range(3000):
            flock.step()
            farthest = max(farthest, float(flock.gaps()[0]))
        # both masses move, so the reduced mass of 1/2 stores the energy; Euler's error is a step of 0.4 m/s
        assert farthest == pytest.approx(1.0 + math.sqrt(0.2**2 + 0.4**2 / (2.0 * spring)), abs=1e-3 * 0.4)

    def test_a_damped_triangle_rests_at_the_stable_distance_with_the_mean_velocity(self) -> None:
        flock = Flock("akama-naruse", [[0.0, 0.0], [1.3, 0.0], [0.4, 0.8]], dt=0.02)
        flock.velocities = np.array([[1.0, 0.2], [0.7, 0.0], [1.1, -0.1]])
        mean = flock.velocities.mean(axis=0)
        flock.run(1500)
        # the slowest mode, of stiffness 3/2 and damping 3, falls with e^(-0.63 t): thirty seconds leave e^-19
        assert_allclose(flock.gaps(), 1.0, atol=1e-6)
        assert_allclose(flock.velocities, np.tile(mean, (3, 1)), atol=1e-6)

    def test_beyond_the_range_the_link_is_lost(self) -> None:
        assert Flock("akama-naruse", [[0.0, 0.0], [1.6 + 1e-9, 0.0]]).decide(0).kind == Kind.HOLD
        assert Flock("akama-naruse", [[0.0, 0.0], [1.6 - 1e-9, 0.0]]).decide(0).kind == Kind.ACCELERATION


class TestHodginsBrogan:
    def test_the_rate_of_the_error_is_its_derivative(self) -> None:
        still = Flock("hodgins-brogan", scattered(6, 1.0, 8.0, 6), kp_per_s=1.0, kv=0.0, limit_m_s=1e3)
        rng = np.random.default_rng(7)
        speeds, h, errors = rng.uniform(-1.0, 1.0, (6, 2)), 1e-5, []
        start = still.positions
        for sign in (1.0, -1.0):
            still.positions = start + sign * h * speeds
            errors.append(still.world(0, still.decide(0)))
        moving = Flock("hodgins-brogan", start, kp_per_s=0.0, kv=1.0, limit_m_s=1e3)
        moving.velocities = speeds
        rate = moving.world(0, moving.decide(0)) - speeds[1:].mean(axis=0)
        # central differences err by h² times a third derivative of at most 1e3
        assert_allclose(rate, (errors[0] - errors[1]) / (2.0 * h), atol=1e-6)

    def test_a_pair_rests_at_the_constant_distance(self) -> None:
        flock = Flock("hodgins-brogan", [[0.0, 0.0], [4.0, 1.0]], dt=0.05, nominal_m_s=0.0)
        flock.roles[0] = 1
        flock.run(400)
        # the gap's error falls with e^(-t/2) or faster
        assert flock.gaps()[0] == pytest.approx(2.5, abs=1e-3)

    def test_an_oblong_herd_follows_its_user_and_contracts_to_a_circle(self) -> None:
        rows, columns = np.meshgrid(np.arange(3.0), np.arange(5.0))
        flock = Flock("hodgins-brogan", 2.5 * np.column_stack([rows.ravel(), columns.ravel()]), dt=0.05)
        flock.velocities[:] = [2.0, 0.0]
        flock.roles[7] = 1
        flock.goals[7] = [1e6, 0.0]
        aspects = []
        for steps in (0, 1200):
            flock.run(steps)
            axes = np.linalg.svd(flock.positions - flock.positions.mean(axis=0), compute_uv=False)
            aspects.append(axes[1] / axes[0])
        assert aspects[0] < 0.6
        assert aspects[1] > 0.8
        # the user is held back by what the herd adds to its nominal velocity: nothing, once all is at rest
        assert_allclose(flock.velocities, np.tile([2.0, 0.0], (15, 1)), atol=0.05)
        assert flock.gaps().min() > 0.5

    def beside(self, obstacles: list[list[float]], **set_to: float) -> float:
        """How far to the left a member that runs along x would like to be."""
        module = lawentry.module_of("hodgins-brogan")
        given = {"obstacle_radius_m": 2.0, "look_ahead_m": 10.0, **set_to}
        points = np.array(obstacles, dtype=np.float64).reshape(-1, 2)
        return float(module.beside.py_func(points, np.array([2.0, 0.0]), module.Parameters(**given)))

    def nearest_of(self, x: float, y: float, radius: float = 2.0) -> list[float]:
        """The nearest point of a disc about (x, y)."""
        distance = math.hypot(x, y)
        return [x * (1.0 - radius / distance), y * (1.0 - radius / distance)]

    def test_a_member_whose_course_runs_into_a_disc_aims_at_one_and_a_half_radii_from_its_centre(self) -> None:
        for aside in (0.5, -0.5, 1.9, -1.9):
            # the centre lies that far to the left: the member passes it on the other side
            way = self.beside([self.nearest_of(6.0, aside)])
            assert way == pytest.approx(aside - math.copysign(3.0, aside), abs=1e-9)

    @pytest.mark.parametrize(
        ("x", "y", "set_to"),
        [
            (6.0, 2.1, {}),  # its course passes the disc
            (-6.0, 0.5, {}),  # it is behind
            (13.0, 0.5, {}),  # its surface is farther away than the look-ahead
            (6.0, 0.5, {"obstacle_radius_m": 0.0}),  # nothing is told of obstacles
            (6.0, 0.0, {}),  # dead ahead: no side is the nearer one
        ],
    )
    def test_other_discs_change_nothing(self, x: float, y: float, set_to: dict[str, float]) -> None:
        assert self.beside([self.nearest_of(x, y)], **set_to) == 0.0

    def test_of_two_discs_the_nearer_one_counts(self) -> None:
        near, far = self.nearest_of(5.0, 1.0), self.nearest_of(9.0, -1.0)
        assert self.beside([far, near]) == self.beside([near])

    def test_one_alone_turns_beside_the_disc_and_keeps_its_speed(self) -> None:
        flock = Flock("hodgins-brogan", [[0.0, 0.0]], dt=0.02, obstacle_radius_m=2.0)
        flock.velocities[:] = [2.0, 0.0]
        nearest = math.inf
        for _ in range(500):
            away = np.array([8.0, 0.3]) - flock.positions[0]
            distance = float(np.hypot(*away))
            nearest = min(nearest, distance)
            point = away * (1.0 - 2.0 / distance) @ rotation(flock.headings[0])
            flock.obstacles = Obstacles(point[None])
            flock.step()
            assert np.hypot(*flock.velocities[0]) == pytest.approx(2.0)
        # a course that touches the disc, turned in steps: each ends at most 2 m/s · 0.02 s too near
        assert nearest > 2.0 - 0.04
        assert flock.positions[0, 0] > 10.0
