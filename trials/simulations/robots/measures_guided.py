"""How well a herd was guided through its task: table 8.1 of Fine 2015, and what its pilots did meanwhile."""

from __future__ import annotations

import math

import numpy as np

from flocking.types import Floats
from generation.piloting import course
from generation.piloting.task import Task
from trials.simulations.robots import guided
from trials.types import Measure, TrialResult

ABOUT = {
    "arrived_share": Measure("", "share of the guided robots that followed the task's trajectory to its goal"),
    "walls_cleared": Measure("walls", "walls that all robots still on their course had cleared"),
    "astray_share": Measure("", "share of the guided robots that left the corridor before they arrived"),
    "change_s": Measure("s", "mean time from the change of a formation until its pilots stood in their places"),
    "late_share": Measure("", "share of the walls that pilots did not yet hold when a guided robot came to the turn"),
    "pilot_herd_collisions": Measure("touches", "touches of a pilot and a guided robot"),
    "pilot_collisions": Measure("touches", "touches of two pilots"),
    "pilot_way": Measure("m", "mean way of a pilot"),
}


def guidance(result: TrialResult) -> dict[str, float]:
    """The measures of a trial that has a task; nan of pilots where there are none."""
    trial = result.trial
    herd, pilots = guided.members(trial, pilots=False), guided.members(trial, pilots=True)
    task, positions = guided.task_of(trial), result.poses_w[:, herd, :2]
    of = course.course(task, positions)
    there = course.arrived(task, positions, of)
    stages = result.tables["stages"]
    found = {
        "arrived_share": float(there.mean()),
        "walls_cleared": float(len(stages) - 1),
        "astray_share": float((of.astray[-1] & ~there).mean()),
    }
    if len(pilots) == 0:
        return found | dict.fromkeys(ABOUT.keys() - found.keys(), math.nan)
    at_once = len(pilots) // guided.parameters(trial).robots_a_wall
    changes = stages[1 : max(1, len(guided.plan_of(trial).walls) - at_once + 1)]
    ended, there_s = np.isfinite(changes[:, 1]), _reached(task, of, result.times)[at_once:]
    came = np.isfinite(there_s[: len(changes)])
    late = ~(changes[came, 1] <= there_s[: len(changes)][came])
    one, other = np.isin(result.contacts.robots, pilots), np.isin(result.contacts.others, pilots)
    ways = np.hypot(*np.diff(result.poses_w[:, pilots, :2], axis=0).transpose(2, 0, 1)).sum(axis=0)
    return found | {
        "change_s": float(np.diff(changes[ended], axis=1).mean()) if ended.any() else math.nan,
        "late_share": float(late.mean()) if len(late) else math.nan,
        "pilot_herd_collisions": float(((one != other) & (result.contacts.others >= 0)).sum()),
        "pilot_collisions": float((one & other).sum()),
        "pilot_way": float(ways.mean()),
    }


def _reached(task: Task, of: course.Course, times: Floats) -> Floats:
    """(K,) when the first member on its course came to each turn, within the task's corridor; nan: none did."""
    on_it = ~of.astray[:, :, None] & (of.leg[:, :, None] >= np.asarray(task.turns))
    came = on_it.any(axis=1)
    return np.asarray(np.where(came.any(axis=0), times[came.argmax(axis=0)], math.nan))
