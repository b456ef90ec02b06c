"""Rules of sheepdogs: closed forms, what must not matter, limits, and a herd of points that flees."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from flocking.types import Floats
from generation.piloting.sheepdogs import RULES, Strombom, Vaughan, strombom, targets, vaughan

EXACT = 1e-9
"""m: rounding of a few operations on lengths of some metres."""
GOAL = np.array([5.0, 1.0])


def moved(places: Floats) -> Floats:
    """Turned about the origin, and put elsewhere."""
    c, s = math.cos(1.1), math.sin(1.1)
    return np.asarray(places @ np.array([[c, s], [-s, c]]) + np.array([3.0, -2.0]))


def drawn(seed: int) -> tuple[Floats, Floats]:
    """Three dogs, and four members: by turns gathered and so spread that some are to be collected."""
    rng = np.random.default_rng(seed)
    return rng.uniform(-4.0, 0.0, (3, 2)), rng.normal(0.0, (0.3, 2.0)[seed % 2], (4, 2))


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("rule", RULES)
class TestWhatMustNotMatter:
    def test_where_the_world_lies(self, rule: str, seed: int) -> None:
        dogs, herd = drawn(seed)
        there = targets(rule, moved(dogs), moved(herd), moved(GOAL))
        assert_allclose(there, moved(targets(rule, dogs, herd, GOAL)), atol=EXACT)

    def test_left_and_right(self, rule: str, seed: int) -> None:
        dogs, herd = drawn(seed)
        flip = np.array([1.0, -1.0])
        assert_allclose(
            targets(rule, dogs * flip, herd * flip, GOAL * flip), targets(rule, dogs, herd, GOAL) * flip, atol=EXACT
        )

    def test_the_order_of_members_and_of_dogs(self, rule: str, seed: int) -> None:
        dogs, herd = drawn(seed)
        found = targets(rule, dogs, herd, GOAL)
        assert_allclose(targets(rule, dogs, herd[::-1], GOAL), found, atol=EXACT)
        assert_allclose(targets(rule, dogs[[2, 0, 1]], herd, GOAL), found[[2, 0, 1]], atol=EXACT)


class TestVaughan:
    def test_a_dog_rests_behind_the_centre_as_seen_from_the_goal(self) -> None:
        """1 m behind: there 1 m of attraction is the sum of 0.5 m off the goal and 0.5 m³/m² off the flock."""
        herd, goal = np.array([[1.0, 0.5], [1.0, -0.5]]), np.array([4.0, 0.0])
        assert_allclose(vaughan(np.array([[0.0, 0.0]]), herd, goal), [[0.0, 0.0]], atol=EXACT)

    @pytest.mark.parametrize("angle", np.linspace(0.2, 2.0 * math.pi - 0.2, 7))
    def test_it_comes_to_rest_there_from_all_sides(self, angle: float) -> None:
        """From all but the line to the goal, on which the terms balance before the flock as well."""
        herd, dog = np.zeros((4, 2)), np.array([[2.5 * math.cos(angle), 2.5 * math.sin(angle)]])
        for _ in range(400):
            dog += 0.1 * (vaughan(dog, herd, np.array([5.0, 0.0])) - dog)
        assert_allclose(dog, [[-1.0, 0.0]], atol=1e-3)  # a rest that is approached exponentially

    def test_terms_one_by_one(self) -> None:
        dog, herd, goal = np.array([[2.0, 0.0]]), np.array([[0.0, 0.0]]), np.array([2.0, 3.0])
        none = Vaughan(0.0, 0.0, 0.0, 0.0, math.inf)
        for given, way in (
            (none._replace(attraction=0.5), [-1.0, 0.0]),
            (none._replace(repulsion_m3=2.0), [0.5, 0.0]),
            (none._replace(goal_m=0.7), [0.0, -0.7]),
        ):
            assert_allclose(vaughan(dog, herd, goal, given._replace(longest_m=10.0)) - dog, [way], atol=EXACT)

    def test_dogs_push_one_another_off_alike(self) -> None:
        dogs, herd = np.array([[-1.0, 0.2], [-1.0, -0.2]]), np.zeros((1, 2))
        both = vaughan(dogs, herd, np.array([5.0, 0.0]))
        alone = np.concatenate([vaughan(dog[None], herd, np.array([5.0, 0.0])) for dog in dogs])
        assert_allclose(both - alone, [[0.0, 0.1 / 0.4**2], [0.0, -0.1 / 0.4**2]], atol=EXACT)

    def test_a_dog_at_the_centre_leaves_it_away_from_the_goal(self) -> None:
        assert_allclose(vaughan(np.zeros((1, 2)), np.zeros((3, 2)), np.array([5.0, 0.0])), [[-1.0, 0.0]], atol=EXACT)

    def test_the_way_is_never_longer_than_the_longest(self) -> None:
        dogs = np.array([[-50.0, 3.0], [0.0, 1e-7], [1.0, 1.0]])
        ways = vaughan(dogs, np.zeros((2, 2)), GOAL) - dogs
        assert (np.hypot(*ways.T) <= 1.0 + EXACT).all()


class TestStrombom:
    def test_a_gathered_herd_is_driven_from_behind_its_centre(self) -> None:
        herd = np.array([[0.3, 0.0], [-0.3, 0.0], [0.0, 0.3], [0.0, -0.3]])
        assert_allclose(strombom(np.array([[-3.0, 0.0]]), herd, np.array([5.0, 0.0])), [[-0.6 * 2.0, 0.0]], atol=EXACT)

    def test_of_a_spread_herd_the_farthest_is_collected_from_beyond(self) -> None:
        herd = np.array([[0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 4.0]])  # 3 m from the centre; f(4) = 1.51 m
        assert_allclose(strombom(np.array([[-3.0, 0.0]]), herd, np.array([5.0, 0.0])), [[0.0, 4.6]], atol=EXACT)

    def test_it_changes_at_the_published_size(self) -> None:
        most = 4 ** (2.0 / 3.0)
        for size, collects in ((0.999 * most, False), (1.001 * most, True)):
            herd = size * np.array([[0.0, 1.0], [0.0, -1.0], [0.0, 0.5], [0.0, -0.5]])
            place = strombom(np.zeros((1, 2)), herd, np.array([5.0, 0.0]), Strombom(r_a_m=1.0))[0]
            assert (abs(place[1]) > size) == collects

    def test_several_collect_one_each_and_the_others_drive_side_by_side(self) -> None:
        herd = np.array([[0.0, 3.0], [0.0, -3.0], [0.1, 0.0], [-0.1, 0.0]])
        dogs = np.array([[-3.0, 0.1], [0.0, 5.0], [-3.0, -0.1], [0.0, -5.0]])
        places = strombom(dogs, herd, np.array([5.0, 0.0]))
        assert_allclose(places[[1, 3]], [[0.0, 3.6], [0.0, -3.6]], atol=EXACT)
        assert_allclose(np.hypot(*places[[0, 2]].T), 1.2, atol=EXACT)
        assert_allclose(places[0] - places[2], [0.0, 0.5], atol=EXACT)

    def test_one_member_is_driven_whatever_the_distance(self) -> None:
        assert_allclose(
            strombom(np.array([[9.0, 9.0]]), np.array([[1.0, 0.0]]), np.array([5.0, 0.0])), [[0.4, 0.0]], atol=EXACT
        )


@pytest.mark.parametrize("rule", RULES)
class TestLimits:
    @pytest.mark.parametrize("count", [1, 3, 6])
    def test_coincident_members_and_a_dog_among_them(self, rule: str, count: int) -> None:
        """Dogs on a line through it, the middle one on it where there is one."""
        dogs = np.column_stack([np.zeros(count), 0.5 * (np.arange(count) - count // 2)])
        assert np.isfinite(targets(rule, dogs, np.zeros((4, 2)), np.array([5.0, 0.0]))).all()

    def test_a_herd_at_its_goal_is_left_there(self, rule: str) -> None:
        dogs = np.array([[0.0, 0.0]])
        assert_array_equal(targets(rule, dogs, np.zeros((4, 2)), np.zeros(2)), dogs)

    @pytest.mark.parametrize("count", [1, 3])
    def test_dogs_that_are_behind_stay_behind(self, rule: str, count: int) -> None:
        herd, goal = np.random.default_rng(3).uniform(-0.4, 0.4, (4, 2)), np.array([5.0, 0.0])
        dogs = np.column_stack([np.full(count, -1.2), 0.5 * (np.arange(count) - (count - 1) / 2)])
        assert (targets(rule, dogs, herd, goal)[:, 0] < herd.mean(axis=0)[0]).all()

    @pytest.mark.parametrize("count", [1, 3])
    def test_a_herd_of_points_that_flees_is_brought_to_its_goal(self, rule: str, count: int) -> None:
        """Members that flee dogs within 1.5 m at 0.25 m/s, keep 0.3 m apart and hold together, as both rules take for
        granted; dogs start on the goal's side of them and drive at 0.4 m/s."""
        rng, goal, step = np.random.default_rng(count), np.array([6.0, 2.0]), 0.1
        herd, dogs = rng.uniform(-0.5, 0.5, (4, 2)), rng.uniform([2.3, -2.2], [2.7, -1.8], (count, 2))
        nearest = math.inf
        for _ in range(1500):
            ways = np.zeros_like(herd)
            for others, reach in ((dogs, 1.5), (herd, 0.3)):
                apart = herd[:, None] - others[None]
                far = np.hypot(*apart.transpose(2, 0, 1))[..., None]
                ways += np.where(far < reach, apart / np.maximum(far, 1e-9), 0.0).sum(axis=1)
            if ways.any():
                ways += 2.0 * (herd.mean(axis=0) - herd)
            herd = herd + 0.25 * step * ways / np.maximum(np.hypot(*ways.T), 1.0)[:, None]
            way = targets(rule, dogs, herd, goal) - dogs
            dogs = dogs + way * np.minimum(1.0, 0.4 * step / np.maximum(np.hypot(*way.T), 1e-9))[:, None]
            nearest = min(nearest, float(np.hypot(*(herd - goal).T).max()))
        assert nearest < 1.0  # all at once within the herd's own size of the goal, 6 m from where they began
