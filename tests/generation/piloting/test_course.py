"""How far along a trajectory members have come, against ways that are known."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from flocking.types import Floats
from generation.piloting import task as tasks
from generation.piloting.course import arrived, course, fitness, passed
from generation.piloting.task import Task


def along(line: Floats, step_m: float = 0.1) -> Floats:
    """(T, 2) places along a polyline."""
    pieces = [
        a + (b - a) * np.arange(0.0, 1.0, step_m / np.hypot(*(b - a)))[:, None] for a, b in itertools.pairwise(line)
    ]
    return np.vstack([*pieces, line[-1:]])


@pytest.fixture(params=tasks.names())
def task(request: pytest.FixtureRequest) -> Task:
    return tasks.load(request.param)


def test_who_goes_along_the_trajectory_arrives_and_who_stays_does_not(task: Task) -> None:
    way = along(task.trajectory)
    positions = np.stack([way, np.broadcast_to(way[0], way.shape)], axis=1)
    assert_array_equal(arrived(task, positions, course(task, positions)), [True, False])
    assert fitness(task, positions) == 0.5


def test_who_stays_within_the_corridor_is_on_course_and_who_leaves_it_is_astray_for_good(task: Task) -> None:
    way = along(task.trajectory)
    # a shift along a leg costs nothing, and one across it must stay below the corridor's half width
    for aside, lost in ((0.99, False), (1.01, True)):
        shifted = way[:10] + aside * task.corridor_m * _across(task)
        of = course(task, np.concatenate([shifted, way])[:, None])
        assert bool(of.astray[9, 0]) is lost
        assert bool(of.astray[-1, 0]) is lost


def _across(task: Task) -> Floats:
    way = task.trajectory[1] - task.trajectory[0]
    return np.array([-way[1], way[0]]) / np.hypot(*way)


def test_legs_count_in_their_order(task: Task) -> None:
    of = course(task, along(task.trajectory)[:, None])
    assert_array_equal(np.unique(of.leg), np.arange(len(task.trajectory) - 1))
    assert (np.diff(of.leg[:, 0]) >= 0).all()
    backwards = course(task, along(task.trajectory)[::-1, None])
    assert backwards.leg.max() != len(task.trajectory) - 2 or backwards.astray.any()


def test_a_shortcut_over_a_crossing_is_no_way_to_the_goal() -> None:
    task = tasks.load("task-3")  # it passes its first crossing twice
    line = task.trajectory
    short = along(np.array([line[0], line[1], line[-1]]))
    assert fitness(task, short[:, None]) == 0.0


def test_cutting_a_way_in_two_changes_nothing(task: Task) -> None:
    positions = along(task.trajectory)[:, None] + np.array([[0.2, -0.3], [1.4, 0.0]])
    whole = course(task, positions)
    for cut in (1, len(positions) // 2):
        first = course(task, positions[:cut])
        second = course(task, positions[cut:], first.leg[-1], first.astray[-1])
        assert_array_equal(np.concatenate([first.leg, second.leg]), whole.leg)
        assert_array_equal(np.concatenate([first.astray, second.astray]), whole.astray)


def test_a_turn_is_passed_at_the_distance_that_is_asked_for(task: Task) -> None:
    way = along(task.trajectory, 0.05)
    turn = task.turns[0]
    of = course(task, way[:, None])
    first = int(np.argmax(passed(task, way[:, None], of, turn, 1.2)[:, 0]))
    # the way is sampled every 0.05 m
    assert np.hypot(*(way[first] - task.trajectory[turn])) == pytest.approx(1.2, abs=0.051)


def test_the_course_turns_with_the_world(task: Task) -> None:
    rng = np.random.default_rng(3)
    positions = along(task.trajectory)[:, None] + rng.normal(0.0, 0.3, (1, 5, 2))
    turned = dataclasses.replace(task, environment=task.environment.moved(turn_rad=0.7, x_m=3.0, y_m=-2.0))
    c, s = np.cos(0.7), np.sin(0.7)
    there = positions @ np.array([[c, s], [-s, c]]) + [3.0, -2.0]
    assert_array_equal(course(turned, there).leg, course(task, positions).leg)
    assert fitness(turned, there) == fitness(task, positions)
