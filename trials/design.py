"""From an experiment's file (`trials.experiments`) to its list of trials."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any

from flocking.errors import InputError
from trials import keys, simulations
from trials.experiments import experiment_names, experiments, load, made_by, name_of, title
from trials.invoked import spelled
from trials.rows import Row, marked
from trials.types import Trial, Value
from worlds import known as known_worlds

DEFAULT_SEED = 1
MAX_TRIALS = 100_000
FORMATION = "formation."
WORLD = "world"
BRINGING = ("law", "body", "world", "formation")
"""Names that bring values of other keys with them."""


@dataclass(frozen=True)
class Plan:
    """What a run will do."""

    experiment: str
    title: str
    trials: list[Trial]
    parameters: list[Row]
    """Every parameter of the first trial."""
    conditions: dict[str, list[Value]]
    """The experiment's own factors and their values."""
    sweep: dict[str, list[Value]]
    """Factors that a sweep added, and their values: each combination of these is an arm of its own."""
    repeats: int
    notes: list[str]
    """What a user should know of the plan, one line each."""


def plan(
    name: str,
    *,
    repeats: int | None = None,
    seed: int = DEFAULT_SEED,
    settings: Mapping[str, Any] | None = None,
    sweep: Mapping[str, Sequence[Any]] | None = None,
    law: str | None = None,
    pipeline: str | None = None,
    body: str | None = None,
    world: str | None = None,
    most_by: str = "--repeats",
) -> Plan:
    """The trials of an experiment.

    `settings` puts keys to other values: on a key that the experiment varies, this value replaces all of its own.
    `sweep` gives a key several values: on a key that the experiment varies they replace its own, on any other they
    make one arm each. Trials are numbered from 1, repeat by repeat, so that more repeats keep the numbers.
    `most_by`: the flag that says how many repeats there are at the most.
    Raises `InputError` for anything that does not exist or fit.
    """
    module, experiment = load(name), name_of(name)
    repeats = module.REPEATS if repeats is None else repeats
    if repeats < 1:
        raise InputError(f"repeats = {repeats}: expected a whole number of at least 1")
    if seed < 0:
        raise InputError(f"seed = {seed}: expected a whole number of at least 0")
    settings = dict(settings or {})
    arm_values: dict[str, list[Any]] = {key: list(values) for key, values in (sweep or {}).items()}
    for key in settings:
        if key in arm_values:
            raise InputError(f"{key} is both set and swept; expected one of the two")
    conditions: dict[str, list[Any]] = {key: list(values) for key, values in module.CONDITIONS.items()}
    notes: dict[str, None] = {}
    for field, value in (("law", law), ("pipeline", pipeline), ("body", body)):
        if value is not None:
            settings |= _of_first_group(made_by(module, "base", 1), field, value, {**settings, **arm_values}, notes)
    if world is not None:
        settings |= _of_world(made_by(module, "base", 1), world, {**settings, **arm_values})
    for key in [key for key in settings if key in conditions]:
        conditions[key] = [settings.pop(key)]
    for key in [key for key in arm_values if key in conditions]:
        conditions[key] = arm_values.pop(key)
    worlds = [settings.get(WORLD), *arm_values.get(WORLD, ()), *conditions.get(WORLD, ())]
    notes |= dict.fromkeys(_of_files(worlds))
    arms = [dict(zip(arm_values, values, strict=True)) for values in itertools.product(*arm_values.values())]
    designs = [(arm, _cells(module, settings, arm, conditions, notes)) for arm in arms]
    total = repeats * sum(len(cells) for _, cells in designs)
    if total > MAX_TRIALS:
        most = MAX_TRIALS * repeats // total
        each = f"{total} trials of {repeats} repeat{'s' * (repeats != 1)}"
        remedy = f"as by {most_by} {most}" if most else "as by fewer values of what is varied"
        raise InputError(f"{each}: expected at most {MAX_TRIALS}, {remedy}")
    placed = _placed(module, settings, [{**arm, **cell} for arm, cells in designs for cell in cells], notes)
    own = _of_some_starts(module, repeats, {*settings, *conditions, *arm_values}, notes)
    trials: list[Trial] = []
    bases, puts = list[Trial](), dict[tuple[int, int], Trial]()  # most repeats have one base, or a few in turn
    for repeat in range(1, repeats + 1):
        base = dataclasses.replace(made_by(module, "base", repeat), seed=seed, repeat=0)
        if base not in bases:
            bases.append(base)
        turn = bases.index(base)
        for number, (given, cell) in enumerate(placed):
            if (turn, number) not in puts:
                named = dataclasses.replace(base, experiment=experiment, conditions=cell)
                puts[turn, number] = _put(named, {**given, **cell}, left_out=own)
            trial = dataclasses.replace(puts[turn, number], index=len(trials) + 1, repeat=repeat)
            trial = made_by(module, "finish", trial) if hasattr(module, "finish") else trial
            if trial.experiment != experiment or trial.conditions is not cell:  # finished as a trial of its own
                trial = dataclasses.replace(trial, experiment=experiment, conditions=cell)
            trials.append(trial)
    trials = [simulations.settled(trial) for trial in trials]
    notes |= dict.fromkeys(_differences(trials[: len(placed)]))
    return Plan(
        experiment=experiment,
        title=title(module),
        trials=trials,
        parameters=_parameters(module, trials, {*settings, *arm_values}),
        conditions=conditions,
        sweep=arm_values,
        repeats=repeats,
        notes=list(notes),
    )


def _differences(trials: Sequence[Trial]) -> list[str]:
    """A line for each name that is varied and brings more with it than its own parameters; nothing where none does.

    A law may bring the herd in which it starts, and its time step: the laws of a sweep are then not compared alike.
    """
    kinds: dict[tuple[tuple[str, Value], ...], Trial] = {}
    for trial in trials:
        brought = [(key, value) for key, value in trial.conditions.items() if key.rsplit(".", 1)[-1] in BRINGING]
        kinds.setdefault(tuple(brought), trial)
    varied = {key for trial in trials for key in trial.conditions}
    values = {kind: {row.key: row.value for row in keys.rows(trial)} for kind, trial in kinds.items()}
    notes = []
    for name in dict.fromkeys(key for kind in kinds for key, _ in kind):
        own = (f"{name}.", f"{name.removesuffix('law')}spread.") if name.endswith(".law") else (f"{name}.",)
        found: dict[tuple[Any, ...], dict[str, dict[Any, None]]] = {}
        for kind, given in values.items():
            alike = found.setdefault(tuple(each for each in kind if each[0] != name), {})
            for key, value in given.items():
                if key not in varied and not key.startswith(own):
                    alike.setdefault(key, {})[value] = None
        differ: dict[str, dict[Any, None]] = {}
        for alike in found.values():
            for key, several in alike.items():
                if len(several) > 1:
                    differ.setdefault(key, {}).update(several)
        if differ:
            key, (first, *_) = next(iter(differ.items()))
            told = ", ".join(f"{key} ({_span(list(several))})" for key, several in differ.items())
            notes.append(
                f"{name} brings more with it: {told}; --set {key}={spelled(first)} and the like make them share it"
            )
    return notes


def _span(values: Sequence[Any]) -> str:
    """Several values in short: the range of numbers, else all of them."""
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        return f"{min(values):g} to {max(values):g}"
    return " or ".join(map(str, values))


def _of_first_group(
    base: Trial, field: str, value: str, given: Mapping[str, Any], notes: dict[str, None]
) -> dict[str, Any]:
    """The setting made by `--law`, `--pipeline` or `--body`: a key of the first group, which is the herd.

    Raises `InputError` where that key is among those `given`, or where the trial has no such key.
    """
    first, *others = base.groups
    key, obstacles = f"{first.name}.{field}", f"{first.name}.obstacles"
    for other in (key, obstacles) if field == "law" and value.endswith(keys.AVOIDS) else (key,):
        if other in given:
            option = "--sweep" if isinstance(given[other], list) else "--set"
            raise InputError(f"--{field} {value} and {option} {other}={given[other]}: expected one of the two")
    if not keys.has(base, key):
        kinds = {"law": "laws", "pipeline": "pipelines", "body": "bodies"}[field]
        raise InputError(f"--{field} {value}: {base.experiment} has no {kinds}; expected an experiment with {kinds}")
    if others:
        notes[f"--{field} is of {first.name}; of another group: --set {others[0].name}.{field}={value}"] = None
    return {key: value}


def _of_world(base: Trial, world: str, given: Mapping[str, Any]) -> dict[str, Any]:
    """The setting made by `--world`. Raises `InputError` where worlds are among those `given`, or there are none."""
    if WORLD in given:
        option = "--sweep" if isinstance(given[WORLD], list) else "--set"
        raise InputError(f"--world {world} and {option} {WORLD}={given[WORLD]}: expected one of the two")
    if not keys.has(base, WORLD):
        raise InputError(f"--world {world}: {base.experiment} has no worlds; expected an experiment with worlds")
    return {WORLD: world}


def _of_files(values: Sequence[Any]) -> list[str]:
    """What is to be known of the files of worlds among the values of `world`, one line each."""
    files = dict.fromkeys(value for value in values if isinstance(value, str) and known_worlds.is_file(value))
    return [line for file in files for line in known_worlds.told(file)]


def _parameters(module: ModuleType, trials: Sequence[Trial], given: set[str]) -> list[Row]:
    """Every parameter of the first trial, and those that only the formations of others have.

    Those in `given` are marked as set by the user.
    """
    sources, trial = getattr(module, "SOURCES", {}), trials[0]
    usual = _usual(made_by(module, "base", trial.repeat), trial)
    rows = keys.rows(trial, sources)
    firsts: dict[str, Trial] = {}
    for each in trials:
        firsts.setdefault(each.formation, each)
    for other in firsts.values():
        known = {row.key for row in rows}
        more = [row for row in keys.rows(other, sources) if row.key.startswith(FORMATION) and row.key not in known]
        last = max((k for k, row in enumerate(rows) if row.key.startswith(FORMATION)), default=len(rows) - 1)
        rows[last + 1 : last + 1] = more
        if more:
            usual = {row.key: row.value for row in keys.rows(made_by(module, "base", other.repeat))} | usual
    return [marked(row, usual.get(row.key, row.value)) if row.key in given else row for row in rows]


def _usual(base: Trial, trial: Trial) -> dict[str, Any]:
    """The experiment's own value of each key; of a law or a world that is not the experiment's, its own values."""
    usual = {row.key: row.value for row in keys.rows(base)}
    if trial.world != base.world:
        there = dataclasses.replace(base, world=trial.world, world_source=trial.world_source, world_parameters={})
        usual |= {row.key: row.value for row in keys.rows(there) if row.key.startswith(f"{WORLD}.")}
    groups = [
        own if own.law == other.law else dataclasses.replace(other, law_parameters={})
        for own, other in zip(base.groups, trial.groups, strict=False)
    ]
    groups += trial.groups[len(base.groups) :]  # of a trial that was finished with more of them
    others = keys.rows(dataclasses.replace(base, groups=tuple(groups)))
    return usual | {row.key: row.value for row in others if ".law." in row.key}


def _cells(
    module: ModuleType,
    settings: Mapping[str, Any],
    arm: Mapping[str, Any],
    conditions: Mapping[str, Sequence[Any]],
    notes: dict[str, None],
) -> list[dict[str, Any]]:
    """The cells of one arm. Another law may lack a parameter that the experiment varies: it is left out, and noted."""
    chosen = {**settings, **arm}
    names = {key: value for key, value in chosen.items() if not any(_names_first(key)[:2])}
    changed = any(key.rsplit(".", 1)[-1] in ("law", WORLD) for key in names)
    known = {row.key for row in keys.rows(_put(made_by(module, "base", 1), names))} if changed else set(conditions)
    for key in conditions:
        if key not in known:
            what = WORLD if key.startswith(f"{WORLD}.") else "law"
            notes[f"{key} is left out: the {what} has no parameter {key.rsplit('.', 1)[-1]}"] = None
    kept = {key: values for key, values in conditions.items() if key in known}
    if hasattr(module, "cells"):
        return [dict(cell) for cell in made_by(module, "cells", kept)]
    return [dict(zip(kept, values, strict=True)) for values in itertools.product(*kept.values())]


def _placed(
    module: ModuleType, settings: Mapping[str, Any], cells: Sequence[dict[str, Any]], notes: dict[str, None]
) -> list[tuple[dict[str, Any], dict[str, Any]]]:
    """Each cell with the settings that it has a place for: a parameter of one law is not one of another.

    A setting that no cell has a place for stays with all of them, and is refused where it is put.
    """
    parameters = {key for key in settings if any(_names_first(key)[:2])}
    if not parameters:
        return [(dict(settings), cell) for cell in cells]
    known = []
    for cell in cells:
        given = {**settings, **cell}
        names = {key: value for key, value in given.items() if not any(_names_first(key)[:2])}
        known.append({row.key for row in keys.rows(_put(made_by(module, "base", 1), names))} | names.keys())
    everywhere, somewhere = set.intersection(*known), set.union(*known)
    for key in sorted(parameters & somewhere - everywhere):
        notes[f"{key} is left out where there is no such parameter"] = None
    return [
        ({key: value for key, value in settings.items() if key in here or key not in somewhere}, cell)
        for here, cell in zip(known, cells, strict=True)
    ]


def _of_some_starts(module: ModuleType, repeats: int, given: set[str], notes: dict[str, None]) -> frozenset[str]:
    """Of the keys `given` those of a formation's parameters that, of the repeats, some have and others have not.

    None where the formation itself is given.
    """
    asked = [key for key in sorted(given) if key.startswith(FORMATION)]
    if not asked or FORMATION.rstrip(".") in given:
        return frozenset()
    every = [made_by(module, "base", repeat) for repeat in range(1, repeats + 1)]
    bases = {base.formation: base for base in every}.values()
    found = frozenset(key for key in asked if len({keys.has(base, key) for base in bases}) == 2)
    for key in sorted(found):
        notes[f"{key} is left out where the formation has no such parameter"] = None
    return found


def _put(trial: Trial, values: Mapping[str, Any], left_out: Collection[str] = ()) -> Trial:
    """`trial` with these values; those of `left_out` only where it has such a key."""
    for key in sorted(values, key=_names_first):
        if key not in left_out or keys.has(trial, key):
            trial = keys.put(trial, key, values[key])
    return trial


def _names_first(key: str) -> tuple[bool, bool, str]:
    """Laws, pipelines and settings are put before their parameters."""
    parts = key.split(".")
    return len(parts) > 2, parts[0] in ("world", "formation") and len(parts) == 2, key


__all__ = ["DEFAULT_SEED", "Plan", "experiment_names", "experiments", "load", "plan"]
