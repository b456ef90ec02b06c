"""Searches and decompositions, as a simulation that trials can name: one trial is one of them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

from flocking.errors import InputError
from trials.simulations.contract import Simulation
from trials.simulations.environments.recordings import write
from trials.simulations.kinematic import herd
from trials.simulations.searches import fields, keys, loop
from trials.simulations.searches.measures import ABOUT, KEY_MEASURES
from trials.types import Trial, TrialResult, with_setup

MOMENT = {
    "iterations": 2, "search.pairs": 1, "search.budget": 40, "search.best_pairs": 1, "search.elite_pairs": 1,
    "pieces.pairs": 1,
}  # fmt: skip
"""Of a trial that is run for a moment, to compile what it needs."""
CONSTANTS = (
    "flocking.kinematic.motion", "generation.searches.methods", "generation.searches.descriptors",
    "generation.decomposition", "trials.simulations.searches.measures",
)  # fmt: skip


def check(trial: Trial) -> None:
    """Refuses a trial whose names and numbers do not fit one another, without compiling anything: `InputError`."""
    chosen = fields.chosen_by(trial)
    if len(trial.groups) != 1 and fields.of_search(trial).counts != fields.OWN:
        raise InputError(f"search.counts: expected {fields.OWN} for a trial of {len(trial.groups)} groups")
    fields.counts_of(trial)
    fields.archive_of(trial)
    fields.regions_of(trial)
    if fields.of_trial(trial).method != fields.DECOMPOSITION:
        fields.space_searched(trial, chosen)
        fields.points_of(trial)
    else:
        fields.of_pieces(trial)
    for number in range(len(trial.groups)):
        herd.check_group(trial, number)


def settled(trial: Trial) -> Trial:
    """The trial with the schema's own behaviour and parameters by their names."""
    named = {"behaviour": fields.behaviour_of(trial).name}
    if fields.of_trial(trial).method != fields.DECOMPOSITION:
        named["search.parameters"] = ", ".join(fields.searched_of(trial))
    return with_setup(trial, named)


def record(result: TrialResult, path: Path) -> None:
    """Writes the recording of the herd in the best environment, or in the construct that was decomposed."""
    write(result, path)


def limit_s(trial: Trial) -> float:
    """Wall time (s) after which a trial counts as hung."""
    given, pieces = fields.of_search(trial), fields.of_pieces(trial)
    if fields.of_trial(trial).method == fields.DECOMPOSITION:
        simulations, most = 2 * pieces.pairs * 1000, trial.groups[0].count
    else:
        cells = min(math.prod(fields.archive_of(trial)[1]), fields.points_of(trial))
        simulations = given.budget + 2 * given.best_pairs * 200 + 2 * given.elite_pairs * cells
        most = max(fields.counts_of(trial))
    each = fields.chosen_by(trial).iterations * most * (2e-5 + 2e-7 * most)
    return 300.0 + simulations * (0.02 + each)


def moment(trial: Trial) -> Trial:
    """A few points or pieces, and a herd for two steps in each of their simulations."""
    return with_setup(trial, MOMENT)


def prepare() -> None:
    """Nothing more: all that a trial needs is imported with this module or takes a second."""


def at_step(trial: Trial, step: int) -> str:
    """A step by its number."""
    return f"at step {step + 1}"


def constants(_trial: Trial) -> list[str]:
    """Modules with numbers that no key sets."""
    return list(CONSTANTS)


def listed(kind: str) -> Mapping[str, object]:
    """Its formation; its worlds are the schemas, which the trials of generated environments list."""
    return {"searches: square": fields.FormationParameters} if kind == "formations" else {}


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
