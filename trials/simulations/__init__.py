"""Simulations, the ways to run a trial: each a folder with a `simulation.py`, imported only where a trial names it."""

from __future__ import annotations

import dataclasses
import importlib
from collections.abc import Mapping, Sequence
from functools import cache, lru_cache
from pathlib import Path

from flocking import found
from flocking.errors import unknown_name
from trials.simulations.contract import Simulation
from trials.simulations.groups import check_given, check_groups
from trials.types import Group, Measure, Trial, TrialResult, compared


def names() -> list[str]:
    """The names of all simulations."""
    return sorted(found.folders(__name__, "simulation"))


def of(trial: Trial) -> Simulation:
    """The simulation that runs a trial. Raises `InputError` with the nearest names if there is none."""
    return named(trial.simulation)


@cache
def named(name: str) -> Simulation:
    """The simulation of that name. Raises `InputError` with the nearest names if there is none."""
    known = found.folders(__name__, "simulation")
    if name not in known:
        raise unknown_name("simulation", name, known)
    simulation: Simulation = importlib.import_module(known[name]).SIMULATION
    return simulation


def check(trial: Trial) -> None:
    """Refuses, before anything is run, a trial whose names and numbers do not fit one another: `InputError`."""
    kind = _Kind(trial)
    try:
        _check_kind(kind)
    except TypeError:  # a value that cannot be compared: it is refused, or checked anew for each trial
        _check(trial)
    of(trial).check_start(trial)


def _check(trial: Trial) -> None:
    own = of(trial)
    check_groups(trial, own.keys_of)
    check_given(trial, own.keys_of)
    own.check(trial)


class _Kind:
    """A trial as what it has in common with its repeats: one check is enough for all of them."""

    def __init__(self, trial: Trial) -> None:
        self.trial = trial
        parts = [compared(getattr(trial, name)) for name in _OF_KIND]
        parts += [tuple(compared(getattr(group, name)) for name in _OF_GROUP) for group in trial.groups]
        self.key = tuple(parts)

    def __hash__(self) -> int:
        return hash(self.key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Kind) and self.key == other.key


_OF_KIND = tuple(
    field.name
    for field in dataclasses.fields(Trial)
    if field.name not in ("experiment", "repeat", "index", "seed", "conditions", "groups")
)
_OF_GROUP = tuple(field.name for field in dataclasses.fields(Group))


@lru_cache(maxsize=10_000)
def _check_kind(kind: _Kind) -> None:
    _check(kind.trial)


def settled(trial: Trial) -> Trial:
    """`trial` with the values that its names stand for written into it, so that its run's folder records them."""
    return of(trial).settled(trial)


def run_trial(trial: Trial, scans: str = "none", reraise: bool = False, folder: Path | None = None) -> TrialResult:
    """Runs one trial and measures it; the same `Trial` gives the same result.

    `scans`: which scans to keep for a recording: `none`, `some` (2 Hz) or `all`. They do not change the result. An
    error makes the trial a failed one, with its reason and what was measured until then; with `reraise` the error is
    raised instead. `folder`: where scans are kept until they are recorded, by default where the system keeps temporary
    files. Raises `InputError` for a trial that cannot be set up.
    """
    own = of(trial)
    check_groups(trial, own.keys_of)
    check_given(trial, own.keys_of)
    return own.run_trial(trial, scans, reraise, folder)


def record(result: TrialResult, path: Path) -> None:
    """Writes the recording of a finished trial. Raises `OSError` where it cannot be written whole."""
    of(result.trial).record(result, path)


def measures_of(trials: Sequence[Trial]) -> Mapping[str, Measure]:
    """The measures of trials of one simulation, in the order in which they are shown."""
    return of(trials[0]).measures if trials else {}


def key_measures_of(trials: Sequence[Trial]) -> tuple[str, ...]:
    """The measures of trials of one simulation that a first look at a report needs."""
    return of(trials[0]).key_measures if trials else ()


def headings_of(trials: Sequence[Trial]) -> Mapping[str, str]:
    """The measures that fit on a terminal with their headings, where a simulation has headings of its own; else {}."""
    return of(trials[0]).headings if trials else {}
