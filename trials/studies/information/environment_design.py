"""The cells of `environment-and-synchrony`: each law in each space, synchronous or not, with avoidance added or not.

Every herd starts in the middle: in free space, in a walled square three times as wide as its start, and in that square
with pieces of wall scattered in it. And a law that knows nothing but its bumper, beside random motion of the same body.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from flocking import lawentry
from flocking.errors import InputError
from trials.studies.information import law_survey
from trials.studies.information.law_survey import CONTROL, COUNT, LAW
from trials.types import Trial, Value, with_setup

WORLD, SYNCHRONOUS, OBSTACLES, BODY = "world", "synchronous", "herd.obstacles", "herd.radius_m"
OWN_WAY = ("formation.spacing_m", "timestep_s", "herd.law.speed_m_s", "herd.law.hold_s", "herd.law.turn_rad")
"""What makes random motion the control of a law: its herd, and the manner of its walk."""
KEYS = (LAW, WORLD, SYNCHRONOUS, OBSTACLES, BODY, *OWN_WAY)
FREE, BOUNDED, FILLED = WORLDS = ("unbounded", "bounded", "obstacles")
AS_LAW, AVOID = "as-law", "avoid"
BUMPER = "bumper-only"
RADIUS_M = 0.165
"""Of the body whose bumper is pressed: a Create's."""
WIDTH = 3.0
"""Side of the square, in sides of the square in which the herd starts."""
WALLS = 12
"""Pieces of wall, each a tenth of the square's side long."""
LENGTH = law_survey.Length(spacings=15.0, most_steps=3000)
"""From the start's middle to the walls and back, where that is not too long."""


class Setting(NamedTuple):
    """Where a herd is, and how."""

    world: str
    synchronous: bool
    obstacles: str

    def words(self) -> str:
        names = {FREE: "free", BOUNDED: "bounded", FILLED: "obstacles"}
        avoiding = " +" if self.obstacles == AVOID else ""
        return f"{names[self.world]}{avoiding}, {'synchronous' if self.synchronous else 'asynchronous'}"


SETTINGS = tuple(
    Setting(world, synchronous, obstacles)
    for world in WORLDS
    for obstacles in (AS_LAW, AVOID)
    for synchronous in (True, False)
    if world != FREE or obstacles == AS_LAW
)
"""The first is the one that others are held against."""


def cell(law: str, setting: Setting) -> dict[str, Value]:
    """The conditions of a law in a setting."""
    return {LAW: law, WORLD: setting.world, SYNCHRONOUS: setting.synchronous, OBSTACLES: setting.obstacles}


def bumper_cell(setting: Setting) -> dict[str, Value]:
    """Those of the law that feels its way, whose members are solid."""
    return {**cell(BUMPER, setting), BODY: RADIUS_M}


def bumper_control(setting: Setting) -> dict[str, Value]:
    """Random motion of the same body at the same speed, in the manner that its law has for Creates."""
    herd = law_survey.herd_of(BUMPER)
    walk: dict[str, Value] = lawentry.module_of(CONTROL).CREATE
    way = (herd.spacing_m, herd.dt_s, herd.speed_m_s, walk["hold_s"], walk["turn_rad"])
    return {**cell(CONTROL, setting), BODY: RADIUS_M, **dict(zip(OWN_WAY, way, strict=True))}


def cells(conditions: Mapping[str, Sequence[Any]]) -> list[dict[str, Value]]:
    """Of every law all settings, and those of the bumper beside its control."""
    settings = [
        setting
        for setting in SETTINGS
        if setting.world in conditions[WORLD]
        and setting.synchronous in conditions[SYNCHRONOUS]
        and setting.obstacles in conditions[OBSTACLES]
    ]
    if not settings:
        raise InputError(f"{WORLD}, {SYNCHRONOUS} and {OBSTACLES}: no such setting; expected one of the experiment's")
    names = list(conditions[LAW])
    laws = law_survey.wanted_laws({LAW: [name for name in names if name != BUMPER]})
    found = [cell(law, setting) for law in laws for setting in settings]
    if BUMPER in names:
        felt = [setting for setting in settings if setting.obstacles == AS_LAW]
        found += [make(setting) for setting in felt for make in (bumper_cell, bumper_control)]
    return found


def finish(trial: Trial) -> Trial:
    """The square's side and walls, and the length; all that the cell and the user did not set."""
    trial = law_survey.finished(trial, LENGTH)
    (group,) = trial.groups
    if group.law == CONTROL:
        steps = law_survey.steps(law_survey.herd_of(BUMPER), LENGTH)
        trial = with_setup(trial, {"steps": steps, **trial.setup})
    if trial.world == FREE:
        return trial
    own = law_survey.herd_of(group.law).spacing_m
    spacing = float(trial.formation_parameters.get("spacing_m", own))
    square: dict[str, Value] = {"size_m": WIDTH * spacing * math.sqrt(COUNT)}
    if trial.world == FILLED:
        square["walls"] = WALLS
    return dataclasses.replace(trial, world_parameters={**square, **trial.world_parameters})
