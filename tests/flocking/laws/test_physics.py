"""Each law of the physicists against something that its own publication says, or that follows from its equation."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flocking.types import Floats, Kind
from tests.flocking.laws.swarms import Swarm, crowd, directions, module

ROUNDING = 1e-9
"""Of angles and distances of order one after at most some hundred turns of the frame, each good to 1e-15."""

ERRORS = 4.0
"""Standard errors that a sample mean may be off: one in 16,000 samples is, and the seeds are fixed."""


def departures(swarm: Swarm) -> Floats:
    """Angles between the new headings and the direction that all members had in common before they turned."""
    before = directions(swarm.headings).sum(axis=0)
    swarm.step()
    return np.asarray(swarm.headings - math.atan2(before[1], before[0]))


def assert_mean(sample: Floats, expected: float) -> None:
    assert abs(sample.mean() - expected) < ERRORS * sample.std() / math.sqrt(len(sample))


def balance(swarm: Swarm, steps: int) -> float:
    """Distance that two members of a group of two come to, m."""
    swarm.run(steps)
    return float(np.hypot(*(swarm.positions[1] - swarm.positions[0])))


class TestVicsek:
    @pytest.mark.parametrize("noise", [0.5, 2.0, 5.0])
    def test_order_of_a_herd_in_which_all_see_all_is_the_mean_cosine_of_the_noise(self, noise: float) -> None:
        angles = departures(crowd("vicsek", 400, side=0.5, noise_rad=noise))
        assert_mean(np.cos(angles), math.sin(noise / 2) / (noise / 2))
        assert_mean(np.sin(angles), 0.0)

    def test_the_noise_spans_half_its_width_to_either_side(self) -> None:
        alone = crowd("vicsek", 1, side=1.0, noise_rad=1.0)
        turns = np.array([alone.decide(0).x for _ in range(500)])
        assert np.abs(turns).max() <= 0.5
        assert_mean(turns**2, 1.0 / 12.0)

    def test_the_member_itself_belongs_to_the_mean(self) -> None:
        pair = Swarm("vicsek", np.zeros((2, 2)), np.array([0.0, math.pi / 2]), 0.03, 1.0, noise_rad=0.0)
        assert pair.decide(0).x == pytest.approx(math.pi / 4)


class TestCzirok:
    def test_order_grows_with_density_at_the_same_noise(self) -> None:
        orders = []
        for density in (0.1, 4.0):
            herd = crowd("czirok", 64, side=math.sqrt(64 / density), noise_rad=2.5)
            herd.side = math.sqrt(64 / density)
            herd.run(100)
            orders.append(herd.mean_order(50))
        # 64 headings at random have an order of 0.11; noise alone keeps it below sin(1.25) / 1.25 = 0.76
        assert orders[0] < 0.35
        assert orders[1] > 0.6


class TestSmithMartin:
    @pytest.mark.parametrize(("noise", "low", "high"), [(0.1, 0.99, 1.0), (2.0 * math.pi, 0.0, 0.35)])
    def test_open_space_has_the_ordered_and_the_disordered_phase_of_vicsek(
        self, noise: float, low: float, high: float
    ) -> None:
        herd = crowd("smith_martin", 40, side=1.5, noise_rad=noise)
        herd.run(5)
        # noise over the whole circle leaves an order of 0.14 on average for 40 members
        assert low < herd.mean_order(10) < high


class TestTonerTu:
    def test_order_of_a_herd_in_which_all_see_all_is_that_of_normal_noise(self) -> None:
        angles = departures(crowd("toner_tu", 400, side=0.5, noise_rad=0.8))
        assert_mean(np.cos(angles), math.exp(-(0.8**2) / 2))
        assert_mean(np.cos(2.0 * angles), math.exp(-2.0 * 0.8**2))

    def test_headings_left_and_right_of_backwards_have_their_mean_backwards(self) -> None:
        three = Swarm("toner_tu", np.zeros((3, 2)), np.array([0.0, 3.0, -3.0]), 1.0, 1.0, noise_rad=0.0)
        assert abs(three.decide(0).x) == pytest.approx(math.pi)


class TestDong:
    def test_velocities_approach_their_mean_by_the_same_factor_at_each_step(self) -> None:
        herd = crowd("dong", 10, side=1.0)
        mean = herd.velocities.mean(axis=0)
        apart = herd.velocities - mean
        herd.run(20)
        assert_allclose(herd.velocities.mean(axis=0), mean, atol=ROUNDING)
        assert_allclose(herd.velocities - mean, apart * (1.0 - 10 * herd.dt) ** 20, atol=ROUNDING)

    def test_all_take_over_the_velocity_of_a_leader_who_heeds_nobody(self) -> None:
        herd = crowd("dong", 10, side=1.0)
        herd.roles[0] = 1
        leader = herd.velocities[0].copy()
        herd.run(800)
        # the slowest way of being apart shrinks by 1 - dt a step: to 1e-7 of at most 2 m/s
        assert_allclose(herd.velocities, np.tile(leader, (10, 1)), atol=1e-6)


class TestShimoyama:
    def test_a_member_alone_reaches_thrust_over_drag(self) -> None:
        alone = Swarm("shimoyama", np.zeros((1, 2)), np.zeros(1), 0.1, 0.05, thrust_n=0.6, drag_kg_s=2.0)
        alone.run(400)
        assert np.hypot(*alone.velocities[0]) == pytest.approx(0.3)

    @pytest.mark.parametrize("start", [0.6, 2.0])
    def test_two_without_thrust_or_gravity_come_to_rest_at_the_spacing(self, start: float) -> None:
        positions = np.array([[0.0, 0.0], [start, 0.0]])
        pair = Swarm("shimoyama", positions, np.zeros(2), 0.0, 0.05, thrust_n=0.0, gravity_n=0.0, spacing_m=1.2)
        assert balance(pair, 1500) == pytest.approx(1.2, rel=1e-6)

    def test_the_heading_turns_to_the_velocity_in_the_relaxation_time(self) -> None:
        coasting = Swarm("shimoyama", np.zeros((1, 2)), np.zeros(1), 1.0, 0.1, thrust_n=0.0, drag_kg_s=0.0)
        coasting.memory[0] = 2.0
        coasting.run(10)
        decay = math.exp(-1.0 / coasting.parameters.relaxation_s)
        assert math.tan(coasting.memory[0, 0] / 2) == pytest.approx(math.tan(1.0) * decay)

    def test_the_heading_stays_where_it_is_in_the_world_while_the_body_turns(self) -> None:
        herd = crowd("shimoyama", 5, side=4.0, seed=3)
        expected = in_the_world(herd, 200)
        herd.run(200)
        assert_allclose(herd.positions, expected, atol=1e-6)  # m; the motion is chaotic and stretches roundings


def in_the_world(swarm: Swarm, steps: int) -> Floats:
    """Where Shimoyama's equations, with heading vectors in the world and no body, take the members."""
    p, dt = swarm.parameters, swarm.dt
    r, v = swarm.positions.copy(), swarm.velocities.copy()
    n = v / np.linalg.norm(v, axis=1)[:, None]
    for _ in range(steps):
        force = p.thrust_n * n - p.drag_kg_s * v
        for i in range(len(r)):
            gap = np.delete(r, i, axis=0) - r[i]
            x = np.linalg.norm(gap, axis=1)[:, None] / p.spacing_m
            weight = 1.0 + p.anisotropy * (gap @ n[i])[:, None] / (x * p.spacing_m)
            force[i] -= (weight * p.interaction_n * (x**-3 - x**-2) * gap / p.spacing_m * np.exp(-x)).sum(axis=0)
            force[i] += p.gravity_n / len(gap) * gap.sum(axis=0) / np.linalg.norm(gap.sum(axis=0))
        angle = np.arctan2(v[:, 0] * n[:, 1] - v[:, 1] * n[:, 0], (v * n).sum(axis=1))
        angle = 2.0 * np.arctan(np.tan(angle / 2) * math.exp(-dt / p.relaxation_s))
        n = directions(np.arctan2(v[:, 1], v[:, 0]) + angle)
        v = v + force / p.mass_kg * dt
        r = r + v * dt
    return r


class TestSzabo:
    def test_without_accelerations_it_takes_the_mean_velocity(self) -> None:
        pair = Swarm("szabo", np.zeros((2, 2)), np.array([0.0, 1.0]), 0.1, 1.0, velocity_share=1.0, noise=0.0)
        assert [pair.decide(0).x, pair.decide(0).x] == pytest.approx([0.5, 0.5])

    @pytest.mark.parametrize("share", [0.2, 0.7])
    def test_it_turns_ahead_of_neighbours_that_turn(self, share: float) -> None:
        herd = Swarm("szabo", np.zeros((3, 2)), np.full(3, 0.3), 0.1, 1.0, velocity_share=share, noise=0.0)
        herd.step()
        before = herd.velocities.mean(axis=0)
        herd.headings[1:] += 0.4
        herd.velocities = 0.1 * directions(herd.headings)
        after = herd.velocities.mean(axis=0)
        wanted = share * after + (1.0 - share) * (after - before)
        herd.step()
        assert herd.headings[0] == pytest.approx(math.atan2(wanted[1], wanted[0]))

    def test_it_remembers_the_mean_velocity_in_the_world_however_its_body_turns(self) -> None:
        herd = Swarm("szabo", np.zeros((3, 2)), np.array([0.5, 1.0, -2.0]), 0.1, 1.0, velocity_share=0.4, noise=0.6)
        herd.rng = Fixed(0.9)  # type: ignore[assignment]
        own_turn = 0.6 * 2.0 * math.pi * 0.4
        before = herd.velocities.mean(axis=0)
        herd.step()
        for _ in range(10):
            herd.velocities += np.array([[0.02, 0.0], [0.0, 0.03], [0.0, 0.0]])
            herd.headings = np.arctan2(herd.velocities[:, 1], herd.velocities[:, 0])
            after = herd.velocities.mean(axis=0)
            wanted = 0.4 * after + 0.6 * (after - before)
            before = after
            herd.step()
            expected = math.atan2(wanted[1], wanted[0]) + own_turn
            assert_allclose(directions(herd.headings[2]), directions(expected), atol=ROUNDING)

    def test_with_ids_it_is_the_mean_of_each_neighbours_own_acceleration(self) -> None:
        herd = crowd("szabo_ids", 25, side=3.0, velocity_share=0.3, noise=0.0)
        before, came = herd.velocities.copy(), 0
        near = np.eye(25, dtype=bool)
        for _ in range(20):
            gaps = np.hypot(*(herd.positions[:, None] - herd.positions[None]).transpose(2, 0, 1))
            came += int((~near & (gaps < 1.0)).sum())
            near = gaps < 1.0  # the member itself among them
            share = near / near.sum(axis=1, keepdims=True)
            wanted = 0.3 * share @ herd.velocities + 0.7 * share @ (herd.velocities - before)
            before = herd.velocities.copy()
            herd.step()
            assert_allclose(directions(herd.headings), wanted / np.linalg.norm(wanted, axis=1)[:, None], atol=1e-7)
        assert came > 100  # of whom each was known already

    @pytest.mark.parametrize("name", ["szabo", "szabo_ids"])
    def test_accelerations_passed_on_too_strongly_undo_the_order(self, name: str) -> None:
        orders = []
        for share in (0.1, 0.6):
            herd = crowd(name, 60, side=8.0, velocity_share=share)
            herd.side = 8.0
            herd.run(60)
            orders.append(herd.mean_order(60))
        # over three seeds: 0.22 to 0.51 below, 0.94 to 0.98 above
        assert orders[0] < 0.5
        assert orders[1] > 0.9


class TestLevine:
    def test_a_group_that_moves_as_one_reaches_thrust_over_drag_from_rest(self) -> None:
        herd = Swarm("levine", np.array([[0.0, 0.0], [0.0, 2.0]]), np.zeros(2), 0.0, 0.05, thrust_n=0.6, drag_kg_s=0.8)
        herd.run(1000)
        assert np.hypot(*herd.velocities.T) == pytest.approx(0.75)

    @pytest.mark.parametrize("start", [1.0, 3.0])
    def test_two_settle_where_repulsion_and_attraction_are_equal(self, start: float) -> None:
        pair = Swarm("levine", np.array([[0.0, 0.0], [start, 0.0]]), np.zeros(2), 0.0, 0.05, thrust_n=0.0)
        p = pair.parameters
        ratio = (p.repulsion_j / p.repulsion_m) / (p.attraction_j / p.attraction_m)
        expected = math.log(ratio) / (1.0 / p.repulsion_m - 1.0 / p.attraction_m)
        assert balance(pair, 2000) == pytest.approx(expected, rel=1e-6)

    def test_a_neighbours_direction_counts_less_the_farther_it_is(self) -> None:
        positions, headings = np.array([[0.0, 0.0], [1.5, 0.0]]), np.array([0.0, math.pi / 2])
        only = {"drag_kg_s": 0.0, "repulsion_j": 0.0, "attraction_j": 0.0, "alignment_m": 0.75}
        pair = Swarm("levine", positions, headings, 1.0, 0.05, **only)
        motion = pair.decide(0)
        assert motion.y / motion.x == pytest.approx(math.exp(-2.0))


@pytest.mark.parametrize("name", ["gregoire_1", "gregoire_2"])
class TestGregoire:
    def test_with_cohesion_a_herd_moves_and_stays_together_in_open_space(self, name: str) -> None:
        radii, orders = [], []
        for cohesion in (0.0, 20.0):
            noise = {"gregoire_1": 0.3, "gregoire_2": 1.0}[name]
            herd = crowd(name, 16, side=1.6, seed=2, cohesion=cohesion, noise=noise)
            herd.run(150)
            orders.append(herd.mean_order(50))
            radii.append(herd.radius())
        # a disc of 16 members half a metre apart has a root mean square radius of 0.75 m; at random their order is 0.22
        assert radii[1] < 0.9
        assert radii[0] > 1.5
        assert orders[1] > 0.6

    @pytest.mark.parametrize(("distance", "towards"), [(0.49, -1.0), (0.51, 1.0), (0.9, 1.0), (0.19, -1.0)])
    def test_two_approach_beyond_the_equilibrium_and_part_within_it(
        self, name: str, distance: float, towards: float
    ) -> None:
        positions = np.array([[0.0, 0.0], [0.0, distance]])
        pair = Swarm(name, positions, np.zeros(2), 0.05, 1.0, alignment_s_m=0.0, noise=0.0)
        assert math.sin(pair.decide(0).x) == pytest.approx(towards)

    def test_one_within_the_hard_core_outweighs_all_the_others(self, name: str) -> None:
        positions = np.array([[0.0, 0.0], [0.15, 0.0], *np.tile([0.9, 0.1], (30, 1))])
        herd = Swarm(name, positions, np.zeros(32), 0.05, 1.0, noise=0.0)
        motion = herd.decide(0)
        assert herd.law.RULES[motion.rule] == "hard core"
        assert abs(motion.x) == pytest.approx(math.pi)


@pytest.mark.parametrize("name", ["gregoire_2", "camperi"])
class TestNoiseAsAVector:
    def test_among_neighbours_that_agree_it_turns_by_no_more_than_its_share(self, name: str) -> None:
        headings = [self.heading(name, draw) for draw in np.linspace(0.0, 0.999, 400)]
        p = module(name).Parameters()
        most = math.asin(p.noise / (p.alignment_s_m * p.speed_m_s))
        # 400 directions miss the one that turns most by less than half a step; there the turn is flat
        assert max(headings) == pytest.approx(most, abs=1e-3)
        assert min(headings) == pytest.approx(-most, abs=1e-3)

    def heading(self, name: str, draw: float) -> float:
        row = np.array([[0.0, 0.0], [0.5, 0.0], [-0.5, 0.0], [0.0, 0.5]])
        herd = Swarm(name, row, np.zeros(4), 0.05, 1.0, cohesion=0.0)
        herd.rng = Fixed(draw)  # type: ignore[assignment]
        herd.step()
        return float(herd.headings[0])


class Fixed:
    """A stream of random numbers that are all the same."""

    def __init__(self, draw: float) -> None:
        self.draw = draw

    def random(self, count: int) -> Floats:
        return np.full(count, self.draw)


class TestCamperi:
    def test_the_speed_is_constant_whatever_the_neighbours_do(self) -> None:
        herd = crowd("camperi", 12, side=1.5)
        herd.velocities *= np.linspace(0.0, 4.0, 12)[:, None]
        herd.step()
        speeds = np.hypot(*herd.velocities.T)
        assert_allclose(speeds, herd.parameters.speed_m_s)

    def test_more_noise_leaves_less_order_and_the_herd_together(self) -> None:
        orders = []
        for noise in (0.2, 1.0, 5.0):
            herd = crowd("camperi", 30, side=2.2, noise=noise)
            herd.run(70)
            orders.append(herd.mean_order(30))
            # a disc of 30 members half a metre apart has a root mean square radius of 1 m
            assert herd.radius() < 1.4
        # at random the order of 30 is 0.16
        assert orders[0] > 0.9 > orders[1] > 0.5 > 0.3 > orders[2]

    def test_alone_it_keeps_its_velocity(self) -> None:
        assert crowd("camperi", 1, side=1.0).decide(0).kind == Kind.HOLD
