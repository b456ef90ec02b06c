"""Formations along walls, and assignments against all permutations."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from flocking.errors import InputError
from flocking.types import Floats
from generation.piloting import task as tasks
from generation.piloting.formations import assigned, at_first, change, has_room, slots
from generation.piloting.plan import Plan, Wall

PLAN = Plan("task-1", False, (Wall(27, 315.0, 0.75), Wall(22, 135.0, 0.75), Wall(45, 315.0, 0.75)))


@pytest.mark.parametrize("robots", [1, 2, 3, 6])
def test_robots_stand_at_equal_distances_about_the_middle_of_the_wall(robots: int) -> None:
    places = slots(np.array([1.0, 2.0, 4.0, 6.0]), robots)  # 5 m long
    assert_allclose(places.mean(axis=0), [2.5, 4.0])
    steps = np.hypot(*np.diff(places, axis=0).T)
    assert_allclose(steps, 5.0 / robots)
    assert_allclose(np.hypot(*(places[0] - [1.0, 2.0])), 2.5 / robots)


def brute(places: Floats, targets: Floats) -> tuple[float, float, float]:
    """The least sum; the least longest way; and the least sum among those that have that longest way."""
    ways = np.hypot(*(targets[:, None] - places[None]).transpose(2, 0, 1))
    every = [ways[np.arange(len(targets)), list(p)] for p in itertools.permutations(range(len(places)), len(targets))]
    longest = min(way.max() for way in every)
    return min(w.sum() for w in every), longest, min(w.sum() for w in every if w.max() <= longest + 1e-12)


@pytest.mark.parametrize("seed", range(8))
def test_assignments_are_the_best_of_all(seed: int) -> None:
    rng = np.random.default_rng(seed)
    places, targets = rng.uniform(0.0, 5.0, (6, 2)), rng.uniform(0.0, 5.0, (4, 2))
    total, longest, total_of_longest = brute(places, targets)
    for objective, sum_, most in (("total", total, np.inf), ("largest", total_of_longest, longest)):
        robots = assigned(places, targets, objective)  # type: ignore[arg-type]
        assert len(set(robots.tolist())) == len(targets)
        ways = np.hypot(*(targets - places[robots]).T)
        assert ways.sum() == pytest.approx(sum_)
        assert ways.max() <= most + 1e-12


def test_who_stands_right_stays() -> None:
    places = np.random.default_rng(1).uniform(0.0, 5.0, (5, 2))
    assert_array_equal(assigned(places, places[[3, 0, 4]]), [3, 0, 4])


def test_fewer_pilots_than_places_are_refused() -> None:
    with pytest.raises(InputError, match="2 pilots for 3 places"):
        assigned(np.zeros((2, 2)), np.zeros((3, 2)))


@pytest.mark.parametrize(("pilots", "told"), [(5, "expected a multiple, as 6"), (2, "as 3"), (12, "at most 9")])
def test_a_number_of_pilots_that_makes_no_whole_walls_is_refused(pilots: int, told: str) -> None:
    with pytest.raises(InputError, match=told):
        at_first(tasks.load("task-1"), PLAN, pilots)


def test_six_pilots_hold_two_walls_of_three_and_those_of_the_next_wall_stay() -> None:
    task, places = tasks.load("task-1"), np.random.default_rng(2).uniform(0.0, 12.0, (6, 2))
    first = change(task, PLAN, 0, places)
    assert set(first.walls) == {0, 1}
    assert sorted(first.moving.tolist()) == list(range(6))
    places[first.moving] = first.places
    assert_allclose(places[first.walls[0]], slots(PLAN.walls[0].segment(task)))
    second = change(task, PLAN, 1, places, first.walls)
    assert_array_equal(second.walls[1], first.walls[1])  # the wall that goes on standing
    assert_array_equal(np.sort(second.moving), np.sort(first.walls[0]))
    places[second.moving] = second.places
    third = change(task, PLAN, 2, places, second.walls)
    assert set(third.walls) == {2}
    assert len(third.moving) == 0


def test_pilots_stand_in_their_first_formation_at_the_start() -> None:
    task = tasks.load("task-1")
    places = at_first(task, PLAN, 6)
    assert_allclose(places, np.concatenate([slots(wall.segment(task)) for wall in PLAN.walls[:2]]))
    moved = change(task, PLAN, 0, places)
    assert_allclose(places[moved.moving], moved.places)


def test_robots_have_room_along_a_wall_that_is_long_enough_and_off_others() -> None:
    corridor = np.array([[0.0, 0.0, 10.0, 0.0], [10.0, 2.0, 0.0, 2.0]])
    across = np.array([5.0, 0.4, 5.0, 1.6])
    assert has_room(corridor, across, 3, 0.165)  # 0.4 m apart
    assert not has_room(corridor, across, 4, 0.165)  # 0.3 m apart: less than two radii
    along = np.array([2.0, 0.1, 6.0, 0.1])
    assert not has_room(corridor, along, 3, 0.165)  # 0.1 m off a wall
