"""The herds of the study: three laws, each with the avoidance that all laws share, and two presets of what is open.

Fine 2015 gives neither where its 25 members start, nor their speed, nor how fast they turn, and these decide table 7.2:
near a good fit of the table the walls change nothing. `LARGE` is a start from which they do; `SMALL` is nearer to the
table. `maebe-presets` varies the three.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from flocking import lawentry
from flocking.errors import InputError
from flocking.parameters import declared
from generation.validation.kinematic import LOOK_AHEAD_STEPS, MARGIN_STEPS
from trials.simulations.environments.fields import trial as environments
from trials.simulations.kinematic.fields import group
from trials.types import Group, Trial, Value

WORLD, BEHAVIOUR, LAW = "world", "behaviour", "herd.law"
SIZE, SPEED, TURN = "formation.size_m", "herd.cruise_m_s", "herd.max_turn_rate_rad_s"
KEYS = (WORLD, BEHAVIOUR, LAW, SIZE, SPEED, TURN)
LAWS = ("reynolds-boids", "viscido-snn", "random-motion")
"""BOIDS, SNN and RM of section 6.3.3; the plus is `herd.obstacles=avoid`."""
OF_BEHAVIOURS = {"simple-split": "splitting", "balanced-split": "splitting", "corralling": "weiring"}
"""The schema whose environments are to elicit each behaviour."""
MEMBERS = 25
SPREAD = "heading_spread_deg"
SPREAD_DEG = {"splitting": 60.0}
"""Headings at the start, ± about the marker's, by schema; all directions elsewhere. A choice: the splitting grammar's
marker heads for its first walls from 60 units before them, and a herd that starts in any direction seldom meets them
(docs/environments.md has both)."""


class Preset(NamedTuple):
    """What the publication leaves open of the start and of the members' bodies."""

    size_m: float
    speed_m_s: float
    turn_rad_s: float


LARGE, SMALL = PRESETS = (Preset(40.0, 2.0, 0.5), Preset(30.0, 1.0, 0.5))
_SPEEDS = ("speed_m_s", "step_m")
"""The parameter by which a law knows its speed: in iterations of one second a step is one as well."""


def herd(count: int = MEMBERS, law: str = LAWS[0]) -> Group:
    """Members that keep away from walls."""
    return group(law, count, obstacles="avoid")


def base(experiment: str, repeat: int, count: int = MEMBERS) -> Trial:
    """A hundred splitting environments, and a herd of BOIDS in those that pass."""
    return environments(experiment, repeat, [herd(count)], "splitting")


def cell(behaviour: str, law: str, preset: Preset) -> dict[str, Value]:
    """The conditions of a law in the environments that are to elicit a behaviour."""
    return {
        WORLD: OF_BEHAVIOURS[behaviour],
        BEHAVIOUR: behaviour,
        LAW: law,
        SIZE: preset.size_m,
        SPEED: preset.speed_m_s,
        TURN: preset.turn_rad_s,
    }


def cells(conditions: Mapping[str, Sequence[Any]], presets: Sequence[Preset] = PRESETS) -> list[dict[str, Value]]:
    """Each behaviour in its schema's environments, each law, each preset, as far as the conditions have them.

    Raises `InputError` where nothing is left.
    """
    found = [
        made
        for preset in presets
        for behaviour in conditions[BEHAVIOUR]
        if behaviour in OF_BEHAVIOURS and OF_BEHAVIOURS[behaviour] in conditions[WORLD]
        for law in conditions[LAW]
        for made in [cell(behaviour, law, preset)]
        if all(made[key] in conditions[key] for key in (SIZE, SPEED, TURN))
    ]
    if not found:
        raise InputError(
            f"{', '.join(KEYS)}: no such cell; expected {' or '.join(OF_BEHAVIOURS)} with its schema, and a preset of "
            f"{' or '.join(f'{p.size_m:g} m, {p.speed_m_s:g} m/s' for p in presets)}"
        )
    return found


def with_bodies(trial: Trial, preset: Preset) -> Trial:
    """The trial with the preset's speed and turn limit in all its groups, where they have none."""
    own: dict[str, Value] = {"cruise_m_s": preset.speed_m_s, "max_turn_rate_rad_s": preset.turn_rad_s}
    groups = tuple(dataclasses.replace(group, setup={**own, **group.setup}) for group in trial.groups)
    return dataclasses.replace(trial, groups=groups)


def finish(trial: Trial) -> Trial:
    """The law's own speed, and how far walls are avoided, go with its members' speed; headings go with the schema.

    What the user sets stays.
    """
    start: dict[str, Value] = {SPREAD: SPREAD_DEG[trial.world]} if trial.world in SPREAD_DEG else {}
    return dataclasses.replace(
        trial,
        formation_parameters={**start, **trial.formation_parameters},
        groups=tuple(map(_at_its_speed, trial.groups)),
    )


def _at_its_speed(group: Group) -> Group:
    speed = group.setup.get("cruise_m_s")
    if speed is None:
        return group
    known = declared(lawentry.module_of(group.law, group.law_source).Parameters)
    own: dict[str, Value] = {name: speed for name in _SPEEDS if name in known}
    ahead, margin = LOOK_AHEAD_STEPS * float(speed), MARGIN_STEPS * float(speed)
    setup: Mapping[str, Value] = {"speed_m_s": speed, "look_ahead_m": ahead, "margin_m": margin, **group.setup}
    return dataclasses.replace(group, law_parameters={**own, **group.law_parameters}, setup=setup)
