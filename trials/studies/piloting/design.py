"""The trials of piloting: a task, its walls, the robots that are guided, and those that guide (Fine 2015, section 8.2).

Walls are those of the plan that comes with each task (`herd plan TASK` found it), unless the user names others. All of
them stand all the time, where that solves a task; in task 3, and wherever robots guide, as many as six robots hold.
The plan of a task of the user's own, `mine.json`, lies beside it as `mine.plan.json`.
"""

from __future__ import annotations

import dataclasses
from functools import cache, lru_cache
from pathlib import Path

from flocking.errors import InputError
from generation.files import to_json
from generation.piloting import members
from generation.piloting import plan as plans
from generation.piloting import task as tasks
from generation.piloting.task import Task
from trials.simulations.robots import guided
from trials.simulations.robots.fields import group, trial
from trials.types import Group, Trial, Value, with_setup

TASK, GUIDES = KEYS = ("task", "piloting.guides")
WALLS, PILOTS, SHEEPDOGS, NOTHING = guided.WALLS, guided.PILOTS, guided.SHEEPDOGS, guided.NOTHING
TASKS = tuple(tasks.names())
MEASURE = "arrived_share"
FILE = "task.json"
"""Path that a trial's world is named by; its text travels with the trial."""
PLAN = ".plan.json"
"""Ends the name of the plan beside a task of the user's own, in place of .json."""
START: dict[str, Value] = {"gap_m": 0.4, "half_width_m": 0.5, "heading_spread_deg": 10.0}
"""A choice: Creates across a street of 1.5 m."""
EACH_M = 0.25
"""Length of the start for each of them. A choice."""
GROWS_BY_ITSELF = 6
"""Members from which on the formation `scattered` grows longer by itself."""
PILOT_M_S = 0.4
"""A choice: pilots must be faster than the herd, and keep below a Create's 0.5 m/s."""
SLOWNESS = 2.5
"""How many times as long as the herd's straight way a trial lasts."""


class Unasked(int):
    """A number of robots that nobody asked for, so that another may take its place; a value that is put is none."""


def base(experiment: str, repeat: int) -> Trial:
    """Four Creates under BOIDS that six others guide through the first task."""
    herd = group(
        members.LAW, members.COUNT, pipeline="sensor-based", obstacles="avoid",
        law_parameters=members.of_law(members.LAW), speed_m_s=members.SPEED_M_S,
    )  # fmt: skip
    guides = pilots(Unasked(plans.AT_ONCE * plans.ROBOTS_A_WALL))
    made = trial(
        experiment, repeat, [herd, guides], world=FILE, formation="scattered", formation_parameters=START,
        task=TASKS[0],
    )  # fmt: skip
    return with_setup(dataclasses.replace(made, world_source=_workspace(TASKS[0])), {GUIDES: PILOTS})


def pilots(count: int) -> Group:
    """Robots that guide; they know where they are, and see everybody."""
    return group(
        "to-goal", count, name=guided.GROUP, pipeline="perfect", body="create-pilot", own_motion="true",
        speed_m_s=PILOT_M_S, start_moving=False,
    )  # fmt: skip


def finish(trial: Trial) -> Trial:
    """The trial in its task's workspace, with its walls, its pilots or the dogs that it has, and its length.

    Where nobody asked for a number of pilots, there are as many as two walls take. Raises `InputError` for a task that
    needs a plan and comes without one.
    """
    if not guided.has_task(trial):
        return trial
    given, task, found = guided.parameters(trial), guided.task_of(trial), _plan(trial)
    own: dict[str, Value] = {"piloting.walls": plans.words(found.walls)} if found is not None else {}
    if given.guides == WALLS and found is not None and not found.static:
        own["piloting.at_once"] = plans.AT_ONCE
    herd = [each for each in trial.groups if each.name != guided.GROUP]
    kept = given.guides in (PILOTS, SHEEPDOGS)
    guides = [each for each in trial.groups if each.name == guided.GROUP] if kept else []
    if guides and isinstance(guides[0].count, Unasked):
        robots_a_wall = given.robots_a_wall if given.guides == PILOTS else plans.ROBOTS_A_WALL
        guides = [dataclasses.replace(guides[0], count=plans.AT_ONCE * robots_a_wall)]
    own["duration_s"] = duration_s(task, float(herd[0].setup.get("speed_m_s", members.SPEED_M_S)))
    count = sum(each.count for each in herd)
    start: dict[str, Value] = {"length_m": EACH_M * min(max(members.COUNT, count), GROWS_BY_ITSELF)}
    placed = dataclasses.replace(
        trial, groups=(*herd, *guides), formation_parameters={**start, **trial.formation_parameters}
    )
    if trial.world == FILE:
        placed = dataclasses.replace(placed, world_source=_workspace(guided.name_of(trial), trial.task_source))
    return with_setup(placed, {**own, **trial.setup})


def duration_s(task: Task, speed_m_s: float) -> float:
    """How long a trial lasts, s: the herd's straight way at its speed, `SLOWNESS` times."""
    line = task.trajectory
    length = sum(((line[k + 1] - line[k]) ** 2).sum() ** 0.5 for k in range(len(line) - 1))
    return float(round(SLOWNESS * length / speed_m_s))


def _plan(trial: Trial) -> plans.Plan | None:
    """The plan of a trial's task; None of a user's own task without one, where its walls are given or none is needed.

    Raises `InputError` where one is needed and there is none, or it is of another task.
    """
    name = guided.name_of(trial)
    if not tasks.is_file(name):
        return shipped(name)
    beside = Path(name).with_suffix(PLAN)
    if not beside.exists():
        if "piloting.walls" in trial.setup or guided.parameters(trial).guides not in (WALLS, PILOTS):
            return None
        raise InputError(
            f"task {name} has no plan {beside}; expected one, as herd plan {name} --out {beside} makes it, or "
            "its walls: --set 'piloting.walls=\"…\"'"
        )
    found, task = plans.read(beside), guided.task_of(trial)
    if found.task != task.name or len(found.walls) != len(task.turns):
        raise InputError(
            f"{beside}: a plan of {found.task} with {len(found.walls)} walls; expected one of {task.name} with "
            f"{len(task.turns)}"
        )
    return found


@cache
def shipped(task: str) -> plans.Plan:
    """The plan that comes with a task. Raises `InputError` where none does."""
    return plans.shipped(task)


@lru_cache(maxsize=64)
def _workspace(name: str, text: str = "") -> str:
    """The JSON of a task's workspace with its start alone, so that the herd is put there. `text`: of a user's file."""
    task = tasks.load(name, text)
    return to_json(dataclasses.replace(task.environment, markers={"start": task.start}))
