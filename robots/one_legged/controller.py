"""What a `Motion` means for the one-legged robot, which runs in any direction: the velocity to command.

A command is a velocity (forward, left) in m/s along the axes that the robot has when it is told; the robot's nose
comes round to the way it runs. Speeds are limited to `MAX_SPEED`.
"""

from __future__ import annotations

import math

from flocking.compilation import compiled
from flocking.types import Kind

MAX_SPEED = 3.5
"""m/s; ?: of a command. The published tests go to 3 m/s; the robot runs a hundredth faster than it is told."""
APPROACH_TIME = 1.0
"""s; ?: towards a way-point at distance d the speed is at most d / this: two hops."""
ARRIVED = 0.1
"""m; ?: a robot this near to its way-point hops on the spot."""

FOLLOWS = frozenset(Kind)
"""All kinds of `Motion`."""


@compiled
def limited(x: float, y: float) -> tuple[float, float]:
    """The velocity, no faster than `MAX_SPEED`, m/s."""
    scale = min(1.0, MAX_SPEED / max(math.hypot(x, y), 1e-12))
    return scale * x, scale * y


@compiled
def follow(
    kind: int, x: float, y: float, cruise: float, forward_now: float, left_now: float, dt: float
) -> tuple[float, float]:
    """Velocity forward and left to command, m/s, for a motion of that `Kind` with numbers x, y.

    cruise: speed towards a way-point, m/s. forward_now, left_now: the command in force. dt: time to the next update, s.
    Hold: as fast as now, straight ahead. Stop: hop on the spot. Heading: at speed y towards the bearing x.
    """
    if kind == 0:  # hold
        return math.hypot(forward_now, left_now), 0.0
    if kind == 2:  # way-point
        distance = math.hypot(x, y)
        if distance <= ARRIVED:
            return 0.0, 0.0
        speed = min(cruise, distance / APPROACH_TIME)
        return limited(speed * x / distance, speed * y / distance)
    if kind == 3:  # velocity
        return limited(x, y)
    if kind == 4:  # heading
        return limited(y * math.cos(x), y * math.sin(x))
    if kind == 5:  # acceleration
        return limited(forward_now + x * dt, left_now + y * dt)
    return 0.0, 0.0  # stop
