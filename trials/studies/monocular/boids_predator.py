"""Kirchner's simulation: three and twenty boids in an octagon, with normal and short sight, a predator and obstacles.

Buckland's boids with the limits of the robots: 100 px/s, 2 rad/s, half a disc of sight ahead of 201 px or 50 px, where
a pixel is 8 mm. Flocks are counted after a minute. The publication ran the
predator without obstacles once or five times; how the other runs went it tells in a sentence.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import Any

from trials.studies.monocular.boids import (
    COUNT,
    NORMAL_M,
    SHORT_M,
    SOURCES,
    VIEW,
    WITH_OBSTACLES,
    WITH_PREDATOR,
    boids,
)
from trials.studies.monocular.boids import filled_in as finish
from trials.studies.monocular.boids_claims import claims
from trials.studies.monocular.boids_figures import figures
from trials.types import Trial

REPEATS = 100
RECORD = "first"
CONDITIONS = {
    COUNT: (3, 20),
    VIEW: (NORMAL_M, SHORT_M),
    WITH_PREDATOR: (1, 0),
    WITH_OBSTACLES: (0, 7),
}
KEY_MEASURES = ("flocks_end", "alone_end", "largest_flock_end", "flock_std_end", "flocks_least")


def base(repeat: int) -> Trial:
    """Twenty boids and a predator for one minute."""
    return boids("boids-predator", repeat, 60)


def cells(conditions: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    """All conditions with normal sight; with short sight the predator without obstacles, as published."""
    every = [dict(zip(conditions, values, strict=True)) for values in itertools.product(*conditions.values())]
    published = [
        cell
        for cell in every
        if cell.get(VIEW) != SHORT_M or (cell.get(WITH_PREDATOR, 1), cell.get(WITH_OBSTACLES, 0)) == (1, 0)
    ]
    return published or every


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "cells", "claims", "figures", "finish"]
