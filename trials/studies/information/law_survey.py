"""What the experiments over all laws share: which laws take part, by which measures each is judged, and its control.

All of it follows from what a law's file declares, so that a new law joins by itself.

- A law takes part if it reads something of other members and moves in the plane (not along one axis).
- It is judged by the largest group's share, and by polarization, or by MMD if it only aggregates: if it reads no
  heading or velocity. Better than random motion a law must be in what it can do something about: one that reads no
  place cannot gather anybody.
- Its control is random motion at the law's speed, in the law's own herd; of a herd that starts at rest, at the speed
  with which it goes as far as the others' controls.
- A trial lasts until a member at the herd's speed has gone so many times the spacing of the start, or the most steps.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple

from flocking import lawentry, lawsource, selection
from flocking.errors import InputError
from flocking.lawentry import OF_MEMBERS
from flocking.parameters import declared
from flocking.perception import Step
from flocking.taxonomy import Herd
from trials.simulations.kinematic.fields import group, of_group, own_herd
from trials.types import Trial, Value, with_setup

LAW, CONTROL = "herd.law", "random-motion"
ORDERING = frozenset({"shimoyama"})
"""Laws that read nothing but places and order their members all the same: these propel themselves and turn."""
WHERE, WHITHER = frozenset({"positions", "bearings"}), frozenset({"headings", "velocities"})
SHARE, ORDER, SPREAD = "largest_share", "polarization", "mmd"
CONTROL_KEYS = ("herd.law.speed_m_s", "formation.spacing_m", "timestep_s", "steps", "world")
"""What tells the controls of different herds apart."""
FEWEST_STEPS = 100
COUNT = 25
"""Members of a herd."""


class Length(NamedTuple):
    """How long trials last."""

    spacings: float
    """As many spacings as a member at the herd's speed goes; a herd that starts at rest has the most steps."""
    most_steps: int


@cache
def left_out() -> dict[str, str]:
    """Laws that do not take part, and why."""
    reasons = {name: why_not(name) for name in lawsource.names()}
    return {name: why for name, why in reasons.items() if why}


def taking_part() -> tuple[str, ...]:
    """The laws that do."""
    return tuple(name for name in lawsource.names() if name not in left_out())


def why_not(name: str) -> str:
    """Why a law does not take part; empty if it does."""
    if not needs(name):
        return "reads nothing of other members"
    if getattr(lawentry.module_of(name), "AXIS", False):
        return "moves along one axis only"
    return ""


def tessellates(name: str) -> bool:
    """Whether a law selects by Voronoi cells, which must come first in a selection."""
    return Step.VORONOI in _steps_of(name)


@cache
def _steps_of(name: str) -> frozenset[Step]:
    module = lawentry.module_of(name)
    sets = selection.parse_sets("all", lawentry.sets_of(module), declared(module.Parameters))
    return frozenset(chosen.step for steps in sets for chosen in steps)


def needs(name: str) -> frozenset[str]:
    """What a law reads of other members."""
    return lawentry.needs_of(lawentry.module_of(name)) & OF_MEMBERS


@cache
def judged_by(name: str) -> tuple[str, ...]:
    """The measures that say whether a law's herd flocks."""
    return (SHARE, ORDER) if needs(name) & WHITHER or name in ORDERING else (SHARE, SPREAD)


@cache
def told_apart_by(name: str) -> tuple[str, ...]:
    """Those of them in which it must be better than random motion."""
    return judged_by(name) if needs(name) & WHERE else (ORDER,)


def without_goals(trials: Iterable[Trial]) -> str:
    """In a sentence, the laws of kinematic trials that can have a goal and are given none; empty if there are none."""
    names = {
        group.law
        for trial in trials
        for group in trial.groups
        if "goal" in lawentry.needs_of(lawentry.module_of(group.law, group.law_source))
        and of_group(group).informed_share == 0.0
    }
    return f"Of the laws with goals, these run without one here: {', '.join(sorted(names))}." if names else ""


def herd_of(name: str) -> Herd:
    """The herd that a law's file declares."""
    return own_herd(group(name, COUNT))


def steps(herd: Herd, length: Length) -> int:
    """Of a trial of that herd."""
    way = herd.speed_m_s * herd.dt_s
    wanted = math.ceil(length.spacings * herd.spacing_m / way) if way > 0.0 else length.most_steps
    return min(length.most_steps, max(FEWEST_STEPS, wanted))


def control(name: str, length: Length) -> dict[str, Value]:
    """The conditions of the random motion that a law is held against: the same for laws of equal herds."""
    herd = herd_of(name)
    seconds = steps(herd, length) * herd.dt_s
    speed = herd.speed_m_s if herd.speed_m_s > 0.0 else length.spacings * herd.spacing_m / seconds
    given = (speed, herd.spacing_m, herd.dt_s, steps(herd, length), herd.space)
    return {LAW: CONTROL, **dict(zip(CONTROL_KEYS, given, strict=True))}


def controls(names: Sequence[str], length: Length) -> list[dict[str, Value]]:
    """Those of all these laws, each once."""
    found = {tuple(conditions.items()): conditions for conditions in (control(name, length) for name in names)}
    return list(found.values())


def finished(trial: Trial, length: Length, **of_group: Value) -> Trial:
    """`trial` with its steps, its control's speed and cut, and `of_group`, where neither cell nor user set them."""
    (group,) = trial.groups
    herd = own_herd(group)
    if group.law == CONTROL:
        spacing = _number(trial.formation_parameters, "spacing_m", herd.spacing_m)
        speed = _number(group.law_parameters, "speed_m_s", herd.speed_m_s)
        of_trial: dict[str, Value] = {"cut_m": spacing}
        of_group = {**of_group, "speed_m_s": speed}
    else:
        of_trial = {"steps": steps(herd, length)}
    group = with_setup(group, {**of_group, **group.setup})
    return dataclasses.replace(trial, setup={**of_trial, **trial.setup}, groups=(group,))


def wanted_laws(conditions: Mapping[str, Sequence[Any]]) -> list[str]:
    """The laws of a run's conditions; `InputError` for one that does not take part."""
    found = [name if lawentry.is_path(name) else name.replace("_", "-") for name in map(str, conditions[LAW])]
    for name in found:
        if not lawentry.is_path(name) and (why := why_not(name)):
            raise InputError(f"law {name!r} {why}: it has no part in this experiment")
    return found


def _number(values: Mapping[str, Value], name: str, otherwise: float) -> float:
    return float(values.get(name, otherwise))
