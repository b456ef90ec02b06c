"""Finds the walls that guide a herd through a task: walls of ITB at each turn, validated by simulation, chained.

Source: Fine 2015, section 8.2: for each task environments of a schema with a single wall (algorithm 8) are generated
and validated, and where no walls that stand all the time solve it, they are modified over time. How walls are chained
is a choice: turn by turn, the steadiest of a grid's valid walls first, back to the turn before where none does. A wall
is the steadier, the larger the mean share of it and its neighbours in the grid: other members, with other bodies, meet
it as if it stood somewhat otherwise.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from flocking.errors import InputError
from flocking.types import Floats
from generation.free_space import crossed, in_solid
from generation.group import Group
from generation.piloting import chain
from generation.piloting.chain import State
from generation.piloting.formations import has_room, slots
from generation.piloting.plan import ROBOTS_A_WALL, Plan, Wall, words
from generation.piloting.task import Task


class Grid(NamedTuple):
    """The walls that are tried at a turn."""

    angle_step_deg: float = 15.0
    lengths_m: tuple[float, ...] = (1.06, 1.5, 2.12)
    """Half of the diagonal of a crossing of streets 1.5 m wide, the street, and the diagonal. A choice."""
    robots: int = ROBOTS_A_WALL
    """Walls along which so many robots have no room are left out: they are to be held by robots as well."""
    radius_m: float = 0.165
    """Of such a robot: a Create's."""
    reach_m: float = 1.3
    """Farthest anchors from the turn, and farthest from it that a wall may end."""


class Search(NamedTuple):
    """How walls are searched for."""

    grid: Grid = Grid()
    starts: int = 6
    """Herds by which each wall is validated."""
    share: float = 0.95
    """Share of their members that have to make a turn for its wall to be valid. A choice."""
    whole: float = 0.9
    """Share of the members of new herds that a whole plan has to guide to the goal. A choice."""
    herds: int = 50
    """New herds by which a whole plan is judged. A choice: a share of 0.9 is then known to within 0.1."""
    robots: float = 0.75
    """Share of the robots that have to make a turn, where robots rank the walls. A choice."""
    breadth: int = 6
    """Valid walls of a turn that are gone on from, the best first."""
    budget: int = 100_000
    """Simulations of a stage, of one herd each, after which the search ends."""
    seed: int = 1
    side_m: float = 1.2
    """Side of the square in which herds start."""
    apart_m: float = 0.4
    """Least distance of members at the start; half of it from walls."""


USUAL = Search()


def fresh_herds(task: Task, count: int, how: Search) -> list[State]:
    """The herds of so many members by which whole plans are judged: none of them is used to find one."""
    return chain.starts(task, count, how.herds, how.seed + 1, how.side_m, how.apart_m)


@dataclass
class Progress:
    """What a search has done so far."""

    simulations: int = 0
    best: Plan | None = None
    """The longest chain of valid walls so far."""
    say: Callable[[str], None] = field(default=lambda line: None)


class _Valid(NamedTuple):
    """A valid wall of a turn."""

    share: float
    plan: Plan
    """That ends with it."""
    states: Sequence[State]
    """Herds from which the search goes on."""


class BudgetSpentError(InputError):
    """The budget is spent before a plan was found; the progress holds what there is."""


def candidates(task: Task, corner: int, grid: Grid) -> list[Wall]:
    """The walls of a grid at a corner of the trajectory, that lie in the workspace's free space and can be held.

    Walls that are the same segment from either of their ends are tried once.
    """
    at, walls = task.trajectory[corner], task.environment.walls()
    angles = np.arange(0.0, 360.0, grid.angle_step_deg)
    found: dict[tuple[float, ...], Wall] = {}
    for number, place in task.anchors.items():
        if np.hypot(*(place - at)) > grid.reach_m:
            continue
        for angle, length in itertools.product(angles, grid.lengths_m):
            wall = Wall(number, float(angle), float(length))
            segment = wall.segment(task)
            end = segment[2:]
            middle = segment[:2] + 1e-6 * (end - segment[:2]), segment[:2] + (1.0 - 1e-6) * (end - segment[:2])
            if np.hypot(*(end - at)) > grid.reach_m or crossed(walls, middle[0], middle[1][None])[0]:
                continue
            if not has_room(walls, segment, grid.robots, grid.radius_m):
                continue
            ends = sorted((tuple(segment[:2].round(3)), tuple(end.round(3))))
            found.setdefault((*ends[0], *ends[1]), wall)
    tried = list(found.values())
    if not tried:
        return []
    places = np.concatenate([slots(wall.segment(task), grid.robots) for wall in tried])
    within = in_solid(task.environment, places).reshape(len(tried), -1)
    return [wall for wall, slots_within in zip(tried, within, strict=True) if not slots_within.any()]


def steadiness(wall: Wall, shares: Mapping[Wall, float], grid: Grid) -> float:
    """The mean share of a wall and of its neighbours in the grid: at the same anchor, one step of angle or length away.

    `shares`: of the members that make the turn, of all walls that were tried.
    """
    near = [share for other, share in shares.items() if _beside(wall, other, grid)]
    return float(np.mean(near))


def _beside(wall: Wall, other: Wall, grid: Grid) -> bool:
    turned = abs(math.remainder(wall.angle_deg - other.angle_deg, 360.0))
    steps = abs(grid.lengths_m.index(wall.length_m) - grid.lengths_m.index(other.length_m))
    return wall.anchor == other.anchor and turned <= 1.001 * grid.angle_step_deg and steps <= 1


def search(
    task: Task,
    group: Group,
    step_m: float,
    how: Search = USUAL,
    static: bool = False,
    progress: Progress | None = None,
    begun: Plan | None = None,
    robots: Group | None = None,
) -> Plan:
    """A plan whose walls guide new herds to the goal, at least by the share that is asked for.

    `step_m`: way of a member in an iteration. `begun`: a partial plan, with whose walls it begins; where none goes on
    from it, its last walls are given up one by one.
    `robots`: a group by which the steadiest of the valid walls of a turn are ranked anew, as many as are gone on from.
    Raises `BudgetSpentError` where the budget is spent, and `InputError` where the grid is: `progress.best` is then the
    longest chain of valid walls.
    """
    progress, begun = progress or Progress(), begun or Plan(task.name, static, ())
    if begun.walls:
        progress.best = begun
    states = chain.starts(task, group.count, how.starts, how.seed, how.side_m, how.apart_m)
    fresh = fresh_herds(task, group.count, how)
    for turn, corner in enumerate(task.turns, 1):
        if not candidates(task, corner, how.grid):
            raise InputError(
                f"task {task.name}: no wall of the grid can stand at turn {turn}: expected an anchor within "
                f"{how.grid.reach_m:g} m of it, and lengths along which {how.grid.robots} robots have room"
            )
    finder = _Finder(task, group, step_m, how, static, progress, fresh, robots)
    for kept in range(len(begun.walls), -1, -1):
        first = Plan(task.name, static, begun.walls[:kept], begun.shares[:kept])
        given_up = begun.walls[kept] if kept < len(begun.walls) else None
        for plan in finder.chains(first, finder.entering(first, states), given_up):
            return plan
    best = progress.best
    whole = best is not None and len(best.walls) == len(task.turns)
    few = f", which guide less than {how.whole:g} of the members of {how.herds} new herds to the goal" if whole else ""
    raise InputError(
        f"task {task.name}: no plan of {'static' if static else 'changing'} walls in the grid: the longest chain has "
        f"{len(best.walls) if best else 0} of {len(task.turns)} walls{few}; {progress.simulations} simulations were "
        "tried"
    )


@dataclass(frozen=True)
class _Finder:
    task: Task
    group: Group
    step_m: float
    how: Search
    static: bool
    progress: Progress
    fresh: Sequence[State]
    robots: Group | None

    def entering(self, plan: Plan, states: Sequence[State]) -> Sequence[State]:
        """Herds as `chains` takes them beside a plan, of herds at their start."""
        for k in range(len(plan.walls) if self.static else len(plan.walls) - 1):
            until = Plan(plan.task, plan.static, plan.walls[: k + 1 if self.static else k + 2])
            states = self._taken(until.segments(self.task, k), states, self.task.turns[k])[1]
        return states

    def chains(self, plan: Plan, entering: Sequence[State], given_up: Wall | None = None) -> Iterator[Plan]:
        """Whole plans that begin with this one, the best first.

        `entering`: herds as they enter the last stage of a plan whose walls change, whose walls depend on what follows;
        else the stage that comes next. `given_up`: not tried at the next turn.
        """
        turn = len(plan.walls)
        if turn == len(self.task.turns):
            self._spend(len(self.fresh) * (len(plan.walls) + 1))
            judged = chain.judge(self.task, plan, self.group, self.fresh, self.step_m)
            if judged.share >= self.how.whole:
                yield replace(plan, judged=judged)
            return
        for share, longer, states in self._ranked(plan, entering)[: self.how.breadth]:
            if longer.walls[-1] == given_up:
                continue
            if self.progress.best is None or len(longer.walls) > len(self.progress.best.walls):
                self.progress.best = longer
                self.progress.say(f"turn {turn + 1} of {len(self.task.turns)}: {share:.2f} of the members make it")
            yield from self.chains(longer, states)

    def _ranked(self, plan: Plan, entering: Sequence[State]) -> list[_Valid]:
        """The valid walls of the next turn: share, the plan with it, and the herds from which the search goes on."""
        turn = len(plan.walls)
        corner = self.task.turns[turn]
        before: Sequence[State] = entering
        if not self.static and turn > 0:  # as they would enter the stage if only the wall before stood
            before = self._taken(plan.segments(self.task, turn - 1), entering, self.task.turns[turn - 1])[1]
        tried: dict[Wall, tuple[float, list[State]]] = {}
        for wall in candidates(self.task, corner, self.how.grid):
            tried[wall] = self._taken(self._longer(plan, wall).segments(self.task, turn), before, corner)
        shares = {wall: share for wall, (share, _) in tried.items()}
        found = sorted(
            (wall for wall, share in shares.items() if share >= self.how.share),
            key=lambda wall: (-steadiness(wall, shares, self.how.grid), wall),
        )
        valid: list[_Valid] = []
        for wall in found:
            (share, states), longer = tried[wall], self._longer(plan, wall)
            if len(valid) == self.how.breadth:
                break
            on: Sequence[State] = states
            first = 1.0
            if not self.static:
                on = entering
                if turn > 0:  # the wall stands while the one before is passed
                    first, on = self._taken(longer.segments(self.task, turn - 1), entering, self.task.turns[turn - 1])
            if first >= self.how.share:
                valid.append(_Valid(share, Plan(plan.task, plan.static, longer.walls, (*plan.shares, share)), on))
        return self._confirmed(valid, corner) if self.robots is not None else valid

    def _confirmed(self, valid: list[_Valid], corner: int) -> list[_Valid]:
        """The valid walls of a turn, ranked by the share of the robots that make it; those that few make are left
        out."""
        assert self.robots is not None
        how, found = self.how, []
        for each in valid:
            states = chain.approaches(
                self.task, corner, self.robots.count, how.starts, how.seed, how.side_m, how.apart_m
            )
            self.progress.simulations += len(states)
            walls = np.array([each.plan.walls[-1].segment(self.task)])
            share = chain.share(chain.stage(self.task, self.robots, walls, states, corner, self.step_m))
            self.progress.say(f"turn {corner}: {words(each.plan.walls[-1:])}: {share:.2f} of the robots make it")
            found.append((share, each))
        found.sort(key=lambda entry: -entry[0])
        return [each._replace(share=share) for share, each in found if share >= self.how.robots]

    def _longer(self, plan: Plan, wall: Wall) -> Plan:
        return Plan(plan.task, plan.static, (*plan.walls, wall), plan.shares)

    def _taken(self, walls: Floats, states: Sequence[State], corner: int) -> tuple[float, list[State]]:
        self._spend(len(states))
        staged = chain.stage(self.task, self.group, walls, states, corner, self.step_m)
        return chain.share(staged), [each.state for each in staged]

    def _spend(self, simulations: int) -> None:
        self.progress.simulations += simulations
        if self.progress.simulations > self.how.budget:
            best = self.progress.best
            raise BudgetSpentError(
                f"task {self.task.name}: no plan within {self.how.budget} simulations: the longest chain has "
                f"{len(best.walls) if best else 0} of {len(self.task.turns)} walls; expected a larger budget"
            )
