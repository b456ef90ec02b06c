"""A herd that is guided through a task (Fine 2015, section 8.2): `task` names it, `piloting.*` says how it is guided.

Walls stand all the time or as many as can be held at a time; or robots do, the group `pilots`, in formations along
them; or the robots of that group drive the herd as sheepdogs do, which is ours.
"""

from __future__ import annotations

import dataclasses
from functools import lru_cache
from typing import Annotated, NamedTuple

import numpy as np

from flocking.errors import InputError
from flocking.parameters import Parameter, filled
from flocking.types import Floats, Ints
from generation.free_space import in_solid
from generation.piloting import chain, dogs, formations, sheepdogs
from generation.piloting import plan as plans
from generation.piloting import task as tasks
from generation.piloting.pilots import CLEAR_M
from generation.piloting.plan import Plan
from generation.piloting.routes import Ground, ground, route
from generation.piloting.task import Task
from trials.rows import below
from trials.types import Group, Trial
from worlds import known

NONE = "none"
PREFIX = "piloting."
WALLS, PILOTS, NOTHING, SHEEPDOGS = GUIDES = ("walls", "pilots", "nothing", "sheepdogs")
GROUP = "pilots"
"""Name of the group of piloting robots, or of sheepdogs; all others are guided."""


class Parameters(NamedTuple):
    """By what a herd is guided."""

    guides: Annotated[
        str,
        Parameter(
            "", "Fine 2015, section 8.2: walls, or robots in formations along them", published=True, choices=GUIDES
        ),
    ] = WALLS
    rule: Annotated[
        str,
        Parameter("", "of sheepdogs: Vaughan and others 2000, or Strömbom and others 2014", choices=sheepdogs.RULES),
    ] = sheepdogs.STROMBOM
    walls: Annotated[
        str,
        Parameter(
            "", "of each turn's wall the anchor, angle (deg) and length (m): found by herd plan", reads=plans.of_words
        ),
    ] = ""
    at_once: Annotated[
        int,
        Parameter("walls", "a choice: as many as robots hold; 0 = all walls stand all the time", low=0, high=100),
    ] = 0
    robots_a_wall: Annotated[
        int, Parameter("robots", "Fine 2015, section 8.2: a hand-tuned parameter", published=True, low=1, high=20)
    ] = formations.ROBOTS_A_WALL
    assignment: Annotated[
        str,
        Parameter(
            "", "Fine 2015, section 8.2: by the Hungarian method; what it makes least", choices=formations.OBJECTIVES
        ),
    ] = formations.OBJECTIVES[0]
    beyond_m: Annotated[
        float,
        Parameter("m", "a choice: way past a turn after which a member has cleared its wall", low=0.1, high=10.0),
    ] = chain.BEYOND_M


def names() -> list[str]:
    """The tasks that a trial can have, and none."""
    return [NONE, *tasks.names()]


def name_of(trial: Trial) -> str:
    """The task of a trial; none where it has none."""
    return str(trial.setup.get("task", NONE))


def has_task(trial: Trial) -> bool:
    """Whether a trial's herd is guided through a task."""
    return name_of(trial) != NONE


def parameters(trial: Trial) -> Parameters:
    """A trial's parameters, filled in. Raises `InputError`."""
    found: Parameters = filled(Parameters, below(trial.setup, PREFIX), prefix=PREFIX)
    return found


def task_of(trial: Trial) -> Task:
    """The task of a trial that has one. Raises `InputError`."""
    return _task(name_of(trial), trial.task_source)


@lru_cache(maxsize=64)
def _task(name: str, text: str) -> Task:
    return tasks.load(name, text)


def plan_of(trial: Trial) -> Plan:
    """The walls of a trial that has a task; none where nothing guides, or dogs do. Raises `InputError`."""
    given = parameters(trial)
    walls = plans.of_words(given.walls) if given.guides in (WALLS, PILOTS) else ()
    return Plan(task_of(trial).name if has_task(trial) else NONE, given.guides == WALLS and given.at_once == 0, walls)


def segments(trial: Trial) -> Floats:
    """(K, 4) the walls that rise and vanish in a trial, m: none where there is no task, or robots guide."""
    if not has_task(trial) or parameters(trial).guides != WALLS:
        return np.empty((0, 4))
    task = task_of(trial)
    return np.array([wall.segment(task) for wall in plan_of(trial).walls]).reshape(-1, 4)


def members(trial: Trial, pilots: bool) -> Ints:
    """Indices of the robots that pilot, or of those that are guided."""
    groups = [group.name == GROUP for group in trial.groups for _ in range(group.count)]
    return np.flatnonzero(np.array(groups, dtype=np.bool_) == pilots)


def herd(trial: Trial) -> Ints:
    """Indices of the robots that a behaviour judges: all but those that guide them."""
    return members(trial, pilots=False) if has_guides(trial) else np.arange(sum(each.count for each in trial.groups))


def starts_by_task(trial: Trial, group: Group) -> bool:
    """Whether a group of a trial starts where its task says: along the walls that it holds, or behind the herd."""
    return group.name == GROUP and has_guides(trial)


def has_guides(trial: Trial) -> bool:
    """Whether a trial has the parameters of this file: it has a task, or is told by what its herd is guided."""
    return has_task(trial) or f"{PREFIX}guides" in trial.setup


def pilot_starts(trial: Trial) -> Floats:
    """(R, 3) poses of the pilots at the start, along the walls that stand first, each looking along its wall.

    Without a task these are all walls of the world's construct, whether it stands or not, at equal distances. Sheepdogs
    stand behind the herd and look its way. Raises `InputError` where their number does not fit the walls or the street.
    """
    if not has_task(trial):
        whole = {**trial.world_parameters, "construct": True}
        built = known.environment_of(trial.world, trial.world_source, whole)
        fences = dataclasses.replace(built, workspace=()).walls()
        return formations.along(fences, len(members(trial, pilots=True)))
    given, task, plan = parameters(trial), task_of(trial), plan_of(trial)
    count = len(members(trial, pilots=True))
    if given.guides == SHEEPDOGS:
        behind = dogs.starts(task, count)
        if len(behind) < count:
            raise InputError(f"{count} sheepdogs, and room for {len(behind)} behind the start of {task.name}")
        return np.column_stack([behind, np.full(count, task.start.heading_rad)])
    places = formations.at_first(task, plan, count, given.robots_a_wall)
    angles = [plan.walls[k].angle_deg for k in range(count // given.robots_a_wall)]
    return np.column_stack([places, np.radians(np.repeat(angles, given.robots_a_wall))])


def ground_of(trial: Trial, radius_m: float) -> Ground:
    """Where a robot of that radius can go in the workspace of a trial's task."""
    return _ground(name_of(trial), trial.task_source, radius_m)


@lru_cache(maxsize=64)
def _ground(name: str, text: str, radius_m: float) -> Ground:
    return ground(_task(name, text).environment, radius_m)


def check(trial: Trial, radius_m: float) -> None:
    """Refuses a trial whose guides do not fit its task: `InputError`. `radius_m`: of a pilot."""
    if not has_task(trial):
        return
    given, task, plan = parameters(trial), task_of(trial), plan_of(trial)
    if given.guides == SHEEPDOGS and not len(members(trial, pilots=True)):
        raise InputError(
            f"piloting.guides = {SHEEPDOGS!r} without a group {GROUP!r}; expected at least one robot in it"
        )
    if given.guides in (NOTHING, SHEEPDOGS):
        return
    if len(plan.walls) != len(task.turns):
        raise InputError(
            f"piloting.walls has {len(plan.walls)} walls, and {task.name} {len(task.turns)} turns; expected one a "
            f"turn: herd plan {name_of(trial)} finds them"
        )
    for number, wall in enumerate(plan.walls, 1):
        segment = wall.segment(task)
        if in_solid(task.environment, formations.slots(segment, given.robots_a_wall)).any():
            raise InputError(f"wall {number} of {task.name} lies within a solid; expected it in the free space")
    pilots = len(members(trial, pilots=True))
    if given.guides == WALLS:
        if pilots:
            raise InputError(f"piloting.guides = {WALLS!r} with a group {GROUP!r}; expected it without, or {PILOTS!r}")
        return
    formations.at_first(task, plan, pilots, given.robots_a_wall)
    walls = task.environment.walls()
    for number, wall in enumerate(plan.walls, 1):
        if not formations.has_room(walls, wall.segment(task), given.robots_a_wall, radius_m):
            raise InputError(
                f"wall {number} of {task.name}, {wall.length_m:g} m long, has no room for {given.robots_a_wall} robots "
                f"of {2.0 * radius_m:g} m beside one another and other walls; expected a longer wall, or fewer robots"
            )
    number = _unreached(name_of(trial), trial.task_source, given.walls, pilots, given.robots_a_wall, radius_m)
    if number:
        raise InputError(f"wall {number} of {task.name}: no way of {2.0 * radius_m:g} m leads its pilots there")


@lru_cache(maxsize=64)
def _unreached(name: str, text: str, words: str, pilots: int, robots_a_wall: int, radius_m: float) -> int:
    """The number (from 1) of the first wall to which no way leads from where its pilots come; 0 where there is none."""
    task, over = _task(name, text), _ground(name, text, radius_m + CLEAR_M)
    places = [formations.slots(wall.segment(task), robots_a_wall) for wall in plans.of_words(words)]
    nobody, at_once = np.empty((0, 2)), pilots // robots_a_wall
    for number in range(at_once, len(places)):
        ways = (route(over, places[number - at_once][0], place, nobody, nobody, 0.0) for place in places[number])
        if any(len(way) == 0 for way in ways):
            return number + 1
    return 0
