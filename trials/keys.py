"""Dotted keys, as in `herd.law.repulsion_m`: every number and name of a trial can be set by its key.

Each simulation declares its keys (`Simulation.keys_of`); this module puts and lists those of all simulations.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from flocking import lawentry, lawsource, selection
from flocking.errors import InputError, unknown_name
from flocking.parameters import Parameter, checked, declared
from generation.piloting import task as tasks
from trials import simulations
from trials.rows import OF_GROUP, OF_TRIAL, Row, Section, below, in_words, rows_of
from trials.types import Group, Trial, with_setup
from worlds import known, start_poses

AVOIDS = "+"
"""Behind a law's name, adds the avoidance of obstacles that all laws share."""


def put(trial: Trial, key: str, value: Any) -> Trial:
    """`trial` with one key set to a value, which is checked. Raises `InputError`, with near keys for an unknown key."""
    first, _, rest = key.partition(".")
    number = next((g for g, group in enumerate(trial.groups) if rest and group.name == first), None)
    group = trial.groups[number] if number is not None else None
    for section, prefix, name in _candidates(trial, group, key if group is None else rest):
        if section.prefix != prefix or name not in section.parameters:
            continue
        value = checked(key, value, section.parameters[name])
        if group is None or number is None:
            return _placed(trial, OF_TRIAL, prefix, name, value)
        if (prefix, name) == ("", "law") and value.endswith(AVOIDS) and not has(trial, f"{group.name}.obstacles"):
            raise InputError(f"{key} = {value!r}: {trial.simulation} knows no avoidance of obstacles; expected no +")
        changed = _group_with(group, prefix, name, value)
        return dataclasses.replace(trial, groups=(*trial.groups[:number], changed, *trial.groups[number + 1 :]))
    raise unknown_name("parameter", key, _nearby(trial, group, key))


def rows(trial: Trial, sources: Mapping[str, Parameter] | None = None) -> list[Row]:
    """Every key of a trial with value, unit and source; `sources`: those that the experiment itself gives, by key.

    What a parameter declares of its source is told of its default alone: a value that the trial has in its place is the
    experiment's.
    """
    keys_of = simulations.of(trial).keys_of
    found_rows = []
    for group in (None, *trial.groups):
        start = "" if group is None else f"{group.name}."
        for section in keys_of(trial, group):
            found_rows += rows_of(section, start, _given(trial if group is None else group, section.prefix))
    return [in_words(row, (sources or {}).get(row.key)) for row in found_rows]


def has(trial: Trial, key: str) -> bool:
    """Whether a trial has such a key."""
    first, _, rest = key.partition(".")
    group = next((group for group in trial.groups if rest and group.name == first), None)
    candidates = _candidates(trial, group, key if group is None else rest)
    return any(section.prefix == prefix and name in section.parameters for section, prefix, name in candidates)


def _given(kept: Trial | Group, prefix: str) -> Mapping[str, Any]:
    """By name, the values with that prefix that a trial or a group has of its own."""
    places = OF_TRIAL if isinstance(kept, Trial) else OF_GROUP
    if prefix in places:
        values: Mapping[str, Any] = getattr(kept, places[prefix])
        return values
    fields = {} if prefix else {field.name: getattr(kept, field.name) for field in dataclasses.fields(kept)}
    return {**fields, **below(kept.setup, prefix)}


def _candidates(trial: Trial, group: Group | None, local: str) -> Iterator[tuple[Section, str, str]]:
    prefix, dot, name = local.rpartition(".")
    for section in simulations.of(trial).keys_of(trial, group):
        yield section, f"{prefix}{dot}", name


def _nearby(trial: Trial, group: Group | None, key: str) -> list[str]:
    """The keys that may be meant: those of the section that the key names, or all that are shown."""
    start = f"{group.name}." if group is not None else ""
    prefix = key.removeprefix(start).rpartition(".")[0]
    sections = simulations.of(trial).keys_of(trial, group) if prefix else []
    own = [name for section in sections if section.prefix == f"{prefix}." for name in section.parameters]
    return [f"{start}{prefix}.{name}" for name in own] or [row.key for row in rows(trial)]


def _placed(kept: Any, places: Mapping[str, str], prefix: str, name: str, value: Any) -> Any:
    """A trial or a group with one value set: in a field of that name, in the section's field or in the setup.

    Of a world of the user's own the text of its file is read, and of what the world before was given only that stays
    which the new one has a place for.
    """
    if isinstance(kept, Trial) and (prefix, name) == ("", "world"):
        return _in_world(kept, value)
    if isinstance(kept, Trial) and (prefix, name) == ("", "formation"):
        return _in_formation(kept, value)
    if isinstance(kept, Trial) and (prefix, name) == ("", "task"):
        return _with_task(kept, value)
    if not prefix and name in {field.name for field in dataclasses.fields(kept)}:
        return dataclasses.replace(kept, **{name: value})
    field, key = (places[prefix], name) if prefix in places else ("setup", f"{prefix}{name}")
    return dataclasses.replace(kept, **{field: {**getattr(kept, field), key: value}})


def _in_world(trial: Trial, world: str) -> Trial:
    """A trial in another world, without the values of the one before that the new one has no place for.

    The name of the world that it has already, where that is a text without a file, changes nothing.
    """
    if world == trial.world and trial.world_source and not Path(world).exists():
        return trial
    source = known.text_of(world) if known.is_file(world) else ""
    trial = dataclasses.replace(trial, world=world, world_source=source)
    sections = simulations.of(trial).keys_of(trial)
    names = {name for section in sections if section.prefix == "world." for name in section.parameters}
    kept = {name: value for name, value in trial.world_parameters.items() if name in names}
    return dataclasses.replace(trial, world_parameters=kept)


def _in_formation(trial: Trial, formation: str) -> Trial:
    """A trial in another starting formation; a file of poses has no parameters."""
    if not start_poses.is_file(formation):
        return dataclasses.replace(trial, formation=formation, formation_source="")
    text = start_poses.text_of(formation)
    return dataclasses.replace(trial, formation=formation, formation_source=text, formation_parameters={})


def _with_task(trial: Trial, task: str) -> Trial:
    """A trial whose herd is guided through another task. The text of a file that it has already is not read again where
    there is no such file."""
    own = tasks.is_file(task)
    if own and task == trial.setup.get("task") and trial.task_source and not Path(task).exists():
        return trial
    text = tasks.own_text(task) if own else ""
    if own:
        tasks.load(task, text)
    return with_setup(dataclasses.replace(trial, task_source=text), {"task": task})


def _group_with(group: Group, prefix: str, name: str, value: Any) -> Group:
    if prefix or name not in ("law", "pipeline", "selection"):
        return _placed(group, OF_GROUP, prefix, name, value)
    if name == "law":
        return _with_law(group, value)
    if name == "pipeline":
        return dataclasses.replace(group, pipeline=value, pipeline_parameters={})
    law = lawentry.module_of(group.law, group.law_source)
    selection.parse_sets(value, lawentry.sets_of(law), declared(law.Parameters))
    return dataclasses.replace(group, selection=value)


def _with_law(group: Group, value: str) -> Group:
    """Another law, without parameters; a `+` behind its name adds the avoidance of obstacles that all laws share."""
    name = value.removesuffix(AVOIDS)
    if lawentry.is_path(name):
        law, source = name, lawsource.read_source(name)
    else:
        lawentry.module_of(name)
        law, source = name.replace("_", "-"), ""
    setup = {**group.setup, "obstacles": "avoid"} if name != value else group.setup
    return dataclasses.replace(group, law=law, law_source=source, law_parameters={}, spread={}, setup=setup)
