"""Runs a trial of generated environments: generates them, filters them, and puts its herd into those that pass.

Each environment that passes is simulated twice with the same start and the same random numbers: as it is, and as its
control, the workspace without the construct. A rate of success alone says nothing of environments: its uplift over the
control does.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flocking.errors import InputError
from flocking.kinematic import LawFailedError
from flocking.types import Bools, Floats
from generation.combined import fitness_of
from generation.environment import Environment
from trials.simulations import watch
from trials.simulations.environments import fields, herds, ways
from trials.simulations.environments.measures import measure
from trials.simulations.environments.members import Members
from trials.types import Trial, TrialResult, no_contacts, no_updates

AT_ONCE = 100
"""Environments whose simulations are held at a time."""
MOST_MOMENTS = 101
"""Moments of an example that are kept."""


@dataclasses.dataclass
class _Found:
    """What is known of a trial's E environments."""

    passed: Bools
    """(E,)."""
    fitness: Floats
    """(E,) nan where the environment did not pass."""
    control: Floats
    """(E,) of the workspace alone, likewise."""
    fence_m: Floats
    """(E,) length of the construct."""
    terminals: NDArray[np.int64]
    """(E,) primitives of the construct."""
    walls: list[Floats]
    """(W, 4) of each, m."""
    examples: list[tuple[int, Floats]]
    """Numbers of the first valid environments, with the positions (T, N, 2) of the herd in each."""
    stages: Floats
    """(E, S) fitness in each stage of a schema that combines others, nan where the environment did not pass."""
    control_stages: Floats
    """(E, S) of the workspace alone, likewise."""
    first: tuple[int, Floats] | None = None
    """The same of the first environment that passed."""


def run_trial(trial: Trial, scans: str = "none", reraise: bool = False, folder: Path | None = None) -> TrialResult:
    """Runs one trial and measures it; the same `Trial` gives the same result.

    A law or a behaviour that gives what it must not ends the trial: `outcome` is then `failed`, `reason` says why, and
    what was found until then is kept; with `reraise` the error is raised instead. Raises `InputError` for a trial that
    cannot be set up.
    """
    import flocking.kinematic.kernel  # noqa: F401 (its import compiles it: here, since no watch is on yet)

    began = perf_counter()
    chosen, group = fields.chosen_by(trial), herds.group(trial)
    count = fields.of_trial(trial).environments
    found = _Found(
        np.zeros(count, np.bool_),
        np.full(count, np.nan),
        np.full(count, np.nan),
        np.full(count, np.nan),
        np.zeros(count, np.int64),
        [],
        [],
        np.full((count, len(chosen.parts)), np.nan),
        np.full((count, len(chosen.parts)), np.nan),
    )
    built, outcome, reason = perf_counter(), "done", ""
    try:
        with watch.watched():
            for first in range(0, count, AT_ONCE):
                _judge(trial, range(first, min(first + AT_ONCE, count)), chosen, group, found)
    except (LawFailedError, InputError) as error:
        if reraise:
            raise
        outcome, reason = "failed", " ".join(str(error).split())
    result = _result(trial, chosen, found, outcome, reason)
    timing = {"build_s": built - began, "loop_s": perf_counter() - built}
    measures = measure(found, chosen.behaviour) if outcome == "done" else {}
    return dataclasses.replace(result, measures=measures, timing=timing)


def _judge(trial: Trial, numbers: Sequence[int], chosen: fields.Chosen, group: Members, found: _Found) -> None:
    """Generates the environments of these numbers and judges those that pass the filter."""
    passing: list[tuple[int, Environment]] = []
    for number in numbers:
        whole = herds.environment(trial, number, chosen)
        found.walls.append(whole.walls())
        found.fence_m[number], found.terminals[number] = whole.fence_length(), len(whole.construct)
        found.passed[number] = chosen.filter is None or chosen.filter.accepts(whole, chosen.of_filter)
        if found.passed[number]:
            passing.append((number, whole))
        watch.breathe(number)
    most = fields.of_trial(trial).examples
    for number, whole, positions in ways.of(trial, passing, chosen, group):
        found.fitness[number] = chosen.behaviour.judged(positions, whole, chosen.of_behaviour)
        found.stages[number] = fitness_of(chosen.parts, positions, whole)
        if found.first is None:
            found.first = number, positions.copy()
        if len(found.examples) < most and chosen.behaviour.succeeds(found.fitness[number]):
            found.examples.append((number, positions.copy()))
        watch.breathe(number)
    controls = [(number, herds.without_construct(whole)) for number, whole in passing]
    for number, empty, positions in ways.of(trial, controls, chosen, group, is_control=True):
        found.control[number] = chosen.behaviour.judged(positions, empty, chosen.of_behaviour)
        found.control_stages[number] = fitness_of(chosen.parts, positions, empty)
        watch.breathe(number)


def _result(trial: Trial, chosen: fields.Chosen, found: _Found, outcome: str, reason: str) -> TrialResult:
    """A result whose way is that of the first example, or else of the first environment that passed, if one did."""
    count = sum(group.count for group in trial.groups)
    bands = herds.group(trial).bands
    example = found.examples[0] if found.examples else found.first
    number = example[0] if example is not None else 0
    shown = herds.environment(trial, number, chosen)
    way = example[1] if example is not None else herds.start(trial, number, shown)[None, :, :2]
    picked = np.unique(np.linspace(0, len(way) - 1, min(len(way), MOST_MOMENTS)).round().astype(np.int64))
    kept = np.array([way[picked] for _, way in found.examples]).reshape(-1, len(picked), count, 2)
    return TrialResult(
        trial=trial,
        times=picked.astype(np.float64) * fields.of_trial(trial).timestep_s,
        poses_w=poses_of(way[picked]),
        odometry=np.empty((0, count, 3)),
        bumpers=np.empty((0, count, 2), np.bool_),
        robot_names=tuple(f"{group.name}-{k + 1}" for group in trial.groups for k in range(group.count)),
        radii=np.repeat([band.radius_m for band in bands], [band.count for band in bands]),
        rules=(),
        walls_w=shown.walls(),
        period_m=np.nan,
        updates=no_updates(count),
        contacts=no_contacts(),
        scans=None,
        measures={},
        outcome=outcome,
        reason=reason,
        timing={},
        tables={
            "passed": found.passed,
            "fitness": found.fitness,
            "control": found.control,
            "fence_m": found.fence_m,
            "terminals": found.terminals,
            "walls": np.concatenate([np.empty((0, 4)), *found.walls]),
            "wall_ends": np.cumsum([0, *(len(walls) for walls in found.walls)]),
            "example_numbers": np.array([number for number, _ in found.examples], np.int64),
            "example_ways": kept.astype(np.float32),
            **({"stages": found.stages, "control_stages": found.control_stages} if chosen.parts else {}),
        },
    )


def walls_of(tables: Mapping[str, NDArray[Any]], number: int) -> Floats:
    """(W, 4) the walls of the environment of that number (from 0), m, from a result's tables."""
    ends = tables["wall_ends"]
    walls: Floats = tables["walls"][ends[number] : ends[number + 1]]
    return walls


def poses_of(positions: Floats) -> Floats:
    """(T, N, 3) positions (T, N, 2) and the directions of the ways there; at the start, of the first step."""
    moves = np.diff(positions, axis=0)
    headings = np.arctan2(moves[..., 1], moves[..., 0])
    headings = np.concatenate([headings[:1], headings]) if len(moves) else np.zeros(positions.shape[:2])
    return np.concatenate([positions, np.unwrap(headings, axis=0)[..., None]], axis=-1)
