"""What the choices that link tension's publication leaves open do to its counts, one at a time.

Akama and Naruse 2014 give neither k_p, k_v, the mass nor the time step, neither the arrangement of the lattice nor the
signs of the shifts nor how velocities are drawn. At alpha = 1.6 and a strength of 3, each choice of `link-tension` is
put to other values while all others stay: the report shows what that does to the links at the start, those foretold to
break and those that break. No claim is judged here.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

from trials.simulations.kinematic.lattice_starts import BOTH, POSITION, VELOCITY
from trials.studies.link_tension import link_tension
from trials.types import Trial, Value

REPEATS = 100
RECORD = "none"
CONDITIONS = {"formation": (VELOCITY, POSITION, BOTH)}
KEY_MEASURES = link_tension.KEY_MEASURES
CHOICES: Mapping[str, Sequence[Value]] = {
    "herd.law.spring_per_s2": (0.25, 4.0, 16.0),
    "herd.law.damper_per_s": (0.0, 0.25, 4.0),
    "herd.law.mass": (0.5, 2.0),
    "timestep_s": (0.002, 0.05),
    "formation.arrangement": ("rhombus", "disc"),
    "formation.shifts": ("positive",),
    "formation.velocities": ("norm", "circle", "square", "quadrant"),
}
"""Other values of each choice."""
IDLE = {("formation.shifts", VELOCITY), ("formation.velocities", POSITION)}
"""Choices that a start does not make."""


def base(repeat: int) -> Trial:
    """The publication's middle setting."""
    trial = dataclasses.replace(link_tension.base(repeat), experiment="link-tension-choices")
    return dataclasses.replace(trial, formation_parameters={**trial.formation_parameters, "strength": 3.0})


def cells(conditions: Mapping[str, Sequence[Any]]) -> list[dict[str, Value]]:
    """For each start the usual choices, and each other value of each of them."""
    found: list[dict[str, Value]] = []
    for formation in conditions["formation"]:
        found.append({"formation": formation})
        for key, values in CHOICES.items():
            if (key, formation) not in IDLE:
                found += [{"formation": formation, key: value} for value in values]
    return found


finish = link_tension.finish

__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "base", "cells", "finish"]
