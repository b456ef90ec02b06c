"""A trial held against a behaviour: `behaviour` names one of `generation.behaviours`, `behaviour.*` are its parameters.

It gives the trial two measures. Positions and environment are judged in the units of the environment's file, whatever
`world.scale` is, so that one behaviour judges kinematic members and robots by the same numbers.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from flocking.parameters import filled
from flocking.types import Floats
from generation import behaviours
from generation.environment import Environment
from trials.rows import Section, below, section
from trials.types import Measure, Trial
from worlds import known

NONE = "none"
BEHAVIOUR = "behaviour."
"""Prefix of the keys of a behaviour's parameters."""
SCALE = "scale"
ABOUT = {
    "fitness": Measure("", "how far the herd showed the trial's behaviour, 0 to 1"),
    "elicited": Measure("", "whether the herd showed the trial's behaviour: 1, or 0"),
}


def names() -> list[str]:
    """The behaviours that a trial can be held against, and none."""
    return [NONE, *behaviours.names()]


def name_of(trial: Trial) -> str:
    """The name of the behaviour in a trial's setup, as it stands there; none where it is no text."""
    given = trial.setup.get(BEHAVIOUR.rstrip("."), NONE)
    return given if isinstance(given, str) else NONE


def sections(trial: Trial) -> list[Section]:
    """The parameters of the trial's behaviour, if it has one."""
    name = name_of(trial)
    if name == NONE:
        return []
    behaviour = behaviours.load(name)
    return [section(BEHAVIOUR, behaviour.parameters, lambda: _parameters(trial, behaviour)._asdict())]


def check(trial: Trial, name: str) -> None:
    """Refuses a behaviour whose parameters do not fit, or whose markers the trial's world lacks: `InputError`."""
    if name != NONE:
        members = sum(group.count for group in trial.groups)
        measure(trial, name, np.zeros((2, members, 2)))


def measure(trial: Trial, name: str, positions_w: Floats) -> dict[str, float]:
    """The two measures of members at positions (T, N, 2), m, one an iteration, the start first; none without behaviour.

    Raises `InputError` where the behaviour cannot judge them.
    """
    if name == NONE:
        return {}
    behaviour = behaviours.load(name)
    scale, environment = _environment(trial)
    fitness = behaviour.judged(positions_w / scale, environment, _parameters(trial, behaviour))
    return {"fitness": fitness, "elicited": float(behaviour.succeeds(fitness))}


def _parameters(trial: Trial, behaviour: behaviours.Behaviour) -> Any:
    given = below(trial.setup, BEHAVIOUR)
    own = {key: value for key, value in given.items() if key in behaviour.parameters._fields}  # type: ignore[attr-defined]
    return filled(behaviour.parameters, own, prefix=BEHAVIOUR)


def _environment(trial: Trial) -> tuple[float, Environment]:
    """The scale of a trial's world, and what stands in it at a scale of 1."""
    given = dict(trial.world_parameters)
    if known.is_file(trial.world) and known.load(trial.world, trial.world_source).parameters is known.OfFile:
        scale = float(given.pop(SCALE, known.OfFile().scale))
        return scale, known.environment_of(trial.world, trial.world_source, given)
    if known.is_file(trial.world) or trial.world in known.names():
        return 1.0, known.environment_of(trial.world, trial.world_source, given)
    return 1.0, Environment()  # a space of the kinematic herd
