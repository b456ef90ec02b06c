"""Sheepdog robots on their ways: where their rule sends them, by the routes of pilots, without their shyness.

A rule asks for places as if there were no walls, so that each becomes the nearest place in which a robot can stand,
and the way there goes round walls. Dogs may come as near to members as they like; off one another they keep as pilots
do.
"""

from __future__ import annotations

import math

import numpy as np

from flocking.types import Floats
from generation.free_space import crossed, distance
from generation.piloting import sheepdogs
from generation.piloting.pilots import Pilots
from generation.piloting.routes import CELL_M, Ground
from generation.piloting.task import Task

EVERY_S = 1.0
"""A dog is sent anew so often: a choice; a herd goes 0.25 m meanwhile, and planning is slow."""
ROOM_M = CELL_M / 2**0.5
"""Kept from walls besides a dog's radius: by half a cell's diagonal a way from cell to cell may cut a corner."""
BEHIND_M = 1.0
"""Of the first row of dogs at the start, behind the task's start: half a metre behind the last of a usual herd."""
APART_M = 0.4
"""Between dogs at the start: two radii of a Create, and 70 mm."""
CLEAR_M = 0.3
"""Of a dog at the start from walls: so that it can turn."""
_MOST_ROWS = 50


class Sheepdogs:
    """Dogs that drive a herd by one of the rules, over ground in which they have `ROOM_M` besides their radius."""

    def __init__(self, over: Ground, count: int, rule: str) -> None:
        self.over, self.rule = over, rule
        self._ways, self._sent = Pilots(over, count), -math.inf

    def targets(self, time: float, dogs: Floats, herd: Floats, goal: Floats) -> Floats:
        """(D, 2) where dogs at (D, 2) drive to now, m, for the members at (M, 2) that are to go to a goal (2,)."""
        if time - self._sent >= EVERY_S - 1e-9:
            wanted = sheepdogs.targets(self.rule, dogs, herd, goal)
            places = np.array([self.over.centres[self.over.cell(place)] for place in wanted])
            self._ways.send(np.arange(len(dogs)), places)
            self._sent = time
        return self._ways.targets(time, dogs, np.empty((0, 2)))


def starts(task: Task, count: int) -> Floats:
    """(count, 2) places behind a task's start, against its direction, m: in rows, clear of walls and within sight.

    Fewer where a street ends before.
    """
    start, walls = np.array([task.start.x_m, task.start.y_m]), task.environment.walls()
    ahead = np.array([math.cos(task.start.heading_rad), math.sin(task.start.heading_rad)])
    side, aside = np.array([-ahead[1], ahead[0]]), APART_M * np.array([0.0, 1.0, -1.0])
    rows = BEHIND_M + APART_M * np.arange(_MOST_ROWS)
    places = np.concatenate([start - back * ahead + aside[:, None] * side for back in rows])
    free = ~crossed(walls, start, places) & (distance(walls, places) >= CLEAR_M)
    return np.asarray(places[free][:count])
