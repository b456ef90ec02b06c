"""How many environments that are valid for kinematic members stay valid for Creates: nobody has published it.

Repeat r is tried in the r-th environment that passes, and in its empty world. The same environments are tried with
kinematic members by `maebe-transfer-members`: `herd run maebe-transfer-members --out …` beside this run's folder, and
the claims read both.
"""

from __future__ import annotations

from trials.studies.environments import tried
from trials.studies.environments.tried import TABLE_CONDITIONS as CONDITIONS
from trials.studies.environments.tried_claims import transfer as claims
from trials.studies.environments.tried_figures import figures
from trials.types import Trial

REPEATS = 60
RECORD = "first"
KEY_MEASURES = ("fitness", "elicited")


def base(repeat: int) -> Trial:
    """A herd of BOIDS that is to split."""
    return tried.of_creates("maebe-transfer", repeat)


def finish(trial: Trial) -> Trial:
    """The environment of its repeat, the number of its members, and its length."""
    return tried.creates(trial, trial.repeat)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "base", "claims", "figures", "finish"]
