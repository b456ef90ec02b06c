"""Herds told of desired velocities that look every so many steps: held against the kinematic herd and closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from flocking import lawentry
from flocking.errors import InputError
from flocking.herding import HerdMind, MovingHerd
from flocking.herding.loop import no_touching
from flocking.herding.sight import bound_of, keep_k_nearest
from flocking.kinematic import Band, LawFailedError, Schedule, simulate
from flocking.kinematic.bands import Space
from flocking.perception import keep_nearest
from flocking.types import Floats

LAW = "hodgins-brogan"


def scattered(count: int, seed: int, side: float = 8.0) -> Floats:
    """Places that are far enough apart for no shock to run through the herd."""
    rng = np.random.default_rng(seed)
    rows = math.ceil(math.sqrt(count))
    grid = np.array([(x, y) for x in range(rows) for y in range(rows)], dtype=np.float64)[:count]
    return grid * side / rows + rng.uniform(-0.2, 0.2, (count, 2))


def moving(positions: Floats, velocities: Floats, user: bool = False, **parameters: Any) -> MovingHerd:
    roles = np.zeros(len(positions), np.int64)
    roles[0] = user
    each = [parameters] * len(positions)
    return MovingHerd(lawentry.load(LAW), positions, velocities, each, roles=roles)


def draws(steps: int, count: int) -> Floats:
    return np.empty((steps, count, 0))


class TestSight:
    def test_a_bound_holds_k_of_the_distances_unless_ties_leave_none(self) -> None:
        rng = np.random.default_rng(1)
        for count in (2, 3, 17, 104):
            for trial in range(40):
                values = (
                    rng.uniform(0.0, 600.0, count) if trial % 2 else rng.integers(0, count + 1, count).astype(float)
                )
                values = np.append(values, math.inf)  # who is not looked at
                for k in {1, (count + 1) // 2, count - 1}:
                    bound = bound_of(values, count, k)
                    kth, next_ = np.sort(values)[k - 1 : k + 1]
                    assert kth <= bound < next_ if kth < next_ else math.isnan(bound)

    def test_the_nearest_are_those_that_looking_k_times_finds(self) -> None:
        rng = np.random.default_rng(2)
        for count in (0, 1, 5, 40):
            for k in (0, 1, 4, 30, 50):
                places = rng.integers(-3, 4, (count, 2)).astype(np.float64)  # many are equally far
                seen = rng.random(count) < 0.8
                expected, found = seen.copy(), seen.copy()
                keep_nearest(places, k, expected)
                keep_k_nearest(places, k, found, np.empty(count))
                assert_array_equal(found, expected)

    def test_only_those_who_are_there_are_seen(self) -> None:
        herd = moving(scattered(9, 3), np.zeros((9, 2)))
        herd.there[4] = False
        herd.look()
        for i in range(9):
            seen = set(herd.herd.seen[i, : herd.herd.counts[i]].tolist())
            assert seen == set(range(9)) - {4, i}


class TestPointMasses:
    @pytest.mark.parametrize("selection", ["all", "unoccluded(0.3)", "angle(120)"])
    def test_they_are_the_kinematic_herd(self, selection: str) -> None:
        """Both engines, with everybody looking at each step; the order of the sums over neighbours may differ."""
        count, dt, steps = 25, 0.02, 50
        law, places = lawentry.load(LAW), scattered(25, 4)
        poses = np.column_stack([places, np.zeros(count)])
        band = Band(law, count, {"visible": 7}, selection=selection)
        rng = np.random.default_rng(1)
        history = simulate(band, poses, Schedule(dt, steps), rng=rng, space=Space(), speeds_m_s=1.0)
        velocities = np.tile([1.0, 0.0], (count, 1))
        herd = MovingHerd(law, places, velocities, [{"visible": 7}] * count, text=selection)
        for step in range(steps):
            herd.look()
            herd.advance(draws(1, count), step, dt, no_touching(count, 0.1))
        # rounding of 1e-16 of a sum of seven grows by the herd's own swings, e-fold in a second or slower
        assert_allclose(herd.herd.positions, history.positions_w[-1], atol=1e-9)

    def test_looking_every_tenth_step_changes_little_and_something(self) -> None:
        ends = []
        for every in (1, 10):
            herd = moving(scattered(36, 5), np.tile([2.0, 0.0], (36, 1)), visible=6)
            for step in range(0, 200, every):
                herd.look()
                herd.advance(draws(every, 36), step, 0.005, no_touching(36, 0.1))
            ends.append(herd.herd.positions.copy())
        assert 0.0 < np.abs(ends[0] - ends[1]).max() < 0.5  # they ran 2 m

    def test_one_alone_keeps_its_velocity_and_the_users_does_as_told(self) -> None:
        for user in (False, True):
            herd = moving(np.zeros((1, 2)), np.array([[1.0, 0.5]]), user)
            herd.send(0, np.array([0.0, -2.0]))
            herd.look()
            herd.advance(draws(100, 1), 0, 0.01, no_touching(1, 0.5))
            assert_allclose(herd.herd.positions[0], [0.0, -2.0] if user else [1.0, 0.5], atol=1e-12)

    def test_with_nobody_visible_each_is_alone(self) -> None:
        places, velocities = scattered(9, 6), np.random.default_rng(1).normal(size=(9, 2))
        herd = moving(places, velocities, visible=0)
        herd.look()
        assert (herd.herd.counts == 0).all()
        herd.advance(draws(50, 9), 0, 0.02, no_touching(9, 0.1))
        assert_allclose(herd.herd.positions, places + velocities, atol=1e-12)

    def test_the_user_stands_where_it_is_told_to_stand(self) -> None:
        herd = moving(np.zeros((1, 2)), np.array([[1.0, 0.0]]), user=True)
        herd.send(0, np.zeros(2))
        herd.look()
        herd.advance(draws(10, 1), 0, 0.1, no_touching(1, 0.5))
        assert_array_equal(herd.herd.positions, np.zeros((1, 2)))


class TestTold:
    def test_the_nominal_velocity_is_the_mean_of_the_desired_ones(self) -> None:
        """Without spring and damper that is all there is."""
        rng, count = np.random.default_rng(7), 6
        desired, actual = rng.normal(size=(count, 2)), rng.normal(size=(count, 2))
        for tells, velocities in ((True, desired), (False, actual)):
            each = [{"kp_per_s": 0.0, "kv": 0.0}] * count
            herd = HerdMind(lawentry.load(LAW), scattered(count, 8), desired, each, tells=tells)
            herd.herd.actual[:] = actual
            herd.look()
            herd.decide(np.ones(count, np.bool_), np.empty((count, 0)), 0.005)
            means = (velocities.sum(axis=0) - velocities) / (count - 1)
            assert_allclose(herd.herd.desired, means, atol=1e-12)

    def test_the_damper_knows_actual_velocities(self) -> None:
        """What is desired changes nothing of it but the mean."""
        rng, count = np.random.default_rng(9), 6
        actual, found = rng.normal(size=(count, 2)), []
        for desired in (np.zeros((count, 2)), np.tile([3.0, 1.0], (count, 1))):
            herd = HerdMind(lawentry.load(LAW), scattered(count, 8), desired, [{"limit_m_s": 1e3}] * count)
            herd.herd.actual[:] = actual
            herd.look()
            herd.decide(np.ones(count, np.bool_), np.empty((count, 0)), 0.005)
            found.append(herd.herd.desired.copy())
        assert_allclose(found[1] - found[0], np.tile([3.0, 1.0], (count, 1)), atol=1e-12)

    def test_only_those_decide_who_may(self) -> None:
        herd = HerdMind(lawentry.load(LAW), scattered(4, 1), np.zeros((4, 2)), [{}] * 4)
        herd.look()
        herd.decide(np.array([True, False, True, False]), np.empty((4, 0)), 0.005)
        assert (np.abs(herd.herd.desired).sum(axis=1) > 0).tolist() == [True, False, True, False]

    def test_an_error_about_a_place_is_a_neighbour_that_stands_there(self) -> None:
        places, error = np.array([[0.0, 0.0], [4.0, 0.0]]), np.zeros((2, 2, 2))
        error[0, 1] = [0.0, 3.0]
        wrong, right = (moving(p, np.zeros((2, 2))) for p in (places, places + np.array([[0.0, 0.0], [0.0, 3.0]])))
        wrong.look(error)
        right.look()
        for herd in (wrong, right):
            herd.decide(np.array([True, False]), np.empty((2, 0)), 0.01)
        assert_allclose(wrong.herd.desired[0], right.herd.desired[0], atol=1e-12)


class TestTouches:
    def test_two_that_pass_touch_once_and_how_near_is_known(self) -> None:
        places = np.array([[-1.0, 0.0], [1.0, 0.3]])
        herd = moving(places, np.array([[1.0, 0.0], [-1.0, 0.0]]), visible=0)
        touching = no_touching(2, 0.5, 10)
        herd.look()
        herd.advance(draws(200, 2), 0, 0.01, touching)
        assert touching.found[0] == 1
        assert touching.closest[0] == pytest.approx(0.3, abs=1e-9)
        # 2 - 2 t = 0.4 across, where 0.3² + 0.4² = 0.5²; noted at the end of the step in which it is less
        assert touching.times[0] == pytest.approx(0.81, abs=0.011)
        assert_allclose(touching.places[0], [0.0, 0.15], atol=1e-9)

    def test_more_than_there_is_room_for_are_counted(self) -> None:
        herd = moving(np.zeros((5, 2)), np.zeros((5, 2)), visible=0)
        touching = no_touching(5, 0.5, 3)
        herd.touches(touching, 0.0)
        assert touching.found[0] == 10

    def test_who_is_not_there_touches_nobody(self) -> None:
        herd = moving(np.zeros((3, 2)), np.zeros((3, 2)))
        herd.there[1] = False
        touching = no_touching(3, 0.5, 3)
        herd.touches(touching, 0.0)
        assert touching.pairs[: touching.found[0]].tolist() == [[0, 2]]


class TestRefuses:
    @pytest.mark.parametrize(
        ("law", "text", "words"),
        [
            ("couzin", "all", "expected a law with one"),
            (LAW, "voronoi", "expected none of fixed-set and voronoi"),
            (LAW, "fixed-set(1)", "expected none of fixed-set and voronoi"),
        ],
    )
    def test_what_it_cannot_select_by(self, law: str, text: str, words: str) -> None:
        with pytest.raises(InputError, match=words):
            MovingHerd(lawentry.load(law), np.zeros((2, 2)), np.zeros((2, 2)), [{}] * 2, text=text)

    def test_places_that_are_none(self) -> None:
        with pytest.raises(InputError, match="expected"):
            MovingHerd(lawentry.load(LAW), np.full((2, 2), np.nan), np.zeros((2, 2)), [{}] * 2)

    def test_a_law_that_gives_no_number_is_named_with_member_and_step(self) -> None:
        herd = moving(scattered(3, 1), np.zeros((3, 2)))
        herd.look()
        herd.herd.desired[2] = math.nan  # what its neighbours hear of it
        with pytest.raises(LawFailedError, match="for member 1 at step 6"):
            herd.advance(draws(1, 3), 5, 0.01, no_touching(3, 0.1))
