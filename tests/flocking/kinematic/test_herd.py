"""The kinematic herd as a whole: one history however it is reckoned, and limits kept."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flocking import lawentry
from flocking.kinematic import Band, Progress, Space, cells, herd, start_uniform
from flocking.kinematic.herd import KinematicHerd
from flocking.types import Floats
from tests.flocking.kinematic.herds import SQUARE, TOLD, differences, law_of, poses, run, same, told

ROUNDING = 1e-12
"""Of coordinates of order ten after a few steps: sums of the same terms in another order."""


def vicsek(count: int, **more: Any) -> Band:
    return Band(lawentry.load("vicsek"), count, more)


def couzin(count: int) -> Band:
    return Band(lawentry.load("couzin"), count)


def starts_of(kind: str, count: int, rng: np.random.Generator) -> Floats:
    """Places that are hard on cells, at a density at which a range of 1 m holds some ten members."""
    side = math.sqrt(count / 4.0)
    start = start_uniform(count, side, rng)
    places = start[:, :2]
    if kind == "clustered":
        places[:] = rng.uniform(0.0, side, (8, 2))[rng.integers(0, 8, count)] + rng.normal(0.0, 1.0, (count, 2))
    elif kind == "line":
        places[:, 1] = 0.3 * side
        places[:, 0] = rng.uniform(0.0, count / 8.0, count)
    elif kind == "outlier":
        places[0] = 1e6
    elif kind == "lattice":
        places[:] = np.stack(np.divmod(np.arange(count), round(side * 2.0)), axis=1) * 0.5
    elif kind == "one place":
        places[:] = 1.0
        places[: count // 2] = np.nextafter(1.0, 2.0)
    return start


class TestCells:
    @pytest.mark.parametrize("kind", ["uniform", "clustered", "line", "outlier", "lattice", "one place"])
    @pytest.mark.parametrize("space", ["unbounded", "periodic"])
    @pytest.mark.parametrize("synchronous", [True, False])
    def test_give_what_a_look_at_everybody_gives(self, kind: str, space: str, synchronous: bool) -> None:
        """The second herd looks at everybody because its reach is not known to be short."""
        count = 2000 if kind != "one place" else 300
        start = starts_of(kind, count, np.random.default_rng(1))
        side = math.sqrt(count / 4.0)
        where = Space("periodic", side) if space == "periodic" else Space()
        short = Band(lawentry.load("couzin"), count, {"alpha_m": 0.05, "rho_m": 1.0, "noise_rad": 0.0})
        unlimited = Band(short.law, count, short.parameters)
        object.__setattr__(unlimited, "stages", lambda: Band.stages(short)._replace(reach=math.inf))
        one, other = (
            run(band, start, 3, dt_s=0.05, space=where, speeds_m_s=0.3, synchronous=synchronous)
            for band in (short, unlimited)
        )
        assert np.isfinite(one.poses_w).all()
        scale = max(1.0, float(np.abs(one.positions_w).max())) if space == "unbounded" else 1.0
        gaps = differences(one, other, side if space == "periodic" else 0.0)
        if kind == "one place":  # directions of neighbours 1e-16 m away are those of rounding
            assert gaps[0] == 0.0
        else:
            assert gaps.max() <= 1e3 * ROUNDING * scale

    def test_they_are_used(self) -> None:
        start = start_uniform(2000, 30.0, np.random.default_rng(0))
        assert cells.binned(start[:, :2].copy(), 1.0, 0.0).columns > 10
        assert cells.binned(start[:, :2].copy(), 1.0, 30.0).columns == 30
        assert cells.binned(start[:, :2].copy(), math.inf, 0.0).columns == 0
        assert cells.binned(start[:40, :2].copy(), 1.0, 0.0).columns == 0

    @pytest.mark.parametrize("period", [0.0, 20.0])
    @pytest.mark.parametrize("kind", ["uniform", "clustered", "line", "outlier", "lattice"])
    def test_hold_everybody_once_and_everybody_near_is_near(self, kind: str, period: float) -> None:
        places = starts_of(kind, 1600, np.random.default_rng(2))[:, :2].copy()
        if period:
            places %= period
        found = cells.binned(places, 1.0, period)
        assert sorted(found.members) == list(range(1600))
        pieces = np.empty(18, np.int64)
        for i in range(0, 1600, 7):
            count = cells.nearby(found, *places[i], pieces)
            near = [j for p in range(0, count, 2) for j in found.members[pieces[p] : pieces[p + 1]]]
            assert len(near) == len(set(near))
            gaps = places - places[i]
            if period:
                gaps -= period * np.round(gaps / period)
            assert set(np.flatnonzero(np.hypot(*gaps.T) < 1.0)) <= set(near)

    def test_a_stray_member_does_not_make_everybody_look_at_everybody(self) -> None:
        start = starts_of("outlier", 4000, np.random.default_rng(0))
        strayed = cells.binned(start[:, :2].copy(), 1.0, 0.0)
        pieces = np.empty(18, np.int64)
        count = cells.nearby(strayed, *start[1, :2], pieces)
        assert sum(pieces[p + 1] - pieces[p] for p in range(0, count, 2)) < 400


class TestOneHistory:
    """What must not change what happens."""

    @pytest.mark.parametrize("synchronous", [True, False])
    @pytest.mark.parametrize("bands", [1, 2])
    @pytest.mark.parametrize("count", [20, 300])
    def test_how_many_steps_are_done_at_a_time(
        self, synchronous: bool, bands: int, count: int, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        start = start_uniform(count, math.sqrt(count / 4.0), np.random.default_rng(1))
        group = [vicsek(count - count // 3), vicsek(count // 3, noise_rad=1.0)] if bands == 2 else vicsek(count)
        found = []
        for piece in (0.2, 1e-12, 1e-4):
            monkeypatch.setattr(herd, "PIECE_S", piece)
            found.append(run(group, start, 12, space=Space("periodic", 9.0), every=3, synchronous=synchronous))
        monkeypatch.setattr(herd, "MOST_DRAWS", 1)
        monkeypatch.setattr(herd, "FIRST_LOOKS", 1)
        found.append(run(group, start, 12, space=Space("periodic", 9.0), every=3, synchronous=synchronous))
        assert all(same(found[0], other) for other in found[1:])

    @pytest.mark.parametrize("synchronous", [True, False])
    def test_the_seed_is_what_decides(self, synchronous: bool) -> None:
        start = start_uniform(50, 5.0, np.random.default_rng(1))
        once, again, other = (run(vicsek(50), start, 20, seed=s, synchronous=synchronous) for s in (3, 3, 4))
        assert same(once, again)
        assert not same(once, other)

    @pytest.mark.parametrize("synchronous", [True, False])
    @pytest.mark.parametrize("bands", [1, 2])
    @pytest.mark.parametrize("every", [1, 4, 7, 20, 21])
    def test_what_is_kept(self, every: int, bands: int, synchronous: bool) -> None:
        start = start_uniform(30, 3.0, np.random.default_rng(1))
        group = [vicsek(20), vicsek(10)] if bands == 2 else vicsek(30)
        whole = run(group, start, 20, dt_s=0.5, synchronous=synchronous)
        kept = run(group, start, 20, dt_s=0.5, synchronous=synchronous, every=every)
        assert np.array_equal(kept.times, 0.5 * np.arange(0, 21, every))
        assert np.array_equal(kept.poses_w, whole.poses_w[::every])
        assert np.array_equal(kept.velocities_w, whole.velocities_w[::every])

    @pytest.mark.parametrize("synchronous", [True, False])
    def test_two_bands_of_one_law_are_one_band(self, synchronous: bool) -> None:
        start = start_uniform(40, 3.0, np.random.default_rng(1))
        one = run(vicsek(40), start, 15, synchronous=synchronous)
        two = run([vicsek(15), vicsek(25)], start, 15, synchronous=synchronous)
        assert same(one, two)

    @pytest.mark.parametrize("synchronous", [True, False])
    def test_parameters_of_each_member_alike_are_those_of_all(self, synchronous: bool) -> None:
        start = start_uniform(40, 3.0, np.random.default_rng(1))
        law = lawentry.load("vicsek")
        all_ = Band(law, 40, {"noise_rad": 0.7})
        each = Band(law, 40, [{"noise_rad": 0.7}] * 40)
        assert same(*(run(band, start, 15, synchronous=synchronous) for band in (all_, each)))

    def test_said_is_told_how_far_it_is(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(herd, "PIECE_S", 1e-12)
        monkeypatch.setattr(herd, "FIRST_LOOKS", 1)
        heard: list[int] = []
        run(vicsek(10), start_uniform(10, 3.0, np.random.default_rng(1)), 9, progress=Progress(heard.append))
        assert heard == list(range(1, 10))

    def test_the_start_is_left_alone(self) -> None:
        start = poses([[12.0, -1.0], [3.0, 4.0]], [9.0, 1.0])
        before = start.copy()
        run(told(2, {"x": 1.0}), start, 3, space=Space("periodic", 10.0))
        assert np.array_equal(start, before)


class TestSynchrony:
    """Two members that each go to where the other is: law of a user's own."""

    FOLLOW = TOLD.replace(
        "    memory[0] += 1.0\n    return Motion(parameters.kind, x, y, 0)",
        "    return Motion(2, members.positions[0, 0], members.positions[0, 1], 0)",
    )

    def test_together_they_change_places_and_in_turn_they_meet(self) -> None:
        start = poses([[0.0, 0.0], [1.0, 0.0]])
        band = Band(law_of(self.FOLLOW), 2, {"see": 5.0})
        assert_allclose(run(band, start, 1).positions_w[-1, :, 0], [1.0, 0.0], atol=ROUNDING)
        met = run(band, start, 1, synchronous=False).positions_w[-1, :, 0]
        assert met[0] == pytest.approx(met[1], abs=ROUNDING)

    def test_the_order_is_drawn_anew_in_each_step(self) -> None:
        start = poses([[0.0, 0.0], [1.0, 0.0]])
        band = Band(law_of(self.FOLLOW), 2, {"see": 5.0})
        first = [run(band, start, 1, seed=s, synchronous=False).positions_w[-1, 0, 0] for s in range(200)]
        # who comes first goes over; a fair coin thrown 200 times lies within four standard errors
        assert np.mean(np.round(first)) == pytest.approx(0.5, abs=4.0 * 0.5 / math.sqrt(200.0))

    @pytest.mark.parametrize("synchronous", [True, False])
    def test_each_member_is_asked_once_a_step(self, synchronous: bool) -> None:
        for bands in ([told(7)], [told(3), told(4)]):
            group = KinematicHerd(
                bands, poses(np.arange(14).reshape(7, 2)), Space(), None, 0.1, np.random.default_rng(0)
            )
            group.advance(9, np.empty((9, 7, 5)), 1, 0, synchronous)
            assert (group.bodies.memory == 9.0).all()


class TestMotion:
    @pytest.mark.parametrize("kind", [2, 3, 4])
    def test_limits_are_kept_exactly(self, kind: int) -> None:
        dt, top, turn = 0.1, 0.7, 1.3
        band = told(40, {"kind": kind, "random": 20.0}, max_speed_m_s=top, max_turn_rate_rad_s=turn)
        start = start_uniform(40, 5.0, np.random.default_rng(2))
        history = run(band, start, 300, dt_s=dt)
        speeds = np.hypot(*history.velocities_w.reshape(-1, 2).T)
        assert speeds.max() <= top * (1.0 + ROUNDING)
        steps = np.hypot(*np.diff(history.positions_w, axis=0).reshape(-1, 2).T)
        assert steps.max() <= top * dt * (1.0 + 1e-9)
        turns = (np.diff(history.headings_w, axis=0) + math.pi) % (2.0 * math.pi) - math.pi
        assert np.abs(turns).max() <= turn * dt + ROUNDING
        assert np.abs(turns).max() > 0.999 * turn * dt  # the limit matters

    def test_what_moves_faster_is_slowed_in_its_direction(self) -> None:
        history = run(told(1, {"x": 3.0, "y": 4.0}, max_speed_m_s=0.5), poses([[0.0, 0.0]]), 1)
        assert_allclose(history.velocities_w[-1, 0], [0.3, 0.4], atol=ROUNDING)

    def test_a_turn_beyond_the_limit_loses_what_lies_across_the_nose(self) -> None:
        band = told(1, {"x": 0.0, "y": 1.0}, max_turn_rate_rad_s=0.5)
        history = run(band, poses([[0.0, 0.0]]), 6)
        angles = np.minimum(0.5 * np.arange(7), math.pi / 2.0)
        assert_allclose(history.headings_w[:, 0], angles, atol=ROUNDING)
        assert_allclose(history.velocities_w[1:, 0, 1], np.sin(angles[1:]) ** 2, atol=ROUNDING)

    def test_a_way_point_is_approached_at_the_cruising_speed_and_reached(self) -> None:
        band = Band(law_of(TOLD), 1, {"kind": 2, "x": 1.0, "y": 0.0}, cruise_m_s=0.3)
        assert run(band, poses([[0.0, 0.0]]), 4, dt_s=0.5).positions_w[-1, 0, 0] == pytest.approx(0.6)
        at_once = told(1, {"kind": 2, "x": 1.0, "y": 2.0})
        assert_allclose(run(at_once, poses([[5.0, 0.0]]), 1, dt_s=0.5).positions_w[-1, 0], [6.0, 2.0], atol=ROUNDING)

    def test_accelerations_change_the_velocity_first(self) -> None:
        history = run(told(1, {"kind": 5, "x": 2.0}), poses([[0.0, 0.0]]), 10, dt_s=0.1, speeds_m_s=1.0)
        steps = np.arange(11)
        assert_allclose(history.velocities_w[:, 0, 0], 1.0 + 0.2 * steps, atol=ROUNDING)
        assert_allclose(history.positions_w[:, 0, 0], 0.1 * steps + 0.01 * steps * (steps + 1), atol=ROUNDING)

    def test_updating_forward_positions_change_by_the_old_velocities(self) -> None:
        """Explicit Euler: x(t + dt) = x(t) + v(t) dt."""
        given = {"kind": 5, "x": 2.0}
        history = run(told(1, given), poses([[0.0, 0.0]]), 10, dt_s=0.1, speeds_m_s=1.0, forward=True)
        steps = np.arange(11)
        assert_allclose(history.velocities_w[:, 0, 0], 1.0 + 0.2 * steps, atol=ROUNDING)
        assert_allclose(history.positions_w[:, 0, 0], 0.1 * steps + 0.01 * steps * (steps - 1), atol=ROUNDING)

    @pytest.mark.parametrize("synchronous", [True, False])
    def test_updating_forward_members_of_constant_speed_lag_a_step_behind(self, synchronous: bool) -> None:
        turning = told(3, {"kind": 4, "x": 0.3, "y": 0.5})
        start = poses([[0.0, 0.0], [40.0, 0.0], [0.0, 40.0]], 0.2)
        one, other = (
            run(turning, start, 9, speeds_m_s=0.5, synchronous=synchronous, forward=forward)
            for forward in (False, True)
        )
        assert_allclose(other.headings_w, one.headings_w, atol=ROUNDING)
        first = 0.5 * np.array([math.cos(0.2), math.sin(0.2)])
        assert_allclose(other.positions_w[1:], one.positions_w[:-1] + first, atol=ROUNDING)

    def test_updating_forward_a_wall_stops_the_old_velocity(self) -> None:
        fast = told(1, {"kind": 5, "x": 1.0})
        history = run(fast, poses([[9.5, 5.0]]), 30, dt_s=0.1, speeds_m_s=1.0, space=SQUARE, forward=True)
        assert history.positions_w[:, 0, 0].max() <= 10.0
        # what is taken up after the wall has stopped it: one step's change
        assert history.velocities_w[-1, 0, 0] == pytest.approx(0.1, abs=ROUNDING)

    def test_stop_and_hold(self) -> None:
        start = poses([[0.0, 0.0]], 0.5)
        stopped = run(told(1, {"kind": 1}), start, 3, speeds_m_s=1.0)
        assert (stopped.positions_w == 0.0).all()
        assert (stopped.headings_w == 0.5).all()
        held = run(told(1, {"kind": 0}), start, 3, speeds_m_s=1.0)
        assert_allclose(held.positions_w[-1, 0], [3.0 * math.cos(0.5), 3.0 * math.sin(0.5)], atol=ROUNDING)

    @pytest.mark.parametrize("heading", [math.pi, -math.pi, 7.0, -50.0, 1e5])
    def test_headings_stay_within_half_a_turn(self, heading: float) -> None:
        history = run(told(1, {"kind": 4, "x": 1.0, "y": 1.0}), poses([[0.0, 0.0]], heading), 50)
        assert history.headings_w.min() >= -math.pi
        assert history.headings_w.max() < math.pi
        turned = history.headings_w[:, 0] - (heading + np.arange(51))
        assert_allclose(turned - 2.0 * math.pi * np.round(turned / (2.0 * math.pi)), 0.0, atol=1e-10)

    def test_speeds_and_velocities_at_the_start(self) -> None:
        start = poses(np.zeros((3, 2)), [0.0, math.pi / 2.0, 1.0])
        each = run(told(3), start, 0, speeds_m_s=np.array([1.0, 2.0, 0.0]))
        assert_allclose(each.velocities_w[0], [[1.0, 0.0], [0.0, 2.0], [0.0, 0.0]], atol=ROUNDING)
        given = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]])
        assert np.array_equal(run(told(3), start, 0, velocities_w=given).velocities_w[0], given)
        assert np.array_equal(run(told(3, {"kind": 0}), start, 2, velocities_w=given).positions_w[-1], 2.0 * given)


class TestWhoIsWho:
    def test_each_member_has_its_own_parameters(self) -> None:
        given = [{"x": float(i), "y": -2.0 * i} for i in range(60)]
        history = run(told(60, given), poses(np.zeros((60, 2))), 3)
        assert_allclose(history.positions_w[-1], [[3.0 * i, -6.0 * i] for i in range(60)], atol=1e2 * ROUNDING)

    def test_a_selection_takes_each_members_own_range(self) -> None:
        counting = TOLD.replace("parameters.kind, x, y, 0)", "3, float(sets[0].sum()) * math.cos(own.compass), 0.0, 0)")
        given = [{"see": 0.5 + i} for i in range(6)]
        start = poses([[float(i), 0.0] for i in range(6)])
        history = run(Band(law_of(counting), 6, given), start, 1)
        # member i, at i, sees those nearer than i + 1/2
        expected = [sum(0 < abs(i - j) < i + 0.5 for j in range(6)) for i in range(6)]
        assert history.velocities_w[-1, :, 0].tolist() == expected

    def test_goals_and_roles_reach_their_members(self) -> None:
        seeking = TOLD.replace(
            "return Motion(parameters.kind, x, y, 0)",
            "return Motion(2, own.goal[0], own.goal[1], 0) if own.role == 1 else Motion(2, 1.0, float(own.id), 0)",
        ).replace('"contacts"}', '"contacts", "goal"}')
        law = law_of(seeking)
        goals = np.array([[3.0, -4.0], [5.0, 6.0]])
        bands = [Band(law, 2), Band(law, 2, goals_w=goals, role=1)]
        history = run(bands, poses(np.zeros((4, 2)), [0.0, 0.0, 1.0, -2.0]), 1)
        assert_allclose(history.positions_w[-1], [[1.0, 0.0], [1.0, 1.0], *goals], atol=ROUNDING)

    def test_a_goal_that_is_nan_is_none(self) -> None:
        goals = np.array([[100.0, 0.0], [np.nan, np.nan]])
        band = Band(lawentry.load("couzin"), 2, {"noise_rad": 0.0, "omega": 5.0}, goals_w=goals)
        history = run(band, poses([[0.0, 0.0], [0.0, 50.0]], 2.0), 20, dt_s=0.2, speeds_m_s=3.0)
        assert abs(history.headings_w[-1, 0]) < 0.5
        assert history.headings_w[-1, 1] == pytest.approx(2.0)

    def test_two_laws_at_once(self) -> None:
        """Followers of Jadbabaie's law among members that go straight on: they take up their heading."""
        law = lawentry.load("jadbabaie-leader")
        speed = {"speed_m_s": 0.03, "range_m": 9.0}
        bands = [Band(law, 10, speed), told(10, {"kind": 4, "x": 0.0, "y": 0.03})]
        start = start_uniform(20, 2.0, np.random.default_rng(1))
        start[10:, 2] = 0.7
        for synchronous in (True, False):
            history = run(bands, start, 60, synchronous=synchronous)
            assert_allclose(history.headings_w[-1], 0.7, atol=1e-6)
            assert (history.headings_w[:, 10:] == 0.7).all()

    def test_graphs_say_who_is_in_whose_fixed_set(self) -> None:
        band = Band(lawentry.load("jadbabaie-leader"), 3, {"range_m": 9.0}, selection="fixed-set")
        start = poses(np.zeros((3, 2)), [0.0, 1.0, -1.0])
        graph = np.zeros((3, 3), dtype=bool)
        graph[0, 1] = True
        history = run(band, start, 1, graph=graph)
        assert_allclose(history.headings_w[-1], [0.5, 1.0, -1.0], atol=ROUNDING)
