"""The environments of a trial, where its herd starts, and the herd: all of it from the trial's names and numbers."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np

from flocking.errors import InputError
from flocking.types import Floats
from generation import candidates
from generation.environment import START, Environment
from generation.group import Job
from generation.primitives import Point
from trials.simulations.environments import fields
from trials.simulations.environments.members import Members
from trials.simulations.kinematic import fields as of_members
from trials.simulations.kinematic import herd as kinematic
from trials.streams import Purpose, stream
from trials.types import Trial

MOST_KEPT = 1000
"""Environments that a process remembers: those of some trials, which share them with trials of other herds."""
_kept: dict[tuple[Any, ...], Environment] = {}


def environment(trial: Trial, number: int, chosen: fields.Chosen) -> Environment:
    """The environment of that number (from 0) of a trial: the same whatever its herd, behaviour and filter.

    One that this process has made already is not made again. Raises `InputError` where the schema fails.
    """
    drawn = chosen.varied, tuple(chosen.within.items())
    key = trial.world, trial.world_source, tuple(chosen.of_schema), drawn, trial.seed, trial.repeat, number
    if key not in _kept:
        made = _made(trial, number, chosen)
        if len(_kept) >= MOST_KEPT:
            forget()
        _kept[key] = made
    return _kept[key]


def forget() -> None:
    """Has the environments of all trials made anew."""
    _kept.clear()


def _made(trial: Trial, number: int, chosen: fields.Chosen) -> Environment:
    rng = stream(trial.seed, trial.repeat, 0, number, Purpose.WORLD)
    schema, workspace = chosen.schema, chosen.schema.workspace()
    if not chosen.varied:
        return schema.generate(chosen.of_schema, workspace, rng)
    seed = int(rng.integers(2**63))
    return candidates.candidate(schema, chosen.of_schema, workspace, seed, 1, chosen.varied, chosen.within)


def without_construct(whole: Environment) -> Environment:
    """The control: the workspace alone, with the same markers."""
    return Environment(whole.workspace, (), whole.markers, whole.reflectance, whole.origin)


def start(trial: Trial, number: int, whole: Environment) -> Floats:
    """(N, 3) where the members start in the environment of that number: in the square about its marker `start`.

    Raises `InputError` where that marker is no point.
    """
    given = fields.formation_of(trial)
    count = sum(group.count for group in trial.groups)
    rng = stream(trial.seed, trial.repeat, 0, number, Purpose.START)
    places = given.size_m * rng.uniform(-0.5, 0.5, (count, 2))
    spread = math.radians(given.heading_spread_deg)
    headings = rng.uniform(-spread, spread, count)
    at = whole.markers.get(START, Point())
    if not isinstance(at, Point):
        raise InputError(f"marker {START!r} of an environment of {trial.world!r} is {at!r}: expected a point")
    c, s = math.cos(at.heading_rad), math.sin(at.heading_rad)
    x, y = places.T
    return np.column_stack([at.x_m + c * x - s * y, at.y_m + s * x + c * y, at.heading_rad + headings])


def job(trial: Trial, number: int, whole: Environment) -> Job:
    """The simulation of the trial's herd in the environment of that number, or in its control."""
    return Job(whole, start(trial, number, whole), (trial.seed, trial.repeat, number, int(Purpose.LAW)))


def group(trial: Trial) -> Members:
    """The herd of a trial. Raises `InputError` for names and numbers that do not exist or fit."""
    speeds = np.repeat(
        [of_members.of_group(group).speed_m_s for group in trial.groups], [group.count for group in trial.groups]
    )
    bands = [dataclasses.replace(band, sight_lines=True) for band in kinematic.bands_of(trial, np.zeros(2))]
    return Members(tuple(bands), fields.of_trial(trial).timestep_s, speeds)
