"""Dotted keys of a kinematic trial: `steps`, `world.size_m`, `herd.law.range_m`, `herd.selection`."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from flocking import found, lawentry, selection
from flocking.errors import unknown_name
from flocking.parameters import Parameter, checked, declared
from trials.rows import Row, added, rows_of, told
from trials.simulations import AVOIDS, spread
from trials.simulations.kinematic import fields, links
from trials.types import Group, Trial


def put(trial: Trial, key: str, value: Any) -> Trial:
    """`trial` with one key set; the value is checked. Raises `InputError` naming the nearest keys."""
    names, numbers, parts = declared(fields.NameFields), declared(fields.TrialFields), key.split(".")
    if key in names:
        return dataclasses.replace(trial, **{key: checked(key, value, names[key])})
    if key in numbers:
        return dataclasses.replace(trial, kinematics={**trial.kinematics, key: checked(key, value, numbers[key])})
    if parts[0] == "world" and len(parts) == 2:
        known = declared(fields.WORLD_PARAMETERS[fields.space_of(trial)])
        given = added(trial.world_parameters, key, parts[1], value, known, _keys(trial))
        return dataclasses.replace(trial, world_parameters=given)
    if parts[0] == "formation" and len(parts) == 2:
        known = declared(fields.FORMATION_PARAMETERS[trial.formation])
        given = added(trial.formation_parameters, key, parts[1], value, known, _keys(trial))
        return dataclasses.replace(trial, formation_parameters=given)
    if parts[0] == "links" and len(parts) == 2:
        known = declared(links.Parameters)
        return dataclasses.replace(trial, links=added(trial.links, key, parts[1], value, known, _keys(trial)))
    for number, group in enumerate(trial.groups):
        if parts[0] == group.name and len(parts) > 1:
            changed = _put_group(trial, group, key, parts[1:], value)
            return dataclasses.replace(trial, groups=(*trial.groups[:number], changed, *trial.groups[number + 1 :]))
    raise unknown_name("parameter", key, _keys(trial))


def rows(trial: Trial, sources: Mapping[str, Parameter] | None = None) -> list[Row]:
    """Every key with the value that will be used, its unit and source; `sources`: the experiment's own words."""
    found_rows = [
        *rows_of(fields.TrialFields, "", fields.of_trial(trial)._asdict()),
        *rows_of(fields.NameFields, "", vars(trial)),
        *rows_of(fields.WORLD_PARAMETERS[fields.space_of(trial)], "world.", fields.world_of(trial)._asdict()),
        *rows_of(fields.FORMATION_PARAMETERS[trial.formation], "formation.", fields.formation_of(trial)._asdict()),
    ]
    measured = fields.links_of(trial)
    if measured is not None:
        found_rows += rows_of(links.Parameters, "links.", measured._asdict())
    for group in trial.groups:
        name = f"{group.name}."
        found_rows += rows_of(fields.GroupNames, name, vars(group))
        found_rows += rows_of(fields.GroupFields, name, fields.of_group(group)._asdict())
        law = lawentry.module_of(group.law, group.law_source)
        found_rows += [*rows_of(law.Parameters, f"{name}law.", group.law_parameters), *spread.rows(group)]
    return [told(row, (sources or {}).get(row.key)) for row in found_rows]


def _put_group(trial: Trial, group: Group, key: str, parts: list[str], value: Any) -> Group:
    names, numbers = declared(fields.GroupNames), declared(fields.GroupFields)
    field = parts[0]
    if len(parts) == 1 and field in names:
        value = checked(key, value, names[field])
        if field == "selection" and ":" not in value:  # named sets are the law's: checked with it
            selection.parse(value)
        if field != "law":
            return dataclasses.replace(group, **{field: value})
        law = value.removesuffix(AVOIDS)
        if law != value:
            group = dataclasses.replace(group, kinematics={**group.kinematics, "obstacles": "avoid"})
        if lawentry.is_path(law):
            return dataclasses.replace(
                group, law=law, law_source=lawentry.read_source(law), law_parameters={}, spread={}
            )
        found.load("flocking.laws", law, "law")
        return dataclasses.replace(group, law=law.replace("_", "-"), law_source="", law_parameters={}, spread={})
    if len(parts) == 1 and field in numbers:
        return dataclasses.replace(group, kinematics={**group.kinematics, field: checked(key, value, numbers[field])})
    if len(parts) == 2 and field == "spread":
        return spread.put(group, key, parts[1], value)
    if len(parts) == 2 and field == "law":
        known = declared(lawentry.module_of(group.law, group.law_source).Parameters)
        return dataclasses.replace(
            group, law_parameters=added(group.law_parameters, key, parts[1], value, known, _keys(trial))
        )
    raise unknown_name("parameter", key, _keys(trial))


def _keys(trial: Trial) -> list[str]:
    return [row.key for row in rows(trial)]
