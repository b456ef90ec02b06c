"""How far along a trajectory each member has come: the fitness of a task (Fine 2015, section 8.2).

The document counts the group's members that follow the trajectory; how near they must be is a choice: a member is on
its course while it is within the task's corridor of the leg that it is on. It is on the next leg once it comes within
the corridor of the corner where that begins. Legs count in their order, so that a trajectory may cross itself. Who
leaves the corridor is astray and stays so.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flocking.compilation import compiled
from flocking.types import Bools, Floats, Ints
from generation.free_paths import inside
from generation.piloting.task import Task


class Course(NamedTuple):
    """Where T moments of N members lie on a trajectory."""

    leg: Ints
    """(T, N) number of the leg, from 0."""
    astray: Bools
    """(T, N) whether it has left the corridor."""


def course(task: Task, positions: Floats, leg: Ints | None = None, astray: Bools | None = None) -> Course:
    """The course of members at positions (T, N, 2), m; `leg` (N,) and `astray` (N,): on which they begin."""
    count = positions.shape[1]
    legs = np.zeros((len(positions) + 1, count), np.int64)
    lost = np.zeros((len(positions) + 1, count), np.bool_)
    if leg is not None:
        legs[0] = leg
    if astray is not None:
        lost[0] = astray
    _follow(task.trajectory, task.corridor_m, np.ascontiguousarray(positions, dtype=np.float64), legs, lost)
    return Course(legs[1:], lost[1:])


@compiled
def _follow(line: Floats, corridor: float, positions: Floats, legs: Ints, astray: Bools) -> None:
    for t in range(len(positions)):
        for i in range(positions.shape[1]):
            x, y = positions[t, i, 0], positions[t, i, 1]
            leg, lost = legs[t, i], astray[t, i]
            while leg + 2 < len(line):
                dx, dy = x - line[leg + 1, 0], y - line[leg + 1, 1]
                if lost or dx * dx + dy * dy > corridor * corridor:
                    break
                leg += 1
            if not lost:
                lost = _apart(x, y, line[leg], line[leg + 1]) > corridor
                if lost and leg > 0:  # the corner belongs to both legs
                    lost = _apart(x, y, line[leg - 1], line[leg]) > corridor
            legs[t + 1, i], astray[t + 1, i] = leg, lost


@compiled
def _apart(x: float, y: float, start: Floats, end: Floats) -> float:
    ex, ey = end[0] - start[0], end[1] - start[1]
    squared = ex * ex + ey * ey
    part = ((x - start[0]) * ex + (y - start[1]) * ey) / squared if squared > 0.0 else 0.0
    part = min(1.0, max(0.0, part))
    return float(np.hypot(x - start[0] - part * ex, y - start[1] - part * ey))


def in_goal(task: Task, positions: Floats, of: Course) -> Bools:
    """(T, N) whether members at positions (T, N, 2) stand in the goal, on the last leg and not astray."""
    last = len(task.trajectory) - 2
    flat = inside(task.goal, positions.reshape(-1, 2)).reshape(positions.shape[:2])
    return np.asarray(flat & (of.leg == last) & ~of.astray)


def arrived(task: Task, positions: Floats, of: Course) -> Bools:
    """(N,) which members at positions (T, N, 2) ever stood in the goal, on the last leg and not astray."""
    return np.asarray(in_goal(task, positions, of).any(axis=0))


def fitness(task: Task, positions: Floats) -> float:
    """The share of the members that follow the trajectory to the goal, of positions (T, N, 2) from the start on."""
    return float(np.mean(arrived(task, positions, course(task, positions))))


def passed(task: Task, positions: Floats, of: Course, turn: int, beyond_m: float) -> Bools:
    """(T, N) whether members have left a turn (a corner's number) behind, by that distance along the next leg."""
    corner, way = task.trajectory[turn], task.trajectory[turn + 1] - task.trajectory[turn]
    along = (positions - corner) @ (way / np.hypot(*way))
    return np.asarray((of.leg >= turn) & ~of.astray & ((along >= beyond_m) | (of.leg > turn)))
