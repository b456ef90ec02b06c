"""What the experiments on Kirchner's simulation share: its herd, its predator, its obstacles, who knows whom.

The herd comes first, then the predator, then the obstacles: whom a robot fears, and what it drives round, it is told by
their numbers in that order. A pixel is 8 mm (1 ft is 38.1 px).
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any

from flocking.laws.buckland_boids import SEEN
from flocking.parameters import Parameter
from trials.simulations.kinematic.fields import group, trial
from trials.types import Group, Trial, Value

PIXEL_M = 0.3048 / 38.1
HERD, PREDATOR, OBSTACLES = "herd", "predator", "obstacles"
LAW = "buckland-boids"
COUNT, VIEW, STEPS = f"{HERD}.count", f"{HERD}.law.view_m", "steps"
WITH_PREDATOR, WITH_OBSTACLES = f"{PREDATOR}.count", f"{OBSTACLES}.count"
NORMAL_M, SHORT_M = 201 * PIXEL_M, 50 * PIXEL_M
MOST_OBSTACLES = 7
"""Buckland's; as many as a selection by numbers has room for."""
STEPS_A_SECOND = 30
EVERY = STEPS_A_SECOND
START = 0.78
"""Side of the square in which all start, by the octagon's width: the largest that fits into it is 0.8."""
SOURCES = {
    COUNT: Parameter("members", "Kirchner 2006, sections 3.3 and 4.5", published=True),
    VIEW: Parameter("m", "Kirchner 2006, section 3.3: 201 px, and 50 px", published=True),
    STEPS: Parameter("", f"a choice: {STEPS_A_SECOND} a second; one minute is published, and 20 of them"),
    WITH_PREDATOR: Parameter("members", "Kirchner 2006, section 3.3: one, or none", published=True),
    WITH_OBSTACLES: Parameter("members", "Buckland 2005, the defaults of its code: seven", published=True),
    f"{HERD}.speed_m_s": Parameter("m/s", "Buckland 2005: at the start all stand", published=True),
    f"{PREDATOR}.law.top_speed_m_s": Parameter("m/s", "Buckland 2005: 70 px/s", published=True),
    f"{OBSTACLES}.failure_probability": Parameter("", "they stand from the first step on"),
    "formation.spacing_m": Parameter("m", "a choice: all start in a square of 0.78 of the octagon's width"),
}


def boids(experiment: str, repeat: int, seconds: int) -> Trial:
    """Twenty robots and a predator in the octagon."""
    lonely: dict[str, Value] = dict.fromkeys(("separation_weight", "alignment_weight", "cohesion_weight"), 0.0)
    groups = [
        group(LAW, 20, name=HERD, speed_m_s=0.0),
        group(LAW, 1, name=PREDATOR, law_parameters={**lonely, "top_speed_m_s": 70 * PIXEL_M}, speed_m_s=0.0),
        group(LAW, 0, name=OBSTACLES, failure_probability=1.0, speed_m_s=0.0),
    ]
    gap: dict[str, Any] = {"flocks.gap_m": 48 * PIXEL_M}
    return trial(experiment, repeat, groups, world="octagon", steps=seconds * STEPS_A_SECOND, every=EVERY, **gap)


def filled_in(trial: Trial) -> Trial:
    """The trial with the selections and the start that follow from who takes part, where the user gave none."""
    count = sum(each.count for each in trial.groups)
    width = float(trial.world_parameters.get("width_m", 6.08))
    formation = trial.formation_parameters
    if trial.formation == "uniform" and trial.world == "octagon" and "spacing_m" not in formation:
        formation = {**formation, "spacing_m": START * width / math.sqrt(max(count, 1))}
    groups = tuple(_knowing(each, trial) for each in trial.groups)
    return dataclasses.replace(trial, groups=groups, formation_parameters=formation)


def _knowing(group: Group, trial: Trial) -> Group:
    """A group that knows whom to fear and what to drive round, by their numbers; a predator does not see itself."""
    if group.law != LAW or group.selection != "all":
        return group
    herd, predators, obstacles = (each.count for each in trial.groups)
    sets = []
    if predators:
        sets.append(f"threats: {SEEN} & fixed-set({', '.join(str(herd + k) for k in range(predators))})")
    if obstacles:
        first = herd + predators
        sets.append(f"discs: fixed-set({', '.join(str(first + k) for k in range(obstacles))})")
    return dataclasses.replace(group, selection="; ".join(sets) or "all")
