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


def of_wall(number: int) -> Floats:
    return slots(PLAN.walls[number].segment(tasks.load(PLAN.task)))


def test_six_pilots_hold_two_walls_of_three_and_those_of_the_next_wall_stay() -> None:
    task, places = tasks.load("task-1"), np.random.default_rng(2).uniform(0.0, 12.0, (6, 2))
    first = change(task, PLAN, 0, places)
    assert list(first.walls) == [0, 1]
    assert sorted(first.moving.tolist()) == list(range(6))
    assert_allclose(first.places, np.concatenate([of_wall(0), of_wall(1)]))
    assert_array_equal(first.moving, np.concatenate([first.walls[0], first.walls[1]]))
    second = change(task, PLAN, 1, places, first.walls)
    assert list(second.walls) == [1, 2]
    assert_array_equal(second.walls[1], first.walls[1])  # of the wall that goes on standing
    assert_array_equal(np.sort(second.moving), np.sort(first.walls[0]))
    assert_allclose(second.places, of_wall(2))
    third = change(task, PLAN, 2, places, second.walls)
    assert list(third.walls) == [2]
    assert_array_equal(third.walls[2], second.walls[2])
    assert len(third.moving) == len(third.places) == 0


def test_those_who_stand_at_their_places_hold_them() -> None:
    task = tasks.load("task-1")
    start = at_first(task, PLAN, 6)
    assert_allclose(start, np.concatenate([of_wall(0), of_wall(1)]))
    held = change(task, PLAN, 0, start)
    assert_array_equal(held.moving, np.arange(6))
    assert_allclose(held.places, start)


@pytest.mark.parametrize("pilots", [3, 6, 9])
def test_as_many_walls_stand_first_as_there_are_pilots_for(pilots: int) -> None:
    at = at_first(tasks.load("task-1"), PLAN, pilots)
    assert_allclose(at, np.concatenate([of_wall(k) for k in range(pilots // 3)]))


@pytest.mark.parametrize(
    ("pilots", "told"),
    [
        (0, "expected a multiple, as 3"),
        (2, "expected a multiple, as 3"),
        (5, "as 6"),
        (7, "as 6"),
        (12, "expected at most 9"),
    ],
)
def test_pilots_that_make_no_whole_walls_or_too_many_are_refused_in_one_line(pilots: int, told: str) -> None:
    with pytest.raises(InputError, match=told) as refused:
        at_first(tasks.load("task-1"), PLAN, pilots)
    assert "\n" not in str(refused.value)


def test_room_along_a_wall_is_two_radii_a_robot_and_one_to_other_walls() -> None:
    wall = np.array([0.0, 0.0, 1.2, 0.0])
    far = np.array([[0.0, 5.0, 1.0, 5.0]])
    assert has_room(far, wall, 3, 0.199)  # 0.4 m from one to the next
    assert not has_room(far, wall, 3, 0.201)
    assert not has_room(far, wall, 4, 0.165)
    assert has_room(far, wall * 0.2, 1, 0.165)  # one alone needs no length
    for off, room in ((0.166, True), (0.164, False)):  # a wall that ends beside the first robot, 0.2 m along
        assert has_room(np.array([[0.2, off, 0.2, 2.0]]), wall, 3, 0.165) is room
