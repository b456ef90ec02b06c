"""How well a herd was guided through its task: table 8.1 of Fine 2015, and what its pilots did meanwhile."""

from __future__ import annotations

import math

import numpy as np

from generation.piloting import course
from trials.simulations.robots import guided
from trials.types import Measure, TrialResult

ABOUT = {
    "arrived_share": Measure("", "share of the guided robots that followed the task's trajectory to its goal"),
    "walls_cleared": Measure("walls", "walls that all robots still on their course had cleared"),
    "astray_share": Measure("", "share of the guided robots that left the corridor before they arrived"),
    "change_s": Measure("s", "mean time in which pilots changed their formation"),
    "late_share": Measure("", "share of the changes that had not ended when the next one was due, or the trial ended"),
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
    changes = stages[1:]
    ended = np.isfinite(changes[:, 1])
    one, other = np.isin(result.contacts.robots, pilots), np.isin(result.contacts.others, pilots)
    ways = np.hypot(*np.diff(result.poses_w[:, pilots, :2], axis=0).transpose(2, 0, 1)).sum(axis=0)
    return found | {
        "change_s": float(np.diff(changes[ended], axis=1).mean()) if ended.any() else math.nan,
        "late_share": float((~ended).mean()) if len(changes) else math.nan,
        "pilot_herd_collisions": float(((one != other) & (result.contacts.others >= 0)).sum()),
        "pilot_collisions": float((one & other).sum()),
        "pilot_way": float(ways.mean()),
    }
