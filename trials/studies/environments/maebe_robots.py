"""Table 7.3 of Fine 2015: Creates in one environment that is to split them and one that is to corral them."""

from __future__ import annotations

from trials.studies.environments import tried
from trials.studies.environments.tried import TABLE_CONDITIONS as CONDITIONS
from trials.studies.environments.tried_claims import of_table
from trials.studies.environments.tried_figures import figures
from trials.types import Trial

REPEATS = 50
"""Fine 2015 has five: too few for an interval that means something."""
RECORD = "first"
KEY_MEASURES = ("fitness", "elicited")


def base(repeat: int) -> Trial:
    """A herd of BOIDS that is to split."""
    return tried.of_creates("maebe-robots", repeat)


def finish(trial: Trial) -> Trial:
    """Its environment, the number of its members, and its length."""
    return tried.creates(trial, tried.CHOSEN[str(trial.setup.get("behaviour", tried.BEHAVIOURS[0]))])


claims = of_table("table_7_3", "section 7.3")

__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "base", "claims", "figures", "finish"]
