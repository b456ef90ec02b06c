"""Heterogeneous groups: a law's parameters drawn anew for each member, `herd.spread.NAME` to either side.

Fine 2015, table 3.2 (composition) tells homogeneous from heterogeneous groups; how wide a group spreads is for the user
to set.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from flocking import lawentry
from flocking.errors import InputError
from flocking.parameters import Declared, Parameter, declared
from trials.rows import Section
from trials.streams import Purpose, stream
from trials.types import Group, Trial

ABOUT = Parameter("", "a choice: of the value, uniformly to either side, for each member its own", low=0.0, high=1.0)


def section_of(group: Group) -> Section:
    """The spreads that a group can be given, one for each parameter of its law; those that are set are shown."""
    known = declared(lawentry.module_of(group.law, group.law_source).Parameters)
    return Section("spread.", {name: Declared(name, float, 0.0, ABOUT) for name in known}, lambda: group.spread)


def parameters(trial: Trial, number: int, member: int, usual: Mapping[str, Any]) -> dict[str, Any]:
    """The law's parameters of one member of the trial's group of that number; `usual`: the group's own.

    A value stays within its parameter's bounds; whole numbers are rounded. Raises `InputError`, naming the spread, for
    values that the law's relations forbid together.
    """
    group = trial.groups[number]
    law = lawentry.module_of(group.law, group.law_source)
    known = declared(law.Parameters)
    u = stream(trial.seed, trial.repeat, number + 1, member, Purpose.PARAMETERS).random(len(known))
    own = dict(usual)
    for draw, (name, parameter) in zip(u, known.items(), strict=True):
        if name in group.spread:
            value = usual.get(name, parameter.default) * (1.0 + group.spread[name] * (2.0 * draw - 1.0))
            value = float(np.clip(value, parameter.about.low, parameter.about.high))
            own[name] = round(value) if parameter.type is int else value
    try:
        lawentry.parameters_of(group.law, law, own, f"{group.name}.law.")
    except InputError as error:
        drawn = " and ".join(f"{group.name}.spread.{name} = {share:g}" for name, share in group.spread.items())
        raise InputError(f"{error}, which {drawn} breaks for member {member + 1}") from None
    return own


def check(trial: Trial, number: int, usual: Mapping[str, Any]) -> None:
    """Refuses the spread of a trial's group if any member gets values that the law's relations forbid."""
    group = trial.groups[number]
    if group.spread and lawentry.relations_of(lawentry.module_of(group.law, group.law_source)):
        for member in range(group.count):
            parameters(trial, number, member, usual)
