"""The choices of an experiment that a sensitivity analysis varies, and the range of each.

A choice is a parameter that was not published and that the experiment does not vary as a condition. Its range is what
the parameter declares as plausible (`flocking.parameters.Parameter.plausible`), else half of its value to twice, within
its bounds. A parameter whose value differs among the experiment's conditions follows from them and is none.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from flocking.errors import InputError, unknown_name
from flocking.parameters import Declared
from flocking.types import Floats
from trials import keys, simulations
from trials.design import Plan, load
from trials.rows import Row
from trials.types import Trial, Value

HALF, TWICE = 0.5, 2.0
"""Of a number whose declaration names no plausible range."""
DIGITS = 6
"""Significant digits of a value that is tried: those that its command shows."""


class Choice(NamedTuple):
    """A parameter that was chosen, and its range, which is scaled to [0, 1]."""

    key: str
    value: Value
    """The experiment's own."""
    unit: str
    source: str
    low: float
    high: float
    """Of a number; of names 0 and how many there are."""
    names: tuple[Value, ...] = ()
    """Of a text, a truth value, or a number that has none between some: all that it may be, in order."""

    def at(self, place: float) -> Value:
        """The value at a place in [0, 1]."""
        if self.names:
            return self.names[min(int(place * len(self.names)), len(self.names) - 1)]
        if isinstance(self.value, int):
            return int(min(self.low + math.floor(place * (self.high - self.low + 1.0)), self.high))
        return float(f"{self.low + place * (self.high - self.low):.{DIGITS}g}")

    def place(self) -> float:
        """Where its own value lies in [0, 1]; the middle of those that stand for it, where it is no fraction."""
        if self.names:
            return (self.names.index(self.value) + 0.5) / len(self.names)
        if isinstance(self.value, int):
            return (self.value - self.low + 0.5) / (self.high - self.low + 1.0)
        return (float(self.value) - self.low) / (self.high - self.low)


def choices(plan: Plan, only: Sequence[str] | None = None) -> tuple[list[Choice], list[str]]:
    """The choices of a planned experiment that have a range, and the keys of those that have none.

    `only`: the keys of those that are wanted. Raises `InputError` for one that is no such choice.
    """
    sources = getattr(load(plan.experiment), "SOURCES", {})
    kinds = _kinds(plan.trials)
    about, told, values = _declared(kinds), dict[str, Row](), dict[str, dict[Any, None]]()
    for trial in kinds:
        for row in keys.rows(trial, sources):
            told.setdefault(row.key, row)
            values.setdefault(row.key, {})[row.value] = None
    for key, own in sources.items():
        if key in about and own.plausible is not None:
            about[key] = about[key]._replace(about=dataclasses.replace(about[key].about, plausible=own.plausible))
    found, without = dict[str, Choice](), list[str]()
    for key, row in told.items():
        if row.published or key in plan.conditions or key in plan.sweep or len(values.get(key, {})) != 1:
            continue
        choice = _choice(key, row.value, row.unit, row.source, about[key])
        if choice is not None:
            found[key] = choice
        elif about[key].about.plausible != ():
            without.append(key)
    if only is None:
        return list(found.values()), without
    for key in only:
        if key not in found:
            raise _no_choice(key, plan, told, without, found)
    return [found[key] for key in dict.fromkeys(only)], []


def settings(varied: Sequence[Choice], point: Floats) -> dict[str, Value]:
    """The values, by key, of a point (k,) in [0, 1]; those of the experiment's own are left out."""
    tried = {choice.key: choice.at(float(place)) for choice, place in zip(varied, point, strict=True)}
    return {choice.key: tried[choice.key] for choice in varied if tried[choice.key] != choice.value}


def reference(varied: Sequence[Choice]) -> Floats:
    """(k,) the point of the experiment's own values."""
    return np.array([choice.place() for choice in varied])


def _choice(key: str, value: Any, unit: str, source: str, about: Declared) -> Choice | None:
    """The choice that a parameter is; None where it has no range."""
    plausible = about.about.plausible
    if plausible == ():
        return None
    if isinstance(value, str | bool) or (plausible is not None and len(plausible) > 2):
        names = tuple(plausible or ())
        if len(names) < 2 or value not in names:
            return None
        return Choice(key, value, unit, source, 0.0, float(len(names)), names)
    if plausible is not None and plausible[0] <= value <= plausible[1]:
        low, high = float(plausible[0]), float(plausible[1])
    else:
        low, high = sorted((HALF * value, TWICE * value))
    low, high = max(low, about.about.low), min(high, about.about.high)
    if isinstance(value, int):
        low, high = float(math.ceil(low)), float(math.floor(high))
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        return None
    return Choice(key, value, unit, source, low, high)


def _kinds(trials: Sequence[Trial]) -> list[Trial]:
    """One trial of each combination of conditions and formation."""
    found: dict[tuple[Any, ...], Trial] = {}
    for trial in trials:
        found.setdefault((tuple(trial.conditions.items()), trial.formation), trial)
    return list(found.values())


def _declared(kinds: Sequence[Trial]) -> dict[str, Declared]:
    """How each key of these trials is declared."""
    found: dict[str, Declared] = {}
    for trial in kinds:
        keys_of = simulations.of(trial).keys_of
        for group in (None, *trial.groups):
            start = "" if group is None else f"{group.name}."
            for section in keys_of(trial, group):
                for name, about in section.parameters.items():
                    found.setdefault(f"{start}{section.prefix}{name}", about)
    return found


def _no_choice(
    key: str, plan: Plan, told: Mapping[str, Any], without: Sequence[str], found: Mapping[str, Choice]
) -> InputError:
    """Why a key that was asked for cannot be varied."""
    if key not in told:
        return unknown_name("choice", key, found)
    why = "it follows from others, or no verdict can hang on it"
    if told[key].published:
        why = "its value was published"
    elif key in plan.conditions or key in plan.sweep:
        why = "the experiment varies it as a condition"
    elif key in without:
        why = "it has no plausible range"
    return InputError(f"--keys {key}: {why}; expected of {', '.join(found)}")
