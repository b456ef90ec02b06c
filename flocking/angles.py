"""The one place where angles are wrapped."""

from __future__ import annotations

import math

import numpy as np

from flocking.compilation import compiled

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
    return (angle + math.pi) % (2.0 * math.pi) - math.pi
