"""Robots as a group: they start where the job has them, at the stated scale, and several processes change nothing."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from flocking.errors import InputError
from generation import behaviours
from generation.environment import Environment
from generation.group import Job
from generation.primitives import Point, Segment
from generation.validation.kinematic import kinematic
from generation.validation.starts import Starts
from generation.validation.validate import Plan, validate
from trials.environments.blocks import validated
from trials.environments.hands import in_order
from trials.environments.robots import robots

WALL = Environment(construct=(Segment(60.0, -60.0, 60.0, 60.0),), markers={"start": Point()})
POSES = np.array([[0.0, 0.0, 0.0], [0.0, 30.0, math.pi / 2], [0.0, -30.0, -math.pi / 2]])


def test_robots_start_where_they_are_put_and_go_at_their_speed() -> None:
    group = robots("random-motion", 3, law_parameters={"turn_rad": 0.0, "speed_m_s": 0.25}, scale=0.1)
    job = Job(dataclasses.replace(WALL, construct=()), POSES, (1,))
    (positions,) = group.trajectories([job], 5)
    assert positions.shape == (6, 3, 2)
    np.testing.assert_allclose(positions[0], POSES[:, :2], atol=1e-9)  # rounding of the scale
    way = positions[-1] - positions[0]
    headings = np.arctan2(way[:, 1], way[:, 0])
    # a robot's controller holds its course to a degree or two
    np.testing.assert_allclose(headings, POSES[:, 2], atol=math.radians(3.0))
    # 2 units an iteration, less the time that it takes to get going (0.3 s of the 4 s)
    assert np.hypot(*way.T) == pytest.approx(np.full(3, 10.0), rel=0.15)


def test_walls_stand_at_the_scale() -> None:
    group = robots("random-motion", 1, law_parameters={"turn_rad": 0.0}, scale=0.02, setup={"obstacles": "as-law"})
    (positions,) = group.trajectories([Job(WALL, POSES[:1], (1,))], 60)
    # 60 units of 2 cm are 1.2 m: the robot of radius 0.165 m stops before it, its bumper some millimetres in
    assert 0.02 * positions[-1, 0, 0] == pytest.approx(1.2 - 0.165, abs=0.06)


def test_processes_change_nothing() -> None:
    jobs = [Job(WALL, POSES, (k,)) for k in range(3)]
    here, there = (list(robots("snn", 3, jobs=n).trajectories(jobs, 5)) for n in (1, 2))
    for one, other in zip(here, there, strict=True):
        np.testing.assert_array_equal(one, other)
    group, plan = kinematic("reynolds-boids", 5), Plan(Starts(side_m=20.0), repeats=40)
    loaded = behaviours.load("simple-split")
    alone = validate([WALL] * 5, loaded, group, plan)
    for one, other in zip(alone, validated([WALL] * 5, "simple-split", group, plan, jobs=2), strict=True):
        np.testing.assert_array_equal(one.fitness, other.fitness)
        np.testing.assert_array_equal(one.control, other.control)
        assert one.number == other.number


def test_a_call_that_fails_fails_in_its_turn() -> None:
    found = in_order(math.sqrt, [(4.0,), (-1.0,), (9.0,)], 2)
    assert next(found) == 2.0
    with pytest.raises(ValueError, match="math domain error"):
        next(found)


def test_robots_that_overlap_are_refused() -> None:
    job = Job(WALL, np.zeros((2, 3)), (1,))
    with pytest.raises(InputError, match="overlap"):
        next(robots("snn", 2).trajectories([job], 5))
