"""An open floor without walls."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from worlds.walls import Walls


class Parameters(NamedTuple):
    """The open floor has none."""


def walls(parameters: Parameters) -> Walls:
    """None."""
    return Walls(np.empty((0, 4)), 1.0)


def free_length(parameters: Parameters, radius_m: float) -> float:
    """Infinite."""
    return math.inf
