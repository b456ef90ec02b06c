"""How well each segmentation finds a cone in other light, farther away, partly hidden and moving.

Kirchner 2006, sections 3.6.4.1 to 3.6.4.3, calls HSV much better under varying light, without a number. Each is
calibrated on the rendered cone at nominal light, as the thesis did on its own; its published ranges are rows of their
own, and so is a detection by blobs, which one would take today. Six posts of other colours stand about, and images have
the noise, blur and offset of a fair camera.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

from flocking.parameters import Parameter
from trials.simulations.cones.fields import trial
from trials.studies.monocular.cone_claims import AXES, KINDS, NOMINAL, PIPELINE
from trials.studies.monocular.cone_claims import robustness_claims as claims
from trials.studies.monocular.cone_figures import robustness_figures as figures
from trials.types import Trial, Value, with_setup

REPEATS = 3
RECORD = "none"
CONDITIONS = {PIPELINE: tuple(KINDS), **AXES}
SOURCES = {
    PIPELINE: Parameter("", "Kirchner 2006, sections 3.6.4 and 3.6.5; blobs are ours"),
    **{axis: Parameter("", "a choice") for axis in AXES},
}
KEY_MEASURES = ("detected", "false_inputs", "distance_deviates", "bearing_error", "pixels_found")


def cells(conditions: Mapping[str, Sequence[Any]]) -> list[dict[str, Value]]:
    """Each kind with each axis varied, the others as they are nominally."""
    found: list[dict[str, Value]] = []
    for kind in conditions[PIPELINE]:
        for axis in AXES:
            for value in conditions[axis]:
                cell = {**KINDS[kind], **NOMINAL, axis: value}
                if cell not in found:
                    found.append(cell)
    return found


def base(repeat: int) -> Trial:
    """Five looks at a cone among posts."""
    made = trial("cone-robustness", repeat, looks=5, distractors=6)
    (eyes,) = made.groups
    return dataclasses.replace(made, groups=(with_setup(eyes, {"cameras.setting": "mild"}),))


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "cells", "claims", "figures"]
