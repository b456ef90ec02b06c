"""The simulation `cones`: cameras look at a cone that stands still."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from flocking import found, lawentry
from flocking.errors import InputError
from flocking.parameters import Declared, declared, filled
from sensing.camera import imperfections, setting
from trials.rows import Section, section
from trials.simulations.cones import fields
from trials.simulations.cones.measures import ABOUT, KEY_MEASURES
from trials.simulations.contract import Simulation
from trials.types import Group, Trial, TrialResult, with_setup

CONSTANTS = ("robots.eyes", "trials.simulations.cones.scene")


def keys_of(trial: Trial, group: Group | None = None) -> list[Section]:
    """The keys of such a trial, or of the robot that looks."""
    if group is None:
        return [section("", fields.TrialFields, lambda: fields.of_trial(trial)._asdict())]
    own = fields.of_group(group)
    pipeline = found.load(fields.PIPELINES, own.pipeline, "pipeline").Parameters
    return [
        section("", fields.GroupFields, own._asdict),
        Section("law.", _law(group), lambda: _of_law(group)),
        Section("pipeline.", declared(pipeline), lambda: _pipeline(group)),
        section(fields.CAMERAS, setting.Parameters, lambda: _acting(fields.CAMERAS, fields.cameras_of(group))),
        section(
            fields.IMPERFECTIONS,
            imperfections.Parameters,
            lambda: _acting(fields.IMPERFECTIONS, fields.imperfections_of(group)),
        ),
    ]


def _acting(prefix: str, parameters: Any) -> dict[str, Any]:
    return fields.without_idle(prefix, parameters._asdict())


def _law(group: Group) -> Mapping[str, Declared]:
    return declared(lawentry.module_of(group.law, group.law_source).Parameters)


def _of_law(group: Group) -> dict[str, object]:
    return {name: group.law_parameters.get(name, each.default) for name, each in _law(group).items()}


def _pipeline(group: Group) -> dict[str, object]:
    parameters = found.load(fields.PIPELINES, group.pipeline, "pipeline").Parameters
    values: dict[str, object] = filled(parameters, group.pipeline_parameters, prefix="pipeline.")._asdict()
    return values


def check(trial: Trial) -> None:
    """Refuses a trial whose names and numbers do not fit one another: `InputError`."""
    fields.of_trial(trial)
    group = fields.group_of(trial)
    fields.of_group(group)
    _pipeline(group)
    fields.cameras_of(group)
    fields.imperfections_of(group)
    fields.check_idle(group)


def run_trial(trial: Trial, scans: str, reraise: bool, folder: Path | None) -> TrialResult:
    """See `loop.run_trial`; OpenCV is imported only here, since importing it takes long."""
    from trials.simulations.cones import loop

    return loop.run_trial(trial, scans, reraise, folder)


def record(result: TrialResult, path: Path) -> None:
    """There is nothing to be played back. Raises `InputError`."""
    raise InputError(f"trials of {fields.NAME!r} have no recording: nothing moves; expected --record none")


def limit_s(trial: Trial) -> float:
    """Wall time (s) after which a trial counts as hung."""
    return 60.0 + 2.0 * fields.of_trial(trial).looks


def moment(trial: Trial) -> Trial:
    """One look."""
    return with_setup(trial, {"looks": 1})


def prepare() -> None:
    """Imports all that a trial needs."""
    import trials.simulations.cones.loop  # noqa: F401


def at_step(trial: Trial, step: int) -> str:
    """A look by its number."""
    return f"at look {step + 1}"


def constants(_trial: Trial) -> list[str]:
    """Modules with numbers that no key sets."""
    return list(CONSTANTS)


def listed(kind: str) -> Mapping[str, object]:
    """Nothing of its own: its bodies are those of robots."""
    return {}


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
    reads_images=lambda trial: True,
)
