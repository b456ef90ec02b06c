"""The first example of a trial of generated environments as a recording: that of a kinematic herd among its walls."""

from __future__ import annotations

import dataclasses
from pathlib import Path

from trials.simulations.kinematic import fields as of_members
from trials.simulations.kinematic import recordings
from trials.types import TrialResult


def write(result: TrialResult, path: Path) -> None:
    """Writes the recording to `path`, replacing what is there. Raises `OSError` where it cannot be written whole."""
    trial = result.trial
    as_members = of_members.trial(
        trial.experiment, trial.repeat, trial.groups, world="unbounded", steps=max(1, len(result.times) - 1)
    )
    as_members = dataclasses.replace(as_members, index=trial.index, seed=trial.seed, conditions=trial.conditions)
    recordings.write(dataclasses.replace(result, trial=as_members), path)
