"""Simulations, the ways to run a trial: each a folder with a `simulation.py`, imported only where a trial names it."""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

from flocking import found
from flocking.errors import unknown_name
from trials.simulations.contract import Simulation
from trials.simulations.groups import check_given, check_groups
from trials.types import Measure, Trial, TrialResult


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
    own = of(trial)
    check_groups(trial, own.keys_of)
    check_given(trial, own.keys_of)
    own.check(trial)


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
