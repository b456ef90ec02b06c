"""A herd taken through a task stage by stage: from one turn passed to the next, among the walls that stand then."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from flocking.types import Bools, Floats, Ints
from generation.environment import START, Environment
from generation.group import Group, Job
from generation.piloting.course import arrived, course, passed
from generation.piloting.plan import Judged, Plan, judged
from generation.piloting.task import Task
from generation.primitives import Point, Segment
from generation.validation.starts import Starts, poses

BEYOND_M = 1.2
"""Way along the next leg after which a member has passed a turn. A choice: as far as the walls of a turn reach."""
BEFORE_M = 2.0
"""Way before a corner at which herds start that are to make its turn alone. A choice: half of a leg of the tasks."""
SLOWNESS = 2.5
"""How many times as long as the straight way a stage may take."""


class State(NamedTuple):
    """Where a herd is and how far it has come."""

    poses_w: Floats
    """(N, 3)."""
    leg: Ints
    """(N,) of its members."""
    astray: Bools
    """(N,)."""
    seed: tuple[int, ...]


class Staged(NamedTuple):
    """What one stage made of a herd."""

    state: State
    """When all members on their course had passed the turn, or when the time was over."""
    made: Bools
    """(N,) which members passed the turn."""
    positions: Floats
    """(T, N, 2) until then, m, the start left out."""


def starts(task: Task, count: int, number: int, seed: int, side_m: float, apart_m: float) -> list[State]:
    """That many starts in a square about the task's start, all headed along the first leg within a tenth of a turn."""
    return _starts(task, task.start, 0, count, number, (seed,), side_m, apart_m)


def approaches(
    task: Task, corner: int, count: int, number: int, seed: int, side_m: float, apart_m: float
) -> list[State]:
    """That many starts on the leg before a corner, `BEFORE_M` from it, or at its beginning where it is shorter."""
    start, end = task.trajectory[corner - 1], task.trajectory[corner]
    way = end - start
    length = float(np.hypot(*way))
    x, y = end - way * min(BEFORE_M, length) / length
    at = Point(float(x), float(y), math.atan2(way[1], way[0]))
    return _starts(task, at, corner - 1, count, number, (seed, corner), side_m, apart_m)


def _starts(
    task: Task, at: Point, leg: int, count: int, number: int, seed: tuple[int, ...], side_m: float, apart_m: float
) -> list[State]:
    there = dataclasses.replace(task.environment, markers={START: at})
    drawn = Starts(side_m=side_m, spread_rad=0.2, apart_m=apart_m, clear_m=apart_m / 2.0)
    found = []
    for k in range(number):
        placed = poses(there, count, drawn, np.random.default_rng((*seed, k)))
        found.append(State(placed, np.full(count, leg, np.int64), np.zeros(count, np.bool_), (*seed, k)))
    return found


def built(task: Task, walls: Floats) -> Environment:
    """The task's workspace with walls (K, 4), m."""
    return dataclasses.replace(task.environment, construct=tuple(Segment(*map(float, row)) for row in walls))


def stage(task: Task, group: Group, walls: Floats, states: Sequence[State], turn: int, step_m: float) -> list[Staged]:
    """Each herd taken on until it has passed a turn: a corner's number, or that of the last corner: until the goal.

    `step_m`: way of a member in an iteration. Raises what the group raises.
    """
    environment, line = built(task, walls), task.trajectory
    jobs = [Job(environment, state.poses_w, (*state.seed, turn)) for state in states]
    way = float(np.hypot(*(line[turn] - line[turn - 1]))) + 2.0 * BEYOND_M
    iterations = max(2, int(SLOWNESS * way / step_m))
    found = []
    for state, whole in zip(states, group.trajectories(jobs, iterations), strict=True):
        positions = whole[1:]
        of = course(task, positions, state.leg, state.astray)
        if turn == len(line) - 1:
            made = arrived(task, positions, of)
            end = len(positions)
        else:
            through = passed(task, positions, of, turn, BEYOND_M)
            done = (through | of.astray).all(axis=1) & through.any(axis=1)
            end = int(np.argmax(done)) + 1 if done.any() else len(positions)
            made = through[:end].any(axis=0) & ~of.astray[end - 1]
        move = positions[end - 1] - whole[end - 1]
        still = ~move.any(axis=1)
        headings = np.where(still, state.poses_w[:, 2], np.arctan2(move[:, 1], move[:, 0]))
        after = State(np.column_stack([positions[end - 1], headings]), of.leg[end - 1], of.astray[end - 1], state.seed)
        found.append(Staged(after, made, positions[:end]))
    return found


def share(found: Sequence[Staged]) -> float:
    """The share of all members of all herds that made a stage."""
    return float(np.mean([each.made for each in found]))


def corners(task: Task) -> list[int]:
    """The corners at which stages end: each turn, and the end of the trajectory."""
    return [*task.turns, len(task.trajectory) - 1]


def follow(task: Task, plan: Plan, group: Group, states: Sequence[State], step_m: float) -> list[list[Staged]]:
    """Herds taken through all stages of a plan; of each stage, what it made of each herd."""
    found: list[list[Staged]] = []
    for number, corner in enumerate(corners(task)):
        found.append(stage(task, group, plan.segments(task, number), states, corner, step_m))
        states = [each.state for each in found[-1]]
    return found


def judge(task: Task, plan: Plan, group: Group, states: Sequence[State], step_m: float) -> Judged:
    """How well a whole plan guides herds from their start to the goal."""
    return judged([float(np.mean(each.made)) for each in follow(task, plan, group, states, step_m)[-1]])
