"""What is measured in a trial of generated environments: how many pass, how many elicit the behaviour, and the uplift.

The uplift is the rate of success of the environments that pass less that of their controls, the workspaces without the
construct, on the same starts.
"""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from flocking.types import Bools, Floats
from generation.behaviours import Behaviour
from trials.types import Measure

ABOUT: dict[str, Measure] = {
    "generated": Measure("", "environments that were generated"),
    "passed": Measure("", "those that passed the filter"),
    "pass_rate": Measure("", "share of the generated environments that passed (Fine 2015, table 7.1)"),
    "valid": Measure("", "environments that passed and elicited the behaviour"),
    "valid_rate": Measure("", "share of those that passed (Fine 2015, table 7.2)"),
    "control_rate": Measure("", "the same of the workspaces without the constructs: the empty-world control"),
    "uplift": Measure("", "valid_rate less control_rate, on the same starts"),
    "gained": Measure("", "share of those that passed in which the behaviour showed with the construct alone"),
    "lost": Measure("", "share of those that passed in which it showed without the construct alone"),
    "tightness": Measure("", "share of all generated environments that elicited the behaviour (section 7.4)"),
    "mean_fitness": Measure("", "of those that passed"),
    "mean_control_fitness": Measure("", "of their controls"),
    "fence": Measure("m", "length of the construct, mean of those that passed"),
    "terminals": Measure("", "primitives of the construct, mean of those that passed"),
}
"""Every measure, in the order in which they are shown."""
MOST_STAGES = 9
"""Of a schema that combines others: later ones are judged and kept with the series, but are no measures. A choice."""
for _stage in range(1, MOST_STAGES + 1):
    ABOUT |= {
        f"stage_{_stage}": Measure("", f"fitness in stage {_stage} of a schema that combines others, mean"),
        f"control_stage_{_stage}": Measure("", f"the same of the workspaces without the constructs, stage {_stage}"),
    }
KEY_MEASURES = ("pass_rate", "valid_rate", "control_rate", "uplift", "tightness")
"""Those that a first look at a run needs."""


class Found(Protocol):
    """What is known of E environments (`loop`)."""

    passed: Bools
    fitness: Floats
    control: Floats
    fence_m: Floats
    stages: Floats
    control_stages: Floats


def measure(found: Found, behaviour: Behaviour) -> dict[str, float]:
    """The measures of one trial, by the names of `ABOUT`; nan where nothing passed.

    Stages are those of a schema that combines others.
    """
    passed = found.passed
    valid = np.array([behaviour.succeeds(value) for value in found.fitness[passed]], np.bool_)
    control = np.array([behaviour.succeeds(value) for value in found.control[passed]], np.bool_)
    values = {
        "generated": len(passed),
        "passed": passed.sum(),
        "pass_rate": passed.mean(),
        "valid": valid.sum(),
        "valid_rate": _mean(valid),
        "control_rate": _mean(control),
        "uplift": _mean(valid) - _mean(control),
        "gained": _mean(valid & ~control),
        "lost": _mean(control & ~valid),
        "tightness": valid.sum() / len(passed),
        "mean_fitness": _mean(found.fitness[passed]),
        "mean_control_fitness": _mean(found.control[passed]),
        "fence": _mean(found.fence_m[passed]),
        "terminals": _mean(found.terminals[passed]),  # type: ignore[attr-defined]
    }
    for stage in range(min(found.stages.shape[1], MOST_STAGES)):
        values[f"stage_{stage + 1}"] = _mean(found.stages[passed, stage])
        values[f"control_stage_{stage + 1}"] = _mean(found.control_stages[passed, stage])
    return {name: float(values[name]) for name in ABOUT if name in values}


def _mean(values: Bools | Floats) -> float:
    return float(values.mean()) if len(values) else math.nan
