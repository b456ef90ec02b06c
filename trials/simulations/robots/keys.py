"""Dotted keys: every number and name of a trial can be set by one, as in `herd.law.repulsion_m`."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Annotated, Any, NamedTuple

from flocking import avoidance, found, lawentry, obstacle_selection, selection
from flocking.errors import unknown_name
from flocking.parameters import Parameter, checked, declared
from robots import body as bodies
from sensing import association
from sensing.laser import hokuyo
from trials.rows import Row, added, rows_of, told
from trials.simulations import AVOIDS, spread
from trials.simulations.robots import information
from trials.simulations.robots.knowledge import SOURCES
from trials.simulations.robots.obstacle_stage import AS_LAW, AVOID, CHOICES
from trials.types import Group, Trial
from worlds import formations

FOR_CREATES = "for Creates: the law's file"


class TrialFields(NamedTuple):
    """What a trial has beside its groups."""

    duration_s: Annotated[
        float,
        Parameter("s", "at least a minute: the length of the trials was not published", low=0.1, high=86400.0),
    ] = 60.0
    timestep_s: Annotated[
        float,
        Parameter(
            "s",
            "of physics: motion, odometry and scans agree with half of it (tests/trials/test_timestep.py)",
            low=0.001,
            high=0.02,
        ),
    ] = 0.01
    world: Annotated[str, Parameter("", "Fine 2015, section 2.3.1: an obstacle-free corridor", published=True)] = (
        "corridor"
    )
    formation: Annotated[str, Parameter("", "Fine 2015, figure 2.5, drawn without numbers")] = "single-group"


class GroupFields(NamedTuple):
    """What a group of robots has beside the parameters of its law, pipeline and sensors."""

    count: Annotated[int, Parameter("robots", "Fine 2015, section 2.3.1", published=True, low=1, high=1000)] = 6  # type: ignore[assignment]
    body: Annotated[str, Parameter("", "Fine 2015, section 2.3", published=True)] = "create"
    sensors: Annotated[str, Parameter("", "noise of the laser's data sheet", choices=tuple(hokuyo.SETTINGS))] = (
        "datasheet"
    )
    pipeline: Annotated[str, Parameter("", "Fine 2015, section 2.2", published=True)] = "member-based"
    selection: Annotated[str, Parameter("", "Fine 2015, table 3.1")] = "all"
    law: Annotated[str, Parameter("", "Fine 2015, algorithm 2", published=True)] = "extended-hamilton"
    speed_m_s: Annotated[
        float,
        Parameter("m/s", "not published: half of the Create's top speed; at most the body's", low=0.001),
    ] = 0.25
    rate_hz: Annotated[
        float, Parameter("Hz", "not published: the laser's scan rate (data sheet)", low=0.1, high=100.0)
    ] = 10.0
    phase: Annotated[
        str,
        Parameter(
            "",
            "Fine 2015, section 9.1.1: asynchronous members",
            published=True,
            choices=("random", "together"),
        ),
    ] = "random"
    latency_s: Annotated[
        float,
        Parameter("s", "not published: somewhat less than half a scan from sensing to acting", low=0.0, high=10.0),
    ] = 0.04
    start_moving: Annotated[
        bool, Parameter("", "not published: what a member keeps that has seen nobody yet is to drive straight on")
    ] = True
    role: Annotated[
        int, Parameter("", "what laws that know of roles are told: 0 ordinary, 1 leader or strong", low=0, high=1)
    ] = 0
    informed: Annotated[
        int, Parameter("robots", "the first so many are given the goal, and role 1", low=0, high=1000)
    ] = 0
    goal_x_m: Annotated[float, Parameter("m", "of the goal, in the world; far away it is a preferred direction")] = 0.0
    goal_y_m: Annotated[float, Parameter("m", "likewise")] = 0.0
    own_motion: Annotated[
        str,
        Parameter(
            "",
            "choice: the Create's odometry loses slow turns (trials/simulations/robots/knowledge.py)",
            choices=SOURCES,
        ),
    ] = "commands"
    association: Annotated[
        str,
        Parameter("", "Fine 2015, section 3.6.3; at work where the law needs it", choices=information.ASSOCIATIONS),
    ] = information.TWO_SCANS
    obstacles: Annotated[
        str, Parameter("", "Fine 2015, figure 3.3: left to the law, avoided, or made virtual members", choices=CHOICES)
    ] = "as-law"
    obstacle_selection: Annotated[str, Parameter("", "Fine 2015, figure 3.3, which leaves it open")] = "all"


def put(trial: Trial, key: str, value: Any) -> Trial:
    """`trial` with one key set; the value is checked. Raises `InputError` naming the nearest keys."""
    fields = declared(TrialFields)
    if key in fields:
        return dataclasses.replace(trial, **{key: _named(key, checked(key, value, fields[key]))})
    parts = key.split(".")
    if parts[0] == "world" and len(parts) == 2:
        module = found.load("worlds", trial.world, "world")
        given = added(trial.world_parameters, key, parts[1], value, declared(module.Parameters), _keys(trial))
        return dataclasses.replace(trial, world_parameters=given)
    for number, group in enumerate(trial.groups):
        if parts[0] == group.name and 2 <= len(parts) <= 3:
            changed = _put_group(trial, group, key, parts[1:], value)
            return dataclasses.replace(trial, groups=(*trial.groups[:number], changed, *trial.groups[number + 1 :]))
    raise unknown_name("parameter", key, _keys(trial))


def rows(trial: Trial, sources: Mapping[str, Parameter] | None = None) -> list[Row]:
    """Every key of a trial with value, unit and source; `sources` are the experiment's own words for some."""
    found_rows = rows_of(TrialFields, "", vars(trial))
    module = found.load("worlds", trial.world, "world")
    found_rows += rows_of(module.Parameters, "world.", trial.world_parameters)
    for group in trial.groups:
        name = f"{group.name}."
        found_rows += rows_of(GroupFields, name, vars(group))
        found_rows += [*_law_rows(group), *spread.rows(group)]
        pipeline = found.load("sensing.pipelines", group.pipeline, "pipeline")
        found_rows += rows_of(pipeline.Parameters, f"{name}pipeline.", group.pipeline_parameters)
        setting = hokuyo.SETTINGS[group.sensors]._asdict()
        found_rows += rows_of(hokuyo.Parameters, f"{name}sensors.", {**setting, **group.sensor_parameters})
        if information.wanted(group).associate:
            found_rows += rows_of(association.Parameters, f"{name}association.", group.association_parameters)
        if group.obstacles != AS_LAW:
            found_rows += rows_of(avoidance.Parameters, f"{name}avoidance.", group.avoidance_parameters)
    return [told(row, (sources or {}).get(row.key)) for row in found_rows]


def settled(trial: Trial) -> Trial:
    """`trial` with the law parameters with which Creates run it written down."""
    groups = [
        dataclasses.replace(group, law_parameters=information.for_creates(_law_module(group), group.law_parameters))
        for group in trial.groups
    ]
    return dataclasses.replace(trial, groups=tuple(groups))


def _put_group(trial: Trial, group: Group, key: str, parts: list[str], value: Any) -> Group:
    fields = declared(GroupFields)
    if len(parts) == 1 and parts[0] in fields:
        value = checked(key, value, fields[parts[0]])
        if parts[0] == "law":
            return _put_law(group, key, value)
        if parts[0] == "selection":
            law = _law_module(group)
            selection.parse_sets(value, lawentry.sets_of(law), declared(law.Parameters))
        changed = dataclasses.replace(group, **{parts[0]: _named(key, value)})
        return dataclasses.replace(changed, pipeline_parameters={}) if parts[0] == "pipeline" else changed
    if len(parts) == 2 and parts[0] == "spread":
        return spread.put(group, key, parts[1], value)
    if len(parts) == 2:
        places = {
            "law": ("law_parameters", lambda: _law_module(group).Parameters),
            "pipeline": (
                "pipeline_parameters",
                lambda: found.load("sensing.pipelines", group.pipeline, "pipeline").Parameters,
            ),
            "sensors": ("sensor_parameters", lambda: hokuyo.Parameters),
            "association": ("association_parameters", lambda: association.Parameters),
            "avoidance": ("avoidance_parameters", lambda: avoidance.Parameters),
        }
        if parts[0] in places:
            field, parameters = places[parts[0]]
            given = added(getattr(group, field), key, parts[1], value, declared(parameters()), _keys(trial))
            changes: dict[str, Any] = {field: given}
            return dataclasses.replace(group, **changes)
    raise unknown_name("parameter", key, _keys(trial))


def _put_law(group: Group, key: str, value: str) -> Group:
    """Another law, without parameters; a `+` behind its name adds the avoidance of obstacles that all laws share."""
    name = value.removesuffix(AVOIDS)
    if lawentry.is_path(name):
        group = dataclasses.replace(
            group, law=name, law_source=lawentry.read_source(name), law_parameters={}, spread={}
        )
    else:
        group = dataclasses.replace(group, law=_named(key, name), law_source="", law_parameters={}, spread={})
    return dataclasses.replace(group, obstacles=AVOID) if value.endswith(AVOIDS) else group


def _law_rows(group: Group) -> list[Row]:
    """The law's parameters with the values that Creates run it with."""
    law = _law_module(group)
    creates = information.for_creates(law, {})
    found_rows = rows_of(law.Parameters, f"{group.name}.law.", {**creates, **group.law_parameters})
    return [
        row._replace(source=FOR_CREATES, published=False)
        if name in creates and group.law_parameters.get(name, creates[name]) == creates[name]
        else row
        for name, row in zip(declared(law.Parameters), found_rows, strict=True)
    ]


def _named(key: str, value: Any) -> Any:
    """Checks names that mean a file or a function, and gives them their usual spelling."""
    last = key.rsplit(".", 1)[-1]
    packages = {"world": "worlds", "pipeline": "sensing.pipelines", "law": "flocking.laws", "body": "robots"}
    if last == "formation" and value not in formations.FORMATIONS:
        raise unknown_name("formation", value, formations.FORMATIONS)
    if last == "obstacle_selection":
        obstacle_selection.parse(value)
    if last in packages:
        choose(packages[last], value, last)
        return value.replace("_", "-")
    return value


def choose(package: str, name: str, kind: str) -> None:
    """Refuses a name that is no law, pipeline, body or world, though a module of that name may exist."""
    wanted = name.replace("_", "-")
    if wanted not in valid(package):
        raise unknown_name(kind, name, valid(package))


def valid(package: str) -> list[str]:
    """Names of a package's modules that are what the package is for (a body has a `BODY`, a world `walls`)."""
    if package == "robots":
        return list(bodies.names())
    marks = {"worlds": "walls"}
    found_names = sorted(found.modules(package))
    if package not in marks:
        return found_names
    return [n for n in found_names if callable(getattr(found.load(package, n, package), marks[package], None))]


def _keys(trial: Trial) -> list[str]:
    return [row.key for row in rows(trial)]


def _law_module(group: Group) -> Any:
    return lawentry.module_of(group.law, group.law_source)
