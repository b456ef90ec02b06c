"""Single environments in which Creates, or kinematic members, are tried one trial each (Fine 2015, section 7.3).

An environment is one of those that `maebe` generates, by its number among those that pass. Its units are metres for
kinematic members; for Creates they are scaled by `SCALE`, and an iteration takes as long as a Create at half of its top
speed needs for the way of a kinematic member in one.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Iterator
from functools import cache
from typing import Any

from flocking.parameters import filled
from generation import filters, found
from generation.environment import START as START_MARKER
from generation.files import to_json
from generation.primitives import Point
from trials.environments.robots import SCALE
from trials.simulations.kinematic import fields as of_members
from trials.simulations.robots import fields as of_robots
from trials.streams import Purpose, stream
from trials.studies.environments import design
from trials.studies.environments.design import BEHAVIOUR, LAW, LAWS
from trials.types import Group, Trial, Value, with_setup

BEHAVIOURS = ("simple-split", "corralling")
"""Those that were tried with robots."""
COUNTS = {"simple-split": 4, "corralling": 3}
"""Fine 2015, tables 7.3 and 7.4."""
CONNECTIVITY = 2.0 / 3.0
"""Share of the herd that has to be corralled: Fine 2015, section 7.3."""
PRESETS = {"simple-split": design.LARGE, "corralling": design.SMALL}
"""Speed and turn limit; a choice: at the other preset's speed few members of BOIDS show the behaviour in none of the
first 60 environments."""
CHOSEN = {"simple-split": 22, "corralling": 17}
"""Number of the environment, among those that pass, in which tables 7.3 and 7.4 are tried.

Of the first 60 that in which kinematic members of BOIDS, whom alone environments steer, show the behaviour most often
(`scripts/valid.py`).
"""
ITERATIONS = {"simple-split": 200, "corralling": 500}
CREATE_M_S = 0.25
"""Half of a Create's top speed."""
FILE = "environment.json"
"""Path that a trial's world is named by; its text travels with the trial."""
START = {"gap_m": 0.5, "length_m": 1.6, "half_width_m": 0.5}
"""m; of Creates. A choice: four find room in it, and it is as large as the square of `START_UNITS`."""
START_UNITS = 25.0
"""Side of the square in which kinematic members start. A choice: robots have no room in one of 40 units among walls."""
ROOM_UNITS = 24.0
"""Radius about the start in which no wall stands: a Create's farthest place at the start, and its radius."""
KEYS = (BEHAVIOUR, LAW)
CONDITIONS = {BEHAVIOUR: BEHAVIOURS, LAW: LAWS}
CONSTRUCT = "world.construct"
TABLE_KEYS = (*KEYS, CONSTRUCT)
TABLE_CONDITIONS = {**CONDITIONS, CONSTRUCT: (True, False)}
"""Of tables 7.3 and 7.4, each trial beside the empty world."""


def environment(behaviour: str, number: int) -> str:
    """The JSON of the environment of that number (from 1) among those of a behaviour that pass its filter.

    Those in which the herd has no room at its start are passed over.
    """
    known, following = _passing(behaviour)
    while len(known) < number:
        known.append(next(following))
    return known[number - 1]


@cache
def _passing(behaviour: str) -> tuple[list[str], Iterator[str]]:
    """The environments of a behaviour that are known so far, and those that follow."""
    return [], _generated(behaviour)


def _generated(behaviour: str) -> Iterator[str]:
    schema = found.load(design.OF_BEHAVIOURS[behaviour])
    chosen, room = filters.load(schema.filter), filters.load("passage")
    of_schema, of_filter = filled(schema.parameters, {}), filled(chosen.parameters, {})
    of_room = room.filled({"start_m": ROOM_UNITS, "width_m": 0.0})
    for number in itertools.count():
        whole = schema.generate(of_schema, schema.workspace(), stream(1, 1, 0, number, Purpose.WORLD))
        whole = dataclasses.replace(whole, markers={START_MARKER: Point(), **whole.markers})
        if chosen.accepts(whole, of_filter) and room.accepts(whole, of_room):
            yield to_json(whole)


def of_creates(experiment: str, repeat: int) -> Trial:
    """Creates that avoid walls, in an environment for which `creates` puts in another."""
    herd = of_robots.group(LAWS[0], COUNTS[BEHAVIOURS[0]], obstacles="avoid")
    made = of_robots.trial(
        experiment, repeat, [herd], world="open-floor", formation="scattered", behaviour=BEHAVIOURS[0]
    )
    return _placed(made, CHOSEN[BEHAVIOURS[0]], {"scale": SCALE})


def of_kinematic(experiment: str, repeat: int) -> Trial:
    """Kinematic members that avoid walls, in an environment for which `members` puts in another."""
    made = of_members.trial(
        experiment, repeat, [design.herd(COUNTS[BEHAVIOURS[0]])], world="unbounded", formation="single-group",
        behaviour=BEHAVIOURS[0],
    )  # fmt: skip
    return _placed(made, CHOSEN[BEHAVIOURS[0]], {})


def creates(trial: Trial, number: int) -> Trial:
    """The trial in the environment of that number of its behaviour's, at the scale of Creates."""
    behaviour = _behaviour(trial)
    start: dict[str, Value] = {**START, **_heading(behaviour), **trial.formation_parameters}
    placed = _placed(trial, number, {"scale": SCALE})
    placed = dataclasses.replace(placed, formation_parameters=start, groups=_counted(trial, behaviour))
    each = iteration_s(behaviour)
    length: dict[str, Value] = {"duration_s": ITERATIONS[behaviour] * each, "behaviour.iteration_s": each}
    return _relaxed(placed, behaviour, length)


def members(trial: Trial, number: int) -> Trial:
    """The same for kinematic members, at the scale of the document's simulations."""
    behaviour = _behaviour(trial)
    preset = PRESETS[behaviour]
    start: dict[str, Value] = {
        "spacing_m": START_UNITS / COUNTS[behaviour] ** 0.5, **_heading(behaviour), **trial.formation_parameters
    }  # fmt: skip
    placed = _placed(trial, number, {})
    placed = dataclasses.replace(placed, formation_parameters=start, groups=_counted(trial, behaviour))
    placed = design.finish(design.with_bodies(placed, preset))
    return _relaxed(placed, behaviour, {"steps": ITERATIONS[behaviour], "timestep_s": 1.0})


def iteration_s(behaviour: str) -> float:
    """Time in which a Create goes as far as a kinematic member in one iteration, s."""
    return round(PRESETS[behaviour].speed_m_s * SCALE / CREATE_M_S, 6)


def _heading(behaviour: str) -> dict[str, Value]:
    """Headings at the start, as in `maebe`."""
    schema = design.OF_BEHAVIOURS[behaviour]
    return {design.SPREAD: design.SPREAD_DEG[schema]} if schema in design.SPREAD_DEG else {}


def _behaviour(trial: Trial) -> str:
    return str(trial.setup.get("behaviour", BEHAVIOURS[0]))


def _placed(trial: Trial, number: int, parameters: dict[str, Value]) -> Trial:
    """The trial in its environment, unless the user put another world in."""
    if trial.world not in ("open-floor", "unbounded", FILE):
        return trial
    return dataclasses.replace(
        trial,
        world=FILE,
        world_source=environment(_behaviour(trial), number),
        world_parameters={**parameters, **trial.world_parameters},
    )


def _counted(trial: Trial, behaviour: str) -> tuple[Group, ...]:
    (group,) = trial.groups
    usual = group.count == COUNTS[BEHAVIOURS[0]]
    return (dataclasses.replace(group, count=COUNTS[behaviour]) if usual else group,)


def _relaxed(trial: Trial, behaviour: str, setup: dict[str, Value]) -> Trial:
    """The trial's length, and two thirds of the herd for corralling, where the user sets nothing else."""
    own: dict[str, Any] = {"behaviour.connectivity": CONNECTIVITY} if behaviour == "corralling" else {}
    return with_setup(trial, {**setup, **own, **trial.setup})
