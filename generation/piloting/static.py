"""Whether any set of walls that stand all the time solves a task: every set of a grid, one wall a turn, is tried.

Members see walls within a known distance alone. So a stage depends on no wall that is farther from its leg of the
trajectory than that and the corridor, and a set is refused at the first stage that no member of any herd makes,
together with all sets that differ from it in walls that could not be seen in it. So nothing is left out that guides
anybody on course; members that went astray may come near walls that are not chosen yet, which they do not meet.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from flocking.errors import InputError
from flocking.types import Floats
from generation.group import Group
from generation.piloting import chain
from generation.piloting.chain import State
from generation.piloting.plan import Plan, Wall
from generation.piloting.planner import Grid, candidates
from generation.piloting.task import Task


class Exhausted(NamedTuple):
    """What trying all sets gave."""

    sets: int
    """Sets of walls in the grid: the product of the numbers of walls of all turns."""
    tried: int
    """Stages that were simulated, each with all herds, until no set was left."""
    best: float
    """The largest share of members that any set guided to the goal."""
    plan: Plan | None
    """The set that did; None where no set guided anybody."""


def exhaust(
    task: Task, group: Group, states: Sequence[State], step_m: float, sees_m: float, grid: Grid, budget: int = 100_000,
    say: Callable[[int, int], None] = lambda tried, sets: None,
) -> Exhausted:  # fmt: skip
    """Tries all sets with one wall a turn; a set fails at a stage that no member makes.

    `sees_m`: farthest that a member sees a wall. The stages of a set are simulated with all of its walls standing.
    Raises `InputError` where more than `budget` simulations of a stage, of one herd each, are needed.
    """
    choices = [candidates(task, turn, grid) for turn in task.turns]
    sets = int(np.prod([len(each) for each in choices]))
    search = _Exhaustive(task, group, step_m, sees_m, budget, choices, say, sets)
    search.go(tuple([None] * len(choices)), 0, states)
    return Exhausted(sets, search.tried, search.best, search.plan)


class _Exhaustive:
    def __init__(
        self, task: Task, group: Group, step_m: float, sees_m: float, budget: int, choices: list[list[Wall]],
        say: Callable[[int, int], None], sets: int,
    ) -> None:  # fmt: skip
        self.task, self.group, self.step_m, self.sees_m, self.budget = task, group, step_m, sees_m, budget
        self.choices, self.say, self.sets = choices, say, sets
        self.tried, self.best = 0, 0.0
        self.plan: Plan | None = None
        self.segments = [np.array([wall.segment(task) for wall in each]).reshape(-1, 4) for each in choices]

    def go(self, chosen: tuple[int | None, ...], number: int, states: Sequence[State]) -> None:
        """Takes herds through stage `number` among the walls chosen so far, and through the next ones.

        Walls are chosen once the herd comes near enough to where one of them could be to see it.
        """
        corner = chain.corners(self.task)[number]
        near = [turn for turn in range(len(chosen)) if chosen[turn] is None and self._near(turn, number)]
        for picked in itertools.product(*(range(len(self.choices[turn])) for turn in near)):
            whole = list(chosen)
            for turn, pick in zip(near, picked, strict=True):
                whole[turn] = pick
            self.tried += 1
            if self.tried * len(states) > self.budget:
                raise InputError(
                    f"task {self.task.name}: the {self.sets:,} sets take more than {self.budget:,} simulations of a "
                    f"stage; the best so far guides {self.best:.2f} of the members to the goal; expected a larger "
                    "budget, or a coarser grid"
                )
            if self.tried % 500 == 0:
                self.say(self.tried, self.sets)
            walls = np.array([self.segments[k][pick] for k, pick in enumerate(whole) if pick is not None])
            staged = chain.stage(self.task, self.group, walls.reshape(-1, 4), states, corner, self.step_m)
            made = chain.share(staged)
            if number == len(chosen):
                if made > self.best:
                    self.best, self.plan = made, self._plan(whole)
            elif made > 0.0:
                self.go(tuple(whole), number + 1, [each.state for each in staged])

    def _near(self, turn: int, number: int) -> bool:
        """Whether a herd on its course in a stage may see any wall that could be built at a turn."""
        line, corner = self.task.trajectory, chain.corners(self.task)[number]
        before = 0 if number == 0 else chain.corners(self.task)[number - 1]
        legs = [(line[k], line[k + 1]) for k in range(before, min(corner + 1, len(line) - 1))]
        ends = self.segments[turn].reshape(-1, 2)
        reach = self.sees_m + self.task.corridor_m
        return any(bool((_apart(ends, start, end) <= reach).any()) for start, end in legs)

    def _plan(self, whole: Sequence[int | None]) -> Plan:
        walls = tuple(self.choices[k][pick] for k, pick in enumerate(whole) if pick is not None)
        return Plan(self.task.name, True, walls)


def _apart(points: Floats, start: Floats, end: Floats) -> Floats:
    way = end - start
    part = np.clip((points - start) @ way / (way @ way), 0.0, 1.0)
    return np.hypot(*(points - start - part[:, None] * way).T)
