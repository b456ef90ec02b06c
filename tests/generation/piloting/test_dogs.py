"""Sheepdogs in streets: where they start, and that they are sent round walls and never into them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from flocking.types import Floats
from generation.free_space import crossed, distance
from generation.piloting import dogs, sheepdogs
from generation.piloting import task as tasks
from generation.piloting.dogs import Sheepdogs
from generation.piloting.routes import CELL_M, Ground, ground

RADIUS_M = 0.165
TASK = tasks.load("task-1")
WALLS = TASK.environment.walls()


@pytest.fixture(scope="module")
def over() -> Ground:
    return ground(TASK.environment, RADIUS_M + dogs.ROOM_M)


@pytest.mark.parametrize("name", tasks.names())
def test_six_dogs_start_behind_the_herd_apart_and_clear_of_walls(name: str) -> None:
    task = tasks.load(name)
    places = dogs.starts(task, 6)
    assert len(places) == 6
    start = np.array([task.start.x_m, task.start.y_m])
    ahead = np.array([math.cos(task.start.heading_rad), math.sin(task.start.heading_rad)])
    assert ((places - start) @ ahead <= -dogs.BEHIND_M + 1e-9).all()
    apart = np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1))[np.triu_indices(6, 1)]
    assert apart.min() == pytest.approx(dogs.APART_M)
    assert distance(task.environment.walls(), places).min() >= dogs.CLEAR_M
    assert not crossed(task.environment.walls(), start, places).any()


def test_a_street_has_room_for_so_many() -> None:
    assert 6 < len(dogs.starts(TASK, 1000)) < 1000


def driven(over: Ground, rule: str, places: Floats, herd: Floats, goal: Floats, seconds: float) -> Floats:
    """(T, D, 2) where dogs that reach 0.4 m/s are each tenth of a second, m, about a herd that stands."""
    driver, found = Sheepdogs(over, len(places), rule), [places]
    for step in range(round(10.0 * seconds)):
        ways = driver.targets(0.1 * step, found[-1], herd, goal) - found[-1]
        lengths = np.hypot(*ways.T)[:, None]
        found.append(found[-1] + ways * np.minimum(1.0, 0.04 / np.maximum(lengths, 1e-9)))
    return np.array(found)


@pytest.mark.parametrize("count", [1, 3])
@pytest.mark.parametrize("rule", sheepdogs.RULES)
def test_dogs_never_touch_a_wall(over: Ground, rule: str, count: int) -> None:
    """Though places that are asked for lie within houses: the herd is about a corner, the goal aside of it."""
    herd, goal = TASK.trajectory[1] + np.array([[0.3, 0.2], [-0.3, 0.4], [0.0, 0.9], [0.4, -0.2]]), np.array([8.0, 8.0])
    ways = driven(over, rule, dogs.starts(TASK, count), herd, goal, 20.0)
    assert distance(WALLS, ways.reshape(-1, 2)).min() > RADIUS_M


def test_a_dog_goes_round_the_houses_to_the_far_side(over: Ground) -> None:
    """The herd comes back to it: the place behind is two corners away, and not across the house between."""
    herd, goal = np.array([[8.0, 6.0]]), np.array([8.0, 8.0])
    start = TASK.trajectory[0][None]
    ways = driven(over, sheepdogs.STROMBOM, start, herd, goal, 60.0)
    # behind by the published distance for one member, within a cell's half diagonal and what counts as arrived
    assert np.hypot(*(ways[-1, 0] - [8.0, 5.4])) < CELL_M / 2**0.5 + 0.1
    length = np.hypot(*np.diff(ways[:, 0], axis=0).T).sum()
    assert length > np.hypot(*(np.array([8.0, 5.4]) - start[0]))
