"""Cattle of two classes are corralled, lined up and sorted in sequence: the schema `cattle` (Fine 2015, section 6.1.3).

A trial puts ten members that are driven along y, five tame and five shy of walls, into environments of the schema
`cattle` and into their workspace alone, from the same start; each stage's fitness stands beside its control's. The
walls are the schema's own, or drawn anew between their bounds.
"""

from __future__ import annotations

from trials.simulations.environments.fields import trial
from trials.studies.environments import design, herding
from trials.studies.environments.cattle_claims import KEYS, WALLS, claims
from trials.studies.environments.cattle_figures import figures
from trials.types import Trial

REPEATS = 10
RECORD = "first"
CONDITIONS = {KEYS[0]: tuple(WALLS)}
KEY_MEASURES = ("stage_1", "control_stage_1", "stage_2", "control_stage_2", "stage_3", "control_stage_3")


def base(repeat: int) -> Trial:
    """Twenty environments of the schema."""
    return trial("cattle-stages", repeat, [design.herd()], "cattle")


def finish(trial: Trial) -> Trial:
    """Both classes, and where they start."""
    return herding.tried(trial)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "base", "claims", "figures", "finish"]
