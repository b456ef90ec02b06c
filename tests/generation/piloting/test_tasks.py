"""Tasks as files: those that come with the project, and what is refused."""

from __future__ import annotations

import itertools
import json
from typing import Any

import numpy as np
import pytest

from flocking.errors import InputError
from generation.free_space import distance
from generation.piloting import task as tasks

WALLS = {"task-1": 3, "task-2": 4, "task-3": 5, "task-4": 3}
"""Fine 2015, section 8.2."""


def test_the_four_tasks_need_as_many_walls_as_published() -> None:
    assert {name: len(tasks.load(name).turns) for name in tasks.names()} == WALLS


@pytest.mark.parametrize("name", WALLS)
def test_a_tasks_trajectory_keeps_clear_of_its_walls(name: str) -> None:
    task = tasks.load(name)
    line = task.trajectory
    ways = np.vstack([a + (b - a) * np.linspace(0, 1, 200)[:, None] for a, b in itertools.pairwise(line)])
    # streets are 1.5 m wide and trajectories run along their middles
    assert distance(task.environment.walls(), ways).min() == pytest.approx(0.75, abs=1e-9)
    assert not task.environment.construct


def test_the_third_task_leaves_its_first_crossing_twice_by_different_streets() -> None:
    task = tasks.load("task-3")
    line = task.trajectory
    first, again = task.turns[0], task.turns[-1]
    assert np.array_equal(line[first], line[again])

    def way(k: int) -> np.ndarray:
        return (line[k + 1] - line[k]) / np.hypot(*(line[k + 1] - line[k]))

    # it comes by the same street both times, so that no walls that stand all the time can tell the two apart
    assert np.allclose(way(first - 1), way(again - 1))
    assert np.allclose(way(first), -way(again))


def given(**changed: Any) -> str:
    data = json.loads((tasks.FOLDER / "task-1.json").read_text())
    for key, value in changed.items():
        if value is None:
            del data[key]
        else:
            data[key] = value
    return json.dumps(data)


def with_marker(name: str, mark: Any) -> str:
    data = json.loads(given())
    data["environment"]["markers"][name] = mark
    return json.dumps(data)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("{", "no JSON"),
        ("[]", '"format": 1'),
        (given(format=2), '"format": 1'),
        (given(corridor_m=None), "lacks corridor_m"),
        (given(corridor_m=-1), "above 0"),
        (given(corridor_m=True), "above 0"),
        (given(goal=1), "unknown key"),
        (given(environment={"format": 1}), "unit"),
        (with_marker("goal", {"kind": "point", "x": 0, "y": 0}), "expected a polygon"),
        (with_marker("trajectory", {"kind": "polyline", "points": [[4, 2], [6, 6], [11, 8]]}), "leaves the workspace"),
        (with_marker("anchor-x", {"kind": "point", "x": 0, "y": 0}), "as in anchor-1"),
        (with_marker("trajectory", {"kind": "polyline", "points": [[8, 2], [8, 4], [11, 4]]}), "the start is"),
        (with_marker("trajectory", {"kind": "polyline", "points": [[4, 2], [4, 4], [8, 4]]}), "not in the goal"),
    ],
)  # fmt: skip
def test_a_file_that_is_no_task_is_refused_in_one_line(text: str, told: str) -> None:
    with pytest.raises(InputError, match=told) as refused:
        tasks.from_text(text, "mine")
    assert "\n" not in str(refused.value)


def test_an_unknown_task_is_refused_with_the_nearest() -> None:
    with pytest.raises(InputError, match="task-1"):
        tasks.load("task1")
    with pytest.raises(InputError, match="does not exist"):
        tasks.load("missing/task.json")
