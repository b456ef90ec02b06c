"""Generated environments, as a simulation that trials can name: one trial is a batch of them, and a herd in each."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from flocking.parameters import filled
from generation import found
from trials.rows import below
from trials.simulations.contract import Simulation
from trials.simulations.environments import fields, keys, loop, ways
from trials.simulations.environments.measures import ABOUT, KEY_MEASURES
from trials.simulations.kinematic import herd
from trials.types import Trial, TrialResult, with_setup

MOMENT = {"environments": 8, "iterations": 2, "examples": 0}
"""Of a trial that is run for a moment, to compile what it needs; of so many environments some pass."""
CONSTANTS = ("flocking.kinematic.motion",)


def check(trial: Trial) -> None:
    """Refuses a trial whose names and numbers do not fit one another, without compiling anything: `InputError`."""
    fields.chosen_by(trial)
    fields.formation_of(trial)
    for number in range(len(trial.groups)):
        herd.check_group(trial, number)


def settled(trial: Trial) -> Trial:
    """The trial with the schema's own behaviour and filter by their names."""
    chosen = fields.chosen_by(trial)
    named = {"behaviour": chosen.behaviour.name, "filter": chosen.filter.name if chosen.filter else fields.NO_FILTER}
    return with_setup(trial, named)


def record(result: TrialResult, path: Path) -> None:
    """Writes the recording of the first example. Rerun is imported here alone: it takes long."""
    from trials.simulations.environments.recordings import write

    write(result, path)


def limit_s(trial: Trial) -> float:
    """Wall time (s) after which a trial counts as hung."""
    members = sum(group.count for group in trial.groups)
    given = filled(fields.TrialFields, below(trial.setup, ""))
    steps = 2 * given.environments * fields.chosen_by(trial).iterations
    return 120.0 + steps * members * (2e-5 + 1e-7 * members) + 0.2 * given.environments


def moment(trial: Trial) -> Trial:
    """A few environments, and a herd for two steps in each."""
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
    """The schemas, as its worlds, and its formation."""
    if kind == "worlds":
        return {f"environments: {name}": _About(found.load(name).about) for name in found.schemas()}
    return {"environments: square": fields.FormationParameters} if kind == "formations" else {}


class _About:
    """Something that `herd list` shows with a line of its own."""

    def __init__(self, about: str) -> None:
        self.__doc__ = about


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
    shares=ways.shares,
)
