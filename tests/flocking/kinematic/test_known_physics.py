"""What physics and control theory know of these laws, found again in the kinematic herd. Seeds are fixed."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.sparse.csgraph import connected_components

from flocking import lawentry
from flocking.kinematic import Band, History, Schedule, Space, simulate, start_uniform
from flocking.measures import formation
from flocking.types import Bools, Floats
from tests.flocking.kinematic.herds import poses

SURE = 4.0
"""Standard errors by which means must differ: by chance once in 30,000 times."""


def mean_and_error(samples: Floats) -> tuple[float, float]:
    return float(np.mean(samples)), float(np.std(samples, ddof=1) / math.sqrt(len(samples)))


def surely_less(low: Floats, high: Floats) -> bool:
    (a, error_a), (b, error_b) = mean_and_error(low), mean_and_error(high)
    return b - a > SURE * math.hypot(error_a, error_b)


@cache
def orders(count: int, noise: float, density: float = 4.0, steps: int = 800, seeds: int = 5) -> Floats:
    """Vicsek's order parameter over the second half of each run, started in disorder as in the publication."""
    side = math.sqrt(count / density)
    found = []
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        history = simulate(
            Band(lawentry.load("vicsek"), count, {"noise_rad": noise}),
            start_uniform(count, side, rng),
            Schedule(1.0, steps, every=10),
            rng=rng,
            space=Space("periodic", side),
            speeds_m_s=0.03,
        )
        found.append(formation.polarization(history.headings_w)[-steps // 20 :].mean())
    return np.array(found)


class TestVicsek:
    """Vicsek et al. 1995, figures 2a and 2b."""

    def test_order_at_little_noise_and_disorder_at_much(self) -> None:
        assert orders(400, 0.1).min() > 0.95
        assert orders(400, 5.0).max() < 0.3

    def test_order_falls_with_noise(self) -> None:
        for less, more in ((0.1, 2.0), (2.0, 3.0), (3.0, 4.0), (4.0, 5.0)):
            assert surely_less(orders(400, more), orders(400, less))

    def test_the_larger_the_herd_the_less_order_noise_leaves(self) -> None:
        """At the same density; most so where the large ones lose their order first."""
        for fewer, more in ((40, 100), (100, 400)):
            assert surely_less(orders(more, 4.0), orders(fewer, 4.0))

    def test_disorder_is_that_of_groups_without_number(self) -> None:
        """The mean of N random directions goes with the root of 1/N, and so does that of N/40 groups alike."""
        small, error = mean_and_error(orders(40, 5.0))
        large, other = mean_and_error(orders(400, 5.0))
        bound = SURE * small / large * math.hypot(error / small, other / large)
        assert small / large == pytest.approx(math.sqrt(10.0), abs=bound)
        assert bound < 1.0
        # above that of independent directions, whose mean is sqrt(pi / 4 N)
        assert large > math.sqrt(math.pi / 1600.0)

    def test_order_grows_with_density(self) -> None:
        assert surely_less(orders(300, 2.0, 0.25), orders(300, 2.0, 1.0))
        assert surely_less(orders(300, 2.0, 1.0), orders(300, 2.0, 4.0))

    def test_in_turn_as_well_as_together(self) -> None:
        rng = np.random.default_rng(0)
        history = simulate(
            Band(lawentry.load("vicsek"), 400, {"noise_rad": 0.1}),
            start_uniform(400, 10.0, rng),
            Schedule(1.0, 600, every=600, synchronous=False),
            rng=rng,
            space=Space("periodic", 10.0),
            speeds_m_s=0.03,
        )
        assert formation.polarization(history.headings_w)[-1] > 0.95


@cache
def cosines(count: int, informed: int, seeds: int = 24) -> Floats:
    """Of the angle between the group's way over its last 50 s and the preferred direction, drawn anew for each seed."""
    law, found = lawentry.load("couzin"), []
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        preferred = rng.uniform(-math.pi, math.pi)
        goals = np.full((count, 2), np.nan)
        goals[:informed] = 1e7 * math.cos(preferred), 1e7 * math.sin(preferred)
        history = simulate(
            Band(law, count, goals_w=goals),
            start_uniform(count, 1.5 * math.sqrt(count), rng),
            Schedule(law.herd.dt_s, 600, every=50),
            rng=rng,
            speeds_m_s=law.herd.speed_m_s,
        )
        x, y = (history.positions_w[-1] - history.positions_w[-6]).mean(axis=0)
        found.append(math.cos(math.atan2(y, x) - preferred))
    return np.array(found)


class TestCouzin:
    """Couzin et al. 2005, figure 1: accuracy against the informed share."""

    def test_accuracy_rises_with_the_informed_share(self) -> None:
        uninformed, one, five, ten = (cosines(50, k) for k in (0, 1, 5, 10))
        mean, error = mean_and_error(uninformed)
        assert abs(mean) < SURE * error
        assert surely_less(uninformed, five)
        assert surely_less(one, ten)
        assert one.mean() < five.mean() < ten.mean()
        assert ten.mean() > 0.95

    def test_a_larger_group_needs_a_smaller_share(self) -> None:
        """A tenth of 10 is one member."""
        assert surely_less(cosines(10, 1, 200), cosines(50, 5))


def energy_of(history: History, potential: Callable[[Floats], Floats], linked: Bools | None = None) -> Floats:
    """Kinetic energy and that of all pairs (or the linked ones), for members of unit mass."""
    ends = np.triu_indices(history.positions_w.shape[1], 1)
    if linked is not None:
        ends = tuple(side[linked[ends]] for side in ends)  # type: ignore[assignment]
    gaps = history.positions_w[:, ends[0]] - history.positions_w[:, ends[1]]
    pairs = potential(np.hypot(gaps[..., 0], gaps[..., 1])).sum(axis=1)
    found: Floats = pairs + 0.5 * (history.velocities_w**2).sum(axis=(1, 2))
    return found


def disagreement(history: History) -> Floats:
    """Largest difference of a velocity from the mean, at each time."""
    apart = history.velocities_w - history.velocities_w.mean(axis=1, keepdims=True)
    found: Floats = np.hypot(apart[..., 0], apart[..., 1]).max(axis=1)
    return found


def second_order(history: History) -> Floats:
    """What a step of semi-implicit Euler may be off, at most: sums of the squares of what it changes.

    The force is that at the start of the step: to second order, half the square of the velocities' changes, and half
    of those that the forces' change over the step would have made. Twice the larger is allowed.
    """
    changes = (np.diff(history.velocities_w, axis=0) ** 2).sum(axis=(1, 2))
    return 2.0 * np.maximum(changes, np.append(changes[1:], changes[-1]))


def cluster(count: int, gap_m: float, rng: np.random.Generator) -> Floats:
    """Places on a spiral of about that spacing, none very near another."""
    turns = np.arange(count) * math.pi * (3.0 - math.sqrt(5.0))
    radii = gap_m * 0.6 * np.sqrt(np.arange(count) + 0.5)
    spiral = np.stack([radii * np.cos(turns), radii * np.sin(turns)], axis=1)
    return spiral + rng.uniform(-0.1, 0.1, (count, 2)) * gap_m


def flock(name: str, places: Floats, velocities: Floats, steps: int, dt: float, **more: Any) -> History:
    band = Band(lawentry.load(name), len(places), more.pop("given", {}))
    return simulate(
        band, poses(places), Schedule(dt, steps), rng=np.random.default_rng(0), velocities_w=velocities, **more
    )


class TestEnergy:
    """Tanner et al. 2003, parts I and II; Olfati-Saber 2006: energy falls until all velocities are one."""

    @staticmethod
    def tanner(gaps: Floats) -> Floats:
        return 1.0 / gaps**2 + np.log(gaps**2)

    def check(self, history: History, energy: Floats, start: Floats) -> None:
        assert np.isfinite(energy).all()
        assert (np.diff(energy) <= second_order(history) + 1e-12 * np.abs(energy).max()).all()
        assert energy[-1] < energy[0]
        assert energy.argmin() > 0.9 * len(energy)
        apart = disagreement(history)
        assert apart[-1] < 0.01 * apart[0]
        assert history.velocities_w[-1].mean(axis=0) == pytest.approx(start.mean(axis=0), abs=1e-9)

    @pytest.mark.parametrize("graph", ["ring", "everybody", "star"])
    def test_tanners_over_a_fixed_graph(self, graph: str) -> None:
        rng, count = np.random.default_rng(1), 10
        numbers = np.arange(count)
        apart = np.abs(numbers[:, None] - numbers[None])
        links = {"ring": (apart == 1) | (apart == count - 1), "everybody": apart > 0}.get(
            graph, np.zeros_like(apart, bool)
        )
        if graph == "star":
            links[0, 1:] = links[1:, 0] = True
        velocities = np.array([1.0, 0.3]) + rng.uniform(-0.5, 0.5, (count, 2))
        history = flock("tanner-fixed", cluster(count, 1.0, rng), velocities, 8000, 0.005, graph=links)
        assert least_gap(history, links) > 0.25  # nearer, the force is kept as it is
        self.check(history, energy_of(history, self.tanner, links), velocities)

    def test_tanners_over_a_switching_graph(self) -> None:
        rng, count = np.random.default_rng(2), 15
        velocities = np.array([-0.4, 0.8]) + rng.uniform(-0.4, 0.4, (count, 2))
        history = flock("tanner-switching", cluster(count, 1.0, rng), velocities, 8000, 0.005)
        assert least_gap(history) > 0.25
        self.check(history, energy_of(history, lambda gaps: self.tanner(np.minimum(gaps, 2.0))), velocities)

    def test_olfati_sabers(self) -> None:
        """From near a lattice at the distance of rest, so that the group does not fall apart."""
        rng, count = np.random.default_rng(3), 19
        rows = [(x + 0.5 * (abs(y) % 2), y * math.sqrt(0.75)) for y in range(-2, 3) for x in range(-2, 3)]
        lattice = 7.0 * np.array(sorted(rows, key=lambda place: math.hypot(*place))[:count])
        velocities = np.array([1.0, -1.0]) + rng.uniform(-0.4, 0.4, (count, 2))
        history = flock("olfati-saber", lattice + rng.uniform(-0.3, 0.3, (count, 2)), velocities, 4000, 0.02)
        self.check(history, energy_of(history, lattice_potential()), velocities)

    def test_olfati_sabers_with_a_goal_gather_and_rest(self) -> None:
        """With the goal's spring in the energy; its damper takes the common velocity too."""
        rng, count = np.random.default_rng(4), 12
        goal = np.array([40.0, 10.0])
        band = Band(lawentry.load("olfati-saber"), count, goals_w=np.tile(goal, (count, 1)))
        velocities = rng.uniform(-2.0, 2.0, (count, 2))
        history = simulate(
            band,
            poses(cluster(count, 8.0, rng)),
            Schedule(0.02, 6000),
            rng=rng,
            velocities_w=velocities,
        )
        energy = energy_of(history, lattice_potential())
        energy += 0.5 * 0.1 * ((history.positions_w - goal) ** 2).sum(axis=(1, 2))
        assert (np.diff(energy) <= second_order(history) + 1e-12 * np.abs(energy).max()).all()
        assert np.hypot(*history.velocities_w[-1].T).max() < 0.01
        assert history.positions_w[-1].mean(axis=0) == pytest.approx(goal, abs=0.05)


def least_gap(history: History, links: Bools | None = None) -> float:
    gaps = history.positions_w[:, :, None] - history.positions_w[:, None]
    lengths = np.hypot(gaps[..., 0], gaps[..., 1])
    between = ~np.eye(lengths.shape[1], dtype=bool) if links is None else links
    return float(lengths[:, between].min())


@cache
def lattice_potential() -> Callable[[Floats], Floats]:
    """Of a pair of Olfati-Saber's alpha-agents with the default parameters: their force over the sigma-norm."""

    def norm(gap: Any) -> Any:
        return (np.sqrt(1.0 + 0.1 * gap**2) - 1.0) / 0.1

    rest, reach = norm(7.0), norm(8.4)
    z = np.linspace(0.0, reach, 200_001)
    share = z / reach
    bump = np.where(share < 0.2, 1.0, 0.5 * (1.0 + np.cos(math.pi * (share - 0.2) / 0.8)))
    force = bump * 5.0 * (z - rest) / np.sqrt(1.0 + (z - rest) ** 2)
    total = np.concatenate([[0.0], np.cumsum((force[1:] + force[:-1]) / 2.0) * (z[1] - z[0])])
    return lambda gaps: np.interp(norm(np.minimum(gaps, 8.4)), z, total)


def linked(history: History, range_m: float) -> Bools:
    """At which times the graph of members within range is connected."""
    found = []
    for places in history.positions_w:
        gaps = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))
        found.append(connected_components(gaps < range_m, directed=False)[0] == 1)
    return np.array(found)


class TestJadbabaie:
    """Jadbabaie et al. 2003, theorems 2 and 4: headings agree while the members stay linked, over others if need be."""

    START = np.column_stack(
        [cluster(16, 0.8, np.random.default_rng(5)), np.random.default_rng(6).uniform(-1.4, 1.4, 16)]
    )

    def test_headings_converge_while_the_graph_is_connected(self) -> None:
        band = Band(lawentry.load("jadbabaie"), 16, {"g": 20.0, "speed_m_s": 0.001})
        history = simulate(
            band, self.START, Schedule(1.0, 1500, every=10), rng=np.random.default_rng(0), speeds_m_s=0.001
        )
        assert linked(history, 1.0).all()
        spread = np.ptp(history.headings_w, axis=1)
        assert (np.diff(spread) <= 1e-12).all()  # a weighted mean leaves nobody outside of those before
        assert spread[-1] < 1e-3 * spread[0]
        # over an undirected graph the weights are the same both ways: the mean stays
        assert history.headings_w[-1].mean() == pytest.approx(self.START[:, 2].mean(), abs=1e-9)

    def test_of_groups_that_are_not_linked_each_converges_to_its_own(self) -> None:
        start = np.vstack([self.START, self.START + np.array([1000.0, 0.0, 0.9])])
        band = Band(lawentry.load("jadbabaie"), 32, {"g": 20.0, "speed_m_s": 0.001})
        history = simulate(band, start, Schedule(1.0, 1500, every=1500), rng=np.random.default_rng(0), speeds_m_s=0.001)
        ends = history.headings_w[-1]
        assert np.ptp(ends[:16]) < 0.01
        assert np.ptp(ends[16:]) < 0.01
        assert ends[16:].mean() - ends[:16].mean() == pytest.approx(0.9, abs=0.01)

    @pytest.mark.parametrize("synchronous", [True, False])
    def test_with_leaders_all_take_up_theirs(self, synchronous: bool) -> None:
        law = lawentry.load("jadbabaie-leader")
        given = {"speed_m_s": 0.001}
        start = self.START.copy()
        start[:2, 2] = 0.6
        history = simulate(
            [Band(law, 2, given, role=1), Band(law, 14, given)],
            start,
            Schedule(1.0, 800, every=10, synchronous=synchronous),
            rng=np.random.default_rng(0),
            speeds_m_s=0.001,
        )
        assert linked(history, 1.0).all()
        off = np.abs(history.headings_w - 0.6).max(axis=1)
        assert (history.headings_w[:, :2] == 0.6).all()
        assert (np.diff(off) <= 1e-12).all()
        assert off[-1] < 1e-3 * off[0]
