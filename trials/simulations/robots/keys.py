"""The dotted keys of a trial of robots and of its groups."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from flocking import avoidance, lawentry
from flocking.parameters import Parameter, declared
from sensing import association
from sensing.laser import hokuyo
from trials.rows import Section, section
from trials.simulations import spread
from trials.simulations.robots import fields, information
from trials.types import Group, Trial

FOR_CREATES = Parameter("", "for Creates: the law's file")


def keys_of(trial: Trial, group: Group | None = None) -> list[Section]:
    """The keys of a trial of robots, or of one of its groups."""
    if group is None:
        world = fields.world_of(trial).Parameters
        return [
            section("", fields.TrialFields, lambda: fields.of_trial(trial)._asdict()),
            section("world.", world, lambda: _all(world, trial.world_parameters)),
        ]
    law, pipeline = lawentry.module_of(group.law, group.law_source), fields.pipeline_of(group)
    creates = getattr(law, "CREATE", {})
    for_creates = {n: FOR_CREATES for n, v in creates.items() if group.law_parameters.get(n, v) == v}
    return [
        section("", fields.GroupFields, lambda: fields.of_group(group)._asdict()),
        Section(
            "law.",
            declared(law.Parameters),
            lambda: _all(law.Parameters, {**creates, **group.law_parameters}),
            for_creates,
        ),
        spread.section_of(group),
        section("pipeline.", pipeline.Parameters, lambda: _all(pipeline.Parameters, group.pipeline_parameters)),
        section(fields.SENSORS, hokuyo.Parameters, lambda: fields.laser_of(group)._asdict()),
        section(fields.ASSOCIATION, association.Parameters, lambda: _association_shown(group)),
        section(fields.AVOIDANCE, avoidance.Parameters, lambda: _avoidance_shown(group)),
    ]


def settled(trial: Trial) -> Trial:
    """`trial` with the law parameters with which Creates run it written down."""
    groups = []
    for group in trial.groups:
        creates = getattr(lawentry.module_of(group.law, group.law_source), "CREATE", {})
        groups.append(dataclasses.replace(group, law_parameters={**creates, **group.law_parameters}))
    return dataclasses.replace(trial, groups=tuple(groups))


def _association_shown(group: Group) -> dict[str, Any]:
    return fields.association_of(group)._asdict() if information.wanted(group).associate else {}


def _avoidance_shown(group: Group) -> dict[str, Any]:
    return fields.avoidance_of(group)._asdict() if fields.of_group(group).obstacles != fields.AS_LAW else {}


def _all(parameters: type, given: Mapping[str, Any]) -> dict[str, Any]:
    """Every declared parameter with the value given, or its default."""
    return {name: given.get(name, parameter.default) for name, parameter in declared(parameters).items()}
