"""The two ways to run a trial, physical and kinematic; each is imported only where it is asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flocking.parameters import Parameter
from trials.types import Measure, Trial, TrialResult

if TYPE_CHECKING:
    from trials.rows import Row

PHYSICS, KINEMATIC = "physics", "kinematic"
AVOIDS = "+"
"""Behind a law's name: with the avoidance of obstacles that all laws share."""


def is_kinematic(trial: Trial) -> bool:
    """Whether a trial needs neither MuJoCo nor sensors."""
    return trial.simulation == KINEMATIC


def put(trial: Trial, key: str, value: Any) -> Trial:
    """`trial` with one dotted key set; the value is checked. Raises `InputError` naming the nearest keys."""
    if is_kinematic(trial):
        from trials.simulations.kinematic import keys as kinematic

        return kinematic.put(trial, key, value)
    from trials.simulations.robots import keys as physical

    return physical.put(trial, key, value)


def rows(trial: Trial, sources: Mapping[str, Parameter] | None = None) -> list[Row]:
    """Every key of a trial with value, unit and source; `sources` are the experiment's own words for some."""
    if is_kinematic(trial):
        from trials.simulations.kinematic import keys as kinematic

        return kinematic.rows(trial, sources)
    from trials.simulations.robots import keys as physical

    return physical.rows(trial, sources)


def settled(trial: Trial) -> Trial:
    """`trial` with the values written down that its names stand for, so that its run's folder tells them."""
    if is_kinematic(trial):
        return trial
    from trials.simulations.robots import keys as physical

    return physical.settled(trial)


def check(trial: Trial) -> None:
    """Refuses, before anything is run, a trial whose names and numbers do not fit one another: `InputError`."""
    if is_kinematic(trial):
        from trials.simulations.kinematic import herd as kinematic

        kinematic.check(trial)
    else:
        from trials.simulations.robots import herd as physical

        physical.check(trial)


def run_trial(trial: Trial, scans: str = "none", reraise: bool = False) -> TrialResult:
    """Runs one trial and measures it; what goes wrong makes it a failed one, or is raised with `reraise`."""
    if is_kinematic(trial):
        from trials.simulations.kinematic import loop as kinematic

        return kinematic.run_trial(trial, reraise)
    from trials.simulations.robots import loop as physical

    return physical.run_trial(trial, scans, reraise)


def measures_of(trials: Sequence[Trial]) -> dict[str, Measure]:
    """The measures of trials of one kind, in the order in which they are shown."""
    if trials and is_kinematic(trials[0]):
        from trials.simulations.kinematic.links import ABOUT as LINKS
        from trials.simulations.kinematic.measures import ABOUT as KINEMATIC

        return KINEMATIC | LINKS
    from trials.simulations.robots.measures import ABOUT as PHYSICAL

    return PHYSICAL


def key_measures_of(trials: Sequence[Trial]) -> tuple[str, ...]:
    """Of these measures those that a first look at a run needs, unless its experiment names others."""
    if trials and is_kinematic(trials[0]):
        from trials.simulations.kinematic.measures import KEY_MEASURES as KINEMATIC

        return KINEMATIC
    from trials.simulations.robots.measures import KEY_MEASURES as PHYSICAL

    return PHYSICAL


def headings_of(trials: Sequence[Trial]) -> dict[str, str]:
    """The measures that fit on a terminal with their headings, where a simulation has headings of its own; else {}."""
    if trials and is_kinematic(trials[0]):
        return {}
    from trials.simulations.robots.measures import HEADINGS

    return HEADINGS


def record(result: TrialResult, path: Path) -> None:
    """Writes the recording of a finished trial."""
    if is_kinematic(result.trial):
        from trials.simulations.kinematic.recordings import write
    else:
        from trials.simulations.robots.recordings import write
    write(result, path)
