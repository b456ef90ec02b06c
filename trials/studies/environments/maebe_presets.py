"""How start size, speed and turn limit decide table 7.2 of Fine 2015: `maebe` over what the publication leaves open."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import Any

from trials.studies.environments import design, maebe
from trials.studies.environments.design import Preset, finish
from trials.studies.environments.presets_figures import figures
from trials.types import Trial, Value

REPEATS = 4
RECORD = "none"
CONDITIONS = {
    **maebe.CONDITIONS,
    design.SIZE: (20.0, 30.0, 40.0, 60.0),
    design.SPEED: (1.0, 2.0),
    design.TURN: (0.25, 0.5, 1.0),
}
KEY_MEASURES = maebe.KEY_MEASURES
SOURCES = maebe.SOURCES


def base(repeat: int) -> Trial:
    """A hundred splitting environments for BOIDS."""
    return design.base("maebe-presets", repeat)


def cells(conditions: Mapping[str, Sequence[Any]]) -> list[dict[str, Value]]:
    """Each behaviour in its schema's environments, each law, and all combinations of the three."""
    presets = itertools.product(conditions[design.SIZE], conditions[design.SPEED], conditions[design.TURN])
    return design.cells(conditions, [Preset(*preset) for preset in presets])


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "cells", "figures", "finish"]
