"""Parameter-space maps, as a simulation that trials can name: one trial is one map."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from trials.simulations.contract import Simulation
from trials.simulations.environments.recordings import write
from trials.simulations.kinematic import herd
from trials.simulations.maps import fields, keys, loop
from trials.simulations.maps.measures import ABOUT, KEY_MEASURES
from trials.types import Trial, TrialResult, Value, with_setup

MOMENT: dict[str, Value] = {"grid": "2", "refinements": 0, "budget": 2, "pairs": 1, "iterations": 2}
"""Of a trial that is run for a moment, to compile what it needs."""
CONSTANTS = ("flocking.kinematic.motion", "trials.simulations.maps.measures")
UNLIMITED = 100_000
"""Configurations that a map without a budget is given time for."""


def check(trial: Trial) -> None:
    """Refuses a trial whose names and numbers do not fit one another, without compiling anything: `InputError`."""
    fields.chosen_by(trial)
    fields.starts_of(trial)
    for number in range(len(trial.groups)):
        herd.check_group(trial, number)


def settled(trial: Trial) -> Trial:
    """The trial with the schema's own behaviour and parameters by their names."""
    names = {"behaviour": fields.behaviour_of(trial).name, "refined": ", ".join(fields.refined_of(trial))}
    return with_setup(trial, names)


def record(result: TrialResult, path: Path) -> None:
    """Writes the recording of the herd in the most successful configuration."""
    write(result, path)


def limit_s(trial: Trial) -> float:
    """Wall time (s) after which a trial counts as hung."""
    given, members = fields.of_trial(trial), sum(group.count for group in trial.groups)
    steps = 2 * given.pairs * (given.budget or UNLIMITED) * fields.chosen_by(trial).iterations
    return 300.0 + steps * members * (1e-5 + 1e-7 * members)


def moment(trial: Trial) -> Trial:
    """Two configurations, and a herd for two steps in each of their simulations."""
    return with_setup(trial, MOMENT)


def prepare() -> None:
    """Nothing more: all that a trial needs is imported with this module."""


def at_step(trial: Trial, step: int) -> str:
    """A step by its number."""
    return f"at step {step + 1}"


def constants(_trial: Trial) -> list[str]:
    """Modules with numbers that no key sets."""
    return list(CONSTANTS)


def listed(kind: str) -> Mapping[str, object]:
    """Its formation; its worlds are the schemas, which the trials of generated environments list."""
    return {"maps: square": fields.FormationParameters} if kind == "formations" else {}


SIMULATION = Simulation(
    keys_of=keys.keys_of,
    check=check,
    settled=settled,
    run_trial=loop.run_trial,
    record=record,
    measures=ABOUT,
    key_measures=KEY_MEASURES,
    limit_s=limit_s,
    moment=moment,
    prepare=prepare,
    at_step=at_step,
    listed=listed,
    constants=constants,
)
