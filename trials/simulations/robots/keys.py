"""The dotted keys of a trial of robots and of its groups."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from flocking import avoidance, found
from flocking.parameters import Parameter, declared
from robots.body import digest
from sensing import association
from sensing.camera import imperfections, setting
from sensing.laser import hokuyo
from trials.rows import Section, below, section
from trials.simulations import judged, spread
from trials.simulations.robots import desires, fields, guided, wire
from trials.simulations.robots.resolved import Resolved
from trials.types import Group, Trial, with_setup
from worlds import formations

FOR_CREATES = Parameter("", "for Creates: the law's file")


def keys_of(trial: Trial, group: Group | None = None) -> list[Section]:
    """The keys of a trial of robots, or of one of its groups."""
    if group is None:
        world, formation = fields.world_of(trial), formations.parameters_of(trial.formation)
        return [
            section("", fields.TrialFields, lambda: _of_trial(trial)),
            section("world.", world.parameters, lambda: world.values(trial.world_parameters)),
            section(fields.FORMATION, formation, lambda: _all(formation, trial.formation_parameters)),
            *_judged(trial),
            *_guided(trial),
        ]
    its = Resolved(group)
    law, pipeline, creates = its.law.Parameters, its.pipeline.Parameters, its.for_creates
    words = {name: FOR_CREATES for name, value in creates.items() if group.law_parameters.get(name, value) == value}
    return [
        section("", fields.GroupFields, lambda: _of_group(its)),
        *_own_formation(group, its.given.formation),
        Section("law.", declared(law), lambda: _all(law, {**creates, **group.law_parameters}), words),
        spread.section_of(group),
        section("pipeline.", pipeline, lambda: _all(pipeline, group.pipeline_parameters)),
        Section(fields.SENSORS, declared(hokuyo.Parameters), lambda: its.laser._asdict(), _of_setting(its)),
        section(fields.CAMERAS, setting.Parameters, lambda: _shown(its.cameras, its.reads_images)),
        section(fields.IMPERFECTIONS, imperfections.Parameters, lambda: _shown(its.imperfections, its.reads_images)),
        section(fields.ASSOCIATION, association.Parameters, lambda: _shown(its.association, its.wanted.associate)),
        section(fields.AVOIDANCE, avoidance.Parameters, lambda: _shown(its.avoidance, its.avoids)),
    ]


def _of_trial(trial: Trial) -> dict[str, Any]:
    """The values of a trial; its behaviour and its task only where it has one."""
    values, without = fields.of_trial(trial)._asdict(), {"behaviour": judged.NONE, "task": guided.NONE}
    return {key: value for key, value in values.items() if without.get(key) != value}


def _guided(trial: Trial) -> list[Section]:
    """The section of what guides a trial's herd, if anything does."""
    if not guided.has_guides(trial):
        return []
    return [section(guided.PREFIX, guided.Parameters, lambda: guided.parameters(trial)._asdict())]


def _judged(trial: Trial) -> list[Section]:
    """The sections of the behaviour that a trial is held against, if there is one."""
    own = judged.sections(trial)
    if not own:
        return []
    timing = section(judged.BEHAVIOUR, fields.JudgedFields, lambda: {"iteration_s": fields.iteration_s(trial)})
    return [timing, *own]


def _of_group(its: Resolved) -> dict[str, Any]:
    """The values of a group; the files of its body only where it is a user's own, of its link where it has one, which
    velocities it is told of where that is not as usual."""
    values = its.given._asdict()
    hidden = set() if values["body_files"] else {"body_files"}
    if values["link"] == wire.IN_PROCESS:
        hidden |= {"link_address", "link_beyond_loopback"}
    if values["velocities"] == desires.ACTUAL:
        hidden |= {"velocities"}
    return {key: value for key, value in values.items() if key not in hidden}


def _of_setting(its: Resolved) -> dict[str, Parameter]:
    """Sources of the laser's values that the named setting puts in place of the defaults."""
    named, usual = hokuyo.SETTINGS[its.given.sensors], hokuyo.Parameters()
    words = Parameter("", f"the laser's setting {its.given.sensors!r}")
    own = below(its.group.setup, fields.SENSORS)
    return {name: words for name in named._fields if name not in own and getattr(named, name) != getattr(usual, name)}


def settled(trial: Trial) -> Trial:
    """`trial` with its laws' parameters on Creates, and the state of a user's own bodies, written into it."""
    groups = []
    for group in trial.groups:
        its = Resolved(group)
        group = dataclasses.replace(group, law_parameters={**its.for_creates, **group.law_parameters})
        if found.is_path(own := str(group.setup.get("body", ""))):
            body = str(Path(own).resolve())
            group = with_setup(group, {"body": body, "body_files": digest(body)})
        groups.append(group)
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
