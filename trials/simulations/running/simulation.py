"""The simulation `running`: a herd of point masses or of bodies with legs runs across open ground."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from flocking import lawentry
from flocking.parameters import filled
from trials.rows import Section, section
from trials.simulations import spread
from trials.simulations.contract import Rider, Simulation
from trials.simulations.running import disturbances, fields, herd
from trials.simulations.running.measures import ABOUT, KEY_MEASURES
from trials.types import Group, Trial, TrialResult, with_setup

CONSTANTS = ("trials.simulations.running.measures", "trials.simulations.running.disturbances")


def keys_of(trial: Trial, group: Group | None = None) -> list[Section]:
    """The keys of such a trial, or of its herd."""
    if group is None:
        return [
            section("", fields.TrialFields, lambda: fields.of_trial(trial)._asdict()),
            section("", fields.NameFields, lambda: {"world": trial.world, "formation": trial.formation}),
            section("formation.", fields.FormationFields, lambda: fields.formation_of(trial)._asdict()),
            section(disturbances.GROUND, disturbances.GroundFields, lambda: disturbances.ground_of(trial)._asdict()),
            section(disturbances.PUSH, disturbances.PushFields, lambda: disturbances.pushes_of(trial)._asdict()),
        ]
    law = lawentry.module_of(group.law, group.law_source)
    return [
        section("", fields.GroupFields, lambda: fields.of_group(group)._asdict()),
        section("law.", law.Parameters, lambda: filled(law.Parameters, group.law_parameters)._asdict()),
        spread.section_of(group),
        section(
            disturbances.IMPERFECTIONS,
            disturbances.ImperfectionFields,
            lambda: disturbances.imperfections_of(trial)._asdict(),
        ),
    ]


def check(trial: Trial) -> None:
    """Refuses a trial whose names and numbers do not fit one another, without compiling anything: `InputError`."""
    herd.check(trial)
    disturbances.check(trial)


def run_trial(trial: Trial, scans: str, reraise: bool, folder: Path | None) -> TrialResult:
    """See `loop.run_trial`; MuJoCo and compiled code are imported only here."""
    from trials.simulations.running import loop

    return loop.run_trial(trial, scans, reraise, folder)


def steered(trial: Trial, rider: Rider) -> TrialResult:
    """See `live.run_steered`."""
    from trials.simulations.running import live

    return live.run_steered(trial, rider)


def record(result: TrialResult, path: Path) -> None:
    """Writes the recording. Rerun is imported here alone: it takes long."""
    from trials.simulations.running.recordings import write

    write(result, path)


def limit_s(trial: Trial) -> float:
    """Wall time (s) after which a trial counts as hung."""
    return 120.0 + fields.steps_of(trial) * fields.group_of(trial).count * 1e-3


def moment(trial: Trial) -> Trial:
    """Some hops."""
    duration = min(fields.of_trial(trial).duration_s, 0.5)
    return with_setup(trial, {"duration_s": duration, "settle_s": 0.0, "every_s": 0.1})


def prepare() -> None:
    """Imports all that a trial needs."""
    import trials.simulations.running.loop  # noqa: F401


def at_step(trial: Trial, step: int) -> str:
    """A step as a moment."""
    return f"at {step * fields.of_trial(trial).timestep_s:.2f} s"


def constants(_trial: Trial) -> list[str]:
    """Modules with numbers that no key sets."""
    return list(CONSTANTS)


def listed(kind: str) -> Mapping[str, object]:
    """Its world and its formation; its bodies are those of robots."""
    named: Mapping[str, Mapping[str, object]] = {
        "worlds": {fields.WORLD: fields.TrialFields},
        "formations": {fields.FORMATION: fields.FormationFields},
    }
    return {f"running: {name}": what for name, what in named.get(kind, {}).items()}


SIMULATION = Simulation(
    keys_of=keys_of,
    check=check,
    settled=lambda trial: trial,
    run_trial=run_trial,
    record=record,
    measures=ABOUT,
    key_measures=KEY_MEASURES,
    limit_s=limit_s,
    moment=moment,
    prepare=prepare,
    at_step=at_step,
    listed=listed,
    constants=constants,
    steered=steered,
)
