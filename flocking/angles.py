"""The one place where angles are wrapped."""

from __future__ import annotations

import math

import numpy as np

from flocking.compilation import compiled
from flocking.types import Floats

LAST = float(np.nextafter(math.pi, 0.0))
"""The largest wrapped angle."""


@compiled
def turn_between(first: float, second: float) -> float:
    """The turn (rad) in [−π, π) from one wrapped angle to another."""
    turn = second - first
    if turn >= math.pi:
        return turn - 2.0 * math.pi
    if turn < -math.pi:
        return min(turn + 2.0 * math.pi, LAST)
    return turn


@compiled
def wrap(angle: float) -> float:
    """`angle` (rad) brought into [−π, π)."""
    if -math.pi <= angle < math.pi:
        return angle
    return min((angle + math.pi) % (2.0 * math.pi) - math.pi, LAST)  # the remainder may round to a whole turn


def wrapped(angles: Floats) -> Floats:
    """The same of an array of angles (…), rad."""
    angles = np.asarray(angles, dtype=np.float64)
    turned: Floats = np.minimum((angles + math.pi) % (2.0 * math.pi) - math.pi, LAST)
    return np.where((angles >= -math.pi) & (angles < math.pi), angles, turned)
