"""The dotted keys of a trial of robots and of its groups."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from flocking import avoidance
from flocking.parameters import Parameter, declared
from sensing import association
from sensing.laser import hokuyo
from trials.rows import Section, below, section
from trials.simulations import spread
from trials.simulations.robots import fields
from trials.simulations.robots.resolved import Resolved
from trials.types import Group, Trial
from worlds import formations

FOR_CREATES = Parameter("", "for Creates: the law's file")


def keys_of(trial: Trial, group: Group | None = None) -> list[Section]:
    """The keys of a trial of robots, or of one of its groups."""
    if group is None:
        world, formation = fields.world_of(trial).Parameters, formations.parameters_of(trial.formation)
        return [
            section("", fields.TrialFields, lambda: fields.of_trial(trial)._asdict()),
            section("world.", world, lambda: _all(world, trial.world_parameters)),
            section(fields.FORMATION, formation, lambda: _all(formation, trial.formation_parameters)),
        ]
    its = Resolved(group)
    law, pipeline, creates = its.law.Parameters, its.pipeline.Parameters, its.for_creates
    words = {name: FOR_CREATES for name, value in creates.items() if group.law_parameters.get(name, value) == value}
    return [
        section("", fields.GroupFields, lambda: its.given._asdict()),
        *_own_formation(group, its.given.formation),
        Section("law.", declared(law), lambda: _all(law, {**creates, **group.law_parameters}), words),
        spread.section_of(group),
        section("pipeline.", pipeline, lambda: _all(pipeline, group.pipeline_parameters)),
        section(fields.SENSORS, hokuyo.Parameters, lambda: its.laser._asdict()),
        section(fields.ASSOCIATION, association.Parameters, lambda: _shown(its.association, its.wanted.associate)),
        section(fields.AVOIDANCE, avoidance.Parameters, lambda: _shown(its.avoidance, its.avoids)),
    ]


def settled(trial: Trial) -> Trial:
    """`trial` with the parameters that its laws have on Creates written into it."""
    groups = [
        dataclasses.replace(group, law_parameters={**Resolved(group).for_creates, **group.law_parameters})
        for group in trial.groups
    ]
    return dataclasses.replace(trial, groups=tuple(groups))


def _own_formation(group: Group, formation: str) -> list[Section]:
    """The section of a group's own formation, if it has one."""
    if formation == fields.TOGETHER:
        return []
    parameters = formations.parameters_of(formation)
    return [section(fields.FORMATION, parameters, lambda: _all(parameters, below(group.setup, fields.FORMATION)))]


def _shown(parameters: Any, in_use: bool) -> dict[str, Any]:
    """The parameters to show: all where they are in use, else none."""
    return parameters._asdict() if in_use else {}


def _all(parameters: type, given: Mapping[str, Any]) -> dict[str, Any]:
    """Every declared parameter with the value given, or its default."""
    return {name: given.get(name, parameter.default) for name, parameter in declared(parameters).items()}
