"""Robot herds, disturbed: slippery and uneven ground, pushes, weak motors, noise and delay, one thing at a time.

Hodgins and Brogan 1994, section 5, names what its simulation leaves out: motors have no most torque, sensors no noise
and no delay, and the ground is neither uneven nor slippery. Nothing was published: the report sets the share of robots
that stay upright against each. Pushes are an addition.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

from trials.studies.robot_herds import design
from trials.studies.robot_herds.figures import disturbed_figures as figures
from trials.types import Trial, Value, with_setup

REPEATS = 10
RECORD = "none"
CONDITIONS = {
    "ground.friction": (1.0, 0.5, 0.3, 0.2, 0.15, 0.1),
    "ground.uneven_m": (0.0, 0.02, 0.05, 0.08, 0.12),
    "push.impulse_n_s": (0.0, 40.0, 60.0, 80.0, 120.0),
    "herd.imperfections.torque_n_m": (300.0, 40.0, 20.0, 10.0, 5.0),
    "herd.imperfections.velocity_m_s": (0.0, 0.5, 1.0, 2.0),
    "herd.imperfections.angle_deg": (0.0, 3.0, 6.0, 12.0),
    "herd.imperfections.rate_deg_s": (0.0, 15.0, 30.0, 60.0),
    "herd.imperfections.delay_s": (0.0, 0.005, 0.01, 0.015),
}
SOURCES = design.SOURCES
KEY_MEASURES = ("upright", "first_fall", "speed_ratio", "unrest", "collisions", "groups_end")


def base(repeat: int) -> Trial:
    """One-legged robots straight on along x, for 20 s."""
    trial = design.running("herd-disturbed", repeat, 20.0)
    return dataclasses.replace(trial, groups=(with_setup(trial.groups[0], {"body": design.ROBOTS}),))


def cells(conditions: Mapping[str, Sequence[Any]]) -> list[dict[str, Value]]:
    """Nothing that disturbs, and each thing alone: what comes first of a key is the usual."""
    usual: dict[str, Value] = {key: levels[0] for key, levels in conditions.items()}
    return [usual, *({**usual, key: level} for key, levels in conditions.items() for level in levels[1:])]


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "cells", "figures"]
