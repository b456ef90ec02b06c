"""The kinematic herd, as a simulation that trials can name. It needs neither MuJoCo nor, but for recordings, Rerun."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from trials.simulations import judged
from trials.simulations.contract import Simulation
from trials.simulations.kinematic import fields, herd, keys, loop, places
from trials.simulations.kinematic.flocks import ABOUT as OF_FLOCKS
from trials.simulations.kinematic.links import ABOUT as OF_LINKS
from trials.simulations.kinematic.measures import ABOUT, KEY_MEASURES
from trials.types import Trial, TrialResult, with_setup

MOMENT_STEPS = 2
"""Steps of a trial that is run for a moment, to compile what it needs."""
CONSTANTS = ("flocking.kinematic.detection", "flocking.kinematic.motion", "trials.simulations.kinematic.measures")


def settled(trial: Trial) -> Trial:
    """The trial itself: what it leaves open is declared by its law, whose version the run's folder tells."""
    return trial


def record(result: TrialResult, path: Path) -> None:
    """Writes the recording. Rerun is imported here alone: it takes long."""
    from trials.simulations.kinematic.recordings import write

    write(result, path)


def limit_s(trial: Trial) -> float:
    """Wall time (s) after which a trial counts as hung."""
    members = sum(group.count for group in trial.groups)
    return 60.0 + fields.of_trial(trial).steps * members * (1e-4 + 1e-7 * members)


def moment(trial: Trial) -> Trial:
    """The first two steps."""
    return with_setup(trial, {"steps": MOMENT_STEPS, "every": 1})


def prepare() -> None:
    """Nothing more: all that a trial needs is imported with this module."""


def at_step(trial: Trial, step: int) -> str:
    """A step by its number."""
    return f"at step {step + 1}"


def constants(_trial: Trial) -> list[str]:
    """Modules with numbers that no key sets."""
    return list(CONSTANTS)


def listed(kind: str) -> Mapping[str, object]:
    """Its worlds and formations; members have no bodies."""
    named = {"worlds": places.WORLD_PARAMETERS, "formations": places.FORMATION_PARAMETERS}.get(kind, {})
    return {f"kinematic: {name}": parameters for name, parameters in named.items()}


SIMULATION = Simulation(
    keys_of=keys.keys_of,
    check=herd.check,
    settled=settled,
    run_trial=loop.run_trial,
    record=record,
    measures={**ABOUT, **OF_LINKS, **OF_FLOCKS, **judged.ABOUT},
    key_measures=KEY_MEASURES,
    limit_s=limit_s,
    moment=moment,
    prepare=prepare,
    at_step=at_step,
    listed=listed,
    constants=constants,
    check_start=herd.check_start,
)
