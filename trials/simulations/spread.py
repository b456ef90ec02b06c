"""Heterogeneous groups: a law's parameters drawn anew for each member, `herd.spread.NAME` to either side.

Fine 2015, table 3.2 (composition) tells homogeneous from heterogeneous groups; how wide a group spreads is the user's.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np

from flocking import lawentry
from flocking.errors import InputError, unknown_name
from flocking.parameters import Declared, Parameter, checked, declared
from trials.rows import Row
from trials.streams import Purpose, stream
from trials.types import Group, Trial

ABOUT = Parameter("", "a choice: of the value, uniformly to either side, for each member its own", low=0.0, high=1.0)


def put(group: Group, key: str, name: str, value: Any) -> Group:
    """`group` with the spread of one of its law's parameters set. Raises `InputError`."""
    known = declared(lawentry.module_of(group.law, group.law_source).Parameters)
    if name not in known:
        raise unknown_name("parameter", key, [f"{group.name}.spread.{each}" for each in known])
    share = checked(key, value, Declared(name, float, 0.0, ABOUT))
    return dataclasses.replace(group, spread={**group.spread, name: share})


def rows(group: Group) -> list[Row]:
    """The spreads that are set."""
    return [
        Row(f"{group.name}.spread.{name}", share, ABOUT.unit, ABOUT.source, False)
        for name, share in group.spread.items()
    ]


def parameters(trial: Trial, number: int, member: int, usual: Mapping[str, Any]) -> dict[str, Any]:
    """The law's parameters of one member of a trial's group of that number, from those that are `usual` in it.

    A value stays within its parameter's bounds; whole numbers are rounded. Raises `InputError`, naming the spread, for
    values that the law's relations rule out together.
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
        drawn = " and ".join(f"{row.key} = {row.value:g}" for row in rows(group))
        raise InputError(f"{error}, which {drawn} breaks for member {member + 1}") from None
    return own


def check(trial: Trial, number: int, usual: Mapping[str, Any]) -> None:
    """Refuses the spread of a trial's group if it gives any member values that its law's relations rule out."""
    group = trial.groups[number]
    if group.spread and lawentry.relations_of(lawentry.module_of(group.law, group.law_source)):
        for member in range(group.count):
            parameters(trial, number, member, usual)
