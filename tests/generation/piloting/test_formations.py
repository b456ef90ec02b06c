"""Formations along walls, and assignments against all permutations."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from flocking.errors import InputError
from flocking.types import Floats
from generation.piloting import task as tasks
from generation.piloting.formations import assigned, changes, most_slots, slots
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
    with pytest.raises(InputError, match="pilots"):
        changes(tasks.load("task-1"), PLAN, np.zeros((5, 2)))


def test_six_pilots_hold_two_walls_of_three_and_those_of_the_next_wall_stay() -> None:
    task = tasks.load("task-1")
    assert most_slots(PLAN) == 6
    first, second, third = changes(task, PLAN, np.random.default_rng(2).uniform(0.0, 12.0, (6, 2)))
    assert len(first.robots) == len(second.robots) == 6
    assert len(third.robots) == 3
    assert_array_equal(first.robots[3:], second.robots[:3])  # of the wall that goes on standing
    assert_allclose(first.slots[3:], second.slots[:3])
    assert_array_equal(second.moving, np.sort(first.robots[:3]))
    assert len(third.moving) == 0
    for change in (first, second):
        assert sorted(change.robots.tolist()) == list(range(6))


def test_walls_that_stand_all_the_time_need_all_places_at_once() -> None:
    static = Plan(PLAN.task, True, PLAN.walls)
    assert most_slots(static) == 9
    first, *others = changes(tasks.load("task-1"), static, np.zeros((9, 2)))
    assert len(first.robots) == 9
    assert all(len(change.moving) == 0 for change in others)
