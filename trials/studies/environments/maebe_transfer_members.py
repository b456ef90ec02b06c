"""The environments of `maebe-transfer`, tried with kinematic members: which of them are valid.

Repeat r is tried in the r-th environment that passes, as there.
"""

from __future__ import annotations

from trials.studies.environments import tried
from trials.studies.environments.tried import CONDITIONS
from trials.studies.environments.tried_figures import figures
from trials.types import Trial

REPEATS = 60
RECORD = "first"
KEY_MEASURES = ("fitness", "elicited")


def base(repeat: int) -> Trial:
    """A herd of BOIDS that is to split."""
    return tried.of_kinematic("maebe-transfer-members", repeat)


def finish(trial: Trial) -> Trial:
    """The environment of its repeat, the number of its members, and its length."""
    return tried.members(trial, trial.repeat)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "base", "figures", "finish"]
