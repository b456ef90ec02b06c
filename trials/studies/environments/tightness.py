"""Tightness of every schema (Fine 2015, section 7.4): the share of its constructs that elicit its behaviour.

A trial generates 100 environments of a schema (20 of cattle and 10 Galton boards, whose simulations take long), drawing
its parameters anew for each, and puts a herd into each that passes the schema's filter and into its workspace alone,
from the same start. The share of all that are generated is the tightness; what the constructs add is the uplift.
"""

from __future__ import annotations

from generation import found
from trials.simulations.environments.fields import trial
from trials.studies.environments import design, herding
from trials.studies.environments.tightness_claims import KEYS, claims
from trials.studies.environments.tightness_figures import figures
from trials.types import Trial

REPEATS = 10
RECORD = "none"
CONDITIONS = {KEYS[0]: tuple(found.schemas())}
KEY_MEASURES = ("pass_rate", "tightness", "valid_rate", "control_rate", "uplift")


def base(repeat: int) -> Trial:
    """A hundred environments of a schema, and a herd of BOIDS in those that pass."""
    return trial("tightness", repeat, [design.herd()], "splitting")


def finish(trial: Trial) -> Trial:
    """The herd, its start and the drawn parameters of the trial's schema."""
    return herding.tried(trial)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "base", "claims", "figures", "finish"]
