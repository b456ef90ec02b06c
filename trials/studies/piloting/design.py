"""The trials of piloting: a task, its walls, the robots that are guided, and those that guide (Fine 2015, section 8.2).

Walls are those of the plan that comes with each task (`herd plan TASK` found it), unless the user names others. All of
them stand all the time, where that solves a task; in task 3, and wherever robots guide, as many as six robots hold.
"""

from __future__ import annotations

import dataclasses
from functools import cache

from generation.files import to_json
from generation.piloting import members
from generation.piloting import plan as plans
from generation.piloting import task as tasks
from trials.simulations.robots import guided
from trials.simulations.robots.fields import group, trial
from trials.types import Group, Trial, Value, with_setup

TASK, GUIDES = KEYS = ("task", "piloting.guides")
WALLS, PILOTS, SHEEPDOGS, NOTHING = guided.WALLS, guided.PILOTS, guided.SHEEPDOGS, guided.NOTHING
TASKS = tuple(tasks.names())
MEASURE = "arrived_share"
FILE = "task.json"
"""Path that a trial's world is named by; its text travels with the trial."""
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


def base(experiment: str, repeat: int) -> Trial:
    """Four Creates under BOIDS that six others guide through the first task."""
    herd = group(
        members.LAW, members.COUNT, pipeline="sensor-based", obstacles="avoid",
        law_parameters=members.of_law(members.LAW), speed_m_s=members.SPEED_M_S,
    )  # fmt: skip
    made = trial(
        experiment, repeat, [herd, pilots(6)], world=FILE, formation="scattered", formation_parameters=START,
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
    """The trial in its task's workspace, with its walls, as many pilots as two walls take or the dogs that it has, and
    its length."""
    name = guided.name_of(trial)
    if name == guided.NONE:
        return trial
    given, found = guided.parameters(trial), shipped(name)
    own: dict[str, Value] = {"piloting.walls": plans.words(found.walls)}
    if given.guides == WALLS and not found.static:
        own["piloting.at_once"] = plans.AT_ONCE
    herd = [each for each in trial.groups if each.name != guided.GROUP]
    kept = given.guides in (PILOTS, SHEEPDOGS)
    guides = [each for each in trial.groups if each.name == guided.GROUP] if kept else []
    usual = [each for each in guides if each.count == 2 * plans.ROBOTS_A_WALL]
    if usual and given.guides == PILOTS:
        guides = [dataclasses.replace(usual[0], count=plans.AT_ONCE * given.robots_a_wall)]
    own["duration_s"] = duration_s(name, float(herd[0].setup.get("speed_m_s", members.SPEED_M_S)))
    count = sum(each.count for each in herd)
    start: dict[str, Value] = {"length_m": EACH_M * min(max(members.COUNT, count), GROWS_BY_ITSELF)}
    placed = dataclasses.replace(
        trial, groups=(*herd, *guides), formation_parameters={**start, **trial.formation_parameters}
    )
    if trial.world == FILE:
        placed = dataclasses.replace(placed, world_source=_workspace(name))
    return with_setup(placed, {**own, **trial.setup})


def duration_s(task: str, speed_m_s: float) -> float:
    """How long a trial lasts, s: the herd's straight way at its speed, `SLOWNESS` times."""
    line = tasks.load(task).trajectory
    length = sum(((line[k + 1] - line[k]) ** 2).sum() ** 0.5 for k in range(len(line) - 1))
    return float(round(SLOWNESS * length / speed_m_s))


@cache
def shipped(task: str) -> plans.Plan:
    """The plan that comes with a task. Raises `InputError` where none does."""
    return plans.shipped(task)


@cache
def _workspace(task: str) -> str:
    """The JSON of a task's workspace with its start alone, so that the herd is put there."""
    found = tasks.load(task)
    return to_json(dataclasses.replace(found.environment, markers={"start": found.start}))
