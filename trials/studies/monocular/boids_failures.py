"""Boids that fail: one in the middle of nine after a minute, and each of twenty with a chance of 0.01 % at each step.

As in `boids-predator`, with normal sight and a predator. A robot that fails stands for good; the others still see it as
a flockmate. The publication shows one flock of nine that such a robot split in two.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flocking.parameters import Parameter
from trials.simulations.kinematic.fields import NEVER
from trials.studies.monocular.boids import COUNT, SOURCES, boids
from trials.studies.monocular.boids import filled_in as finish
from trials.studies.monocular.boids_claims import CHANCE, MIDDLE
from trials.studies.monocular.boids_claims import failure_claims as claims
from trials.studies.monocular.boids_figures import failure_figures as figures
from trials.types import Trial

REPEATS = 100
RECORD = "first"
MINUTE_S, PROBABILITY = 60.0, 1e-4
CONDITIONS = {COUNT: (9, 20), MIDDLE: (MINUTE_S, NEVER), CHANCE: (0.0, PROBABILITY)}
SOURCES = SOURCES | {
    MIDDLE: Parameter("s", "a choice; Kirchner 2006, section 4.5: one in the middle of nine"),
    CHANCE: Parameter("", "Kirchner 2006, section 4.5: 0.01 % at each step", published=True),
}
KEY_MEASURES = ("flocks_before", "flocks_after", "alone_after", "flocks_end", "failed_end")


def base(repeat: int) -> Trial:
    """Twenty boids and a predator for a minute and a half."""
    return boids("boids-failures", repeat, 90)


def cells(conditions: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    """Nine with the failure in their middle; twenty without failures and with those by chance."""
    usual = {COUNT: (20,), MIDDLE: (NEVER,), CHANCE: (0.0,)}  # another law's herd may lack some
    counts, times, chances = (conditions.get(key, usual[key]) for key in (COUNT, MIDDLE, CHANCE))
    nine = [{COUNT: n, MIDDLE: t, CHANCE: 0.0} for n in counts for t in times if n < 20 and t != NEVER]
    twenty = [{COUNT: n, MIDDLE: NEVER, CHANCE: p} for n in counts for p in chances if n >= 20]
    return nine + twenty


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "cells", "claims", "figures", "finish"]
