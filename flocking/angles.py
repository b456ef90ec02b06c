"""The one place where angles are wrapped."""

from __future__ import annotations

import math

from flocking.compilation import compiled


@compiled
def wrap(angle: float) -> float:
    """`angle` (rad) brought into [−π, π)."""
    if -math.pi <= angle < math.pi:
        return angle
    return (angle + math.pi) % (2.0 * math.pi) - math.pi
