"""What the user tells the creature that he controls: a velocity from each of some times on.

As text: `2, 0` in m/s along the world's x and y for all of the time, or `0: 2, 0; 30: 3, 0; 60: 1.5, 0` from each time
in s on.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple

from flocking.errors import InputError


class Leg(NamedTuple):
    """A part of a script."""

    from_s: float
    x_m_s: float
    y_m_s: float

    @property
    def speed(self) -> float:
        """m/s."""
        return math.hypot(self.x_m_s, self.y_m_s)


def parse(text: str) -> tuple[Leg, ...]:
    """The legs that a script's text tells, in the order of their times, the first from 0 on. Raises `InputError`."""
    legs = []
    for part in filter(str.strip, text.split(";")):
        time, colon, velocity = part.rpartition(":")
        try:
            x, y = (float(number) for number in velocity.split(","))
            at = float(time) if colon else 0.0
        except ValueError:
            at = x = y = math.nan
        if not (math.isfinite(at) and math.isfinite(x) and math.isfinite(y)):
            raise InputError(f"script {text!r}: {part.strip()!r}: expected a time and a velocity, as in '30: 2, 0'")
        legs.append(Leg(at, x, y))
    times = [leg.from_s for leg in legs]
    if not legs or times[0] != 0.0 or any(later <= sooner for sooner, later in pairwise(times)):
        raise InputError(f"script {text!r}: expected velocities from growing times on, the first from 0 s")
    return tuple(legs)


def at(legs: tuple[Leg, ...], time: float) -> Leg:
    """The leg at a time (s); the first one before 0."""
    return next((leg for leg in reversed(legs) if leg.from_s <= time + 1e-9), legs[0])
