"""What a `Motion` means for a differential drive: way-point, velocity, heading or acceleration → (v, ω).

One law steers all of them. Let β be the bearing of where to go and s the speed wanted there:

    ω = K β min(1, s / S)        v = s max(0, cos β)

So the robot turns in place while its aim is more than a right angle off its nose, and blends smoothly into driving as
it comes round. The turn fades with the speed wanted: near rest, a bearing that noise swings about does not swing the
robot. The turn rate is limited first, then no wheel may pass its limit; both slow v and ω alike, which keeps the
turn's radius. With an aim straight behind it the robot goes on turning the way it turns already.

An acceleration is added to the present command over one update. There K is 1/dt, so that a lateral acceleration a
turns the robot at a / v, and β in v is what is left of it after the update. Gains and thresholds are choices.
"""

from __future__ import annotations

import math
from typing import Any

from flocking.angles import wrap
from flocking.compilation import compiled
from flocking.types import Kind
from robots.create.drive import Gear, saturated

TURN_GAIN = 2.0
"""K, 1/s; ?: with 0.1 s between updates, 0.05 s of latency and the wheels' ramps it does not overshoot."""
MAX_TURN_RATE = 2.0
"""rad/s; ?: about 0.26 m/s at each wheel when turning in place."""
APPROACH_TIME = 0.5
"""s; ?: towards a way-point at distance d the speed is at most d / this."""
ARRIVED = 0.03
"""m; ?: a moving robot this near to its way-point stops."""
DEPART = 0.1
"""m; ?: a robot at rest sets out for a way-point beyond this: three times the laser's noise."""
FADE_SPEED = 0.05
"""S, m/s; ?: below it the turn fades."""
AIMED = math.radians(1.0)
"""rad; ?: a turning robot this near to its heading stops turning."""
TURN_AWAY = math.radians(3.0)
"""rad; ?: a robot at rest begins to turn to a heading beyond this."""
BEHIND = math.radians(150.0)
"""rad; ?: beyond it the side on which an aim lies does not change the way of turning."""

FOLLOWS = frozenset(Kind)
"""All kinds of `Motion`."""


@compiled
def follow(
    gears: Any,
    kind: int,
    x: float,
    y: float,
    cruise: float,
    speed_now: float,
    turn_rate_now: float,
    dt: float,
) -> tuple[float, float]:
    """Speed (m/s) and turn rate (rad/s) to command for a motion of that `Kind` with numbers x, y.

    gears (1,): what drives the robot, as `drive.recorded` makes it. cruise: speed towards a way-point, m/s. speed_now,
    turn_rate_now: the command in force; hold returns it, and an acceleration adds to it. dt: time to the next update,
    s.
    """
    gear = gears[0]
    at_rest = speed_now == 0.0 and turn_rate_now == 0.0
    if kind == 0:  # hold
        return speed_now, turn_rate_now
    if kind == 2:  # way-point
        distance = math.hypot(x, y)
        if distance <= (DEPART if at_rest else ARRIVED):
            return 0.0, 0.0
        bearing = _kept_side(math.atan2(y, x), turn_rate_now)
        return _steered(gear, bearing, min(cruise, distance / APPROACH_TIME))
    if kind == 3:  # velocity
        return _steered(gear, _kept_side(math.atan2(y, x), turn_rate_now), math.hypot(x, y))
    if kind == 4:  # heading
        bearing = _kept_side(wrap(x), turn_rate_now)
        near = abs(bearing) <= (TURN_AWAY if at_rest else AIMED)
        return _limited(gear, y * max(0.0, math.cos(bearing)), 0.0 if near else TURN_GAIN * bearing)
    if kind == 5:  # acceleration
        forward, sideways = speed_now + x * dt, y * dt
        speed = math.hypot(forward, sideways)
        bearing = _kept_side(math.atan2(sideways, forward), turn_rate_now)
        turn = bearing * min(1.0, speed / FADE_SPEED)
        turn = min(max(turn, -MAX_TURN_RATE * dt), MAX_TURN_RATE * dt)
        return saturated(gear, speed * max(0.0, math.cos(bearing - turn)), turn / dt)
    return 0.0, 0.0  # stop


@compiled
def _kept_side(bearing: float, turn_rate_now: float) -> float:
    """The bearing of an aim behind the robot, measured round the side to which it already turns."""
    if abs(bearing) > BEHIND and bearing * turn_rate_now < 0.0:
        return bearing - math.copysign(2.0 * math.pi, bearing)
    return bearing


@compiled
def _steered(gear: Gear, bearing: float, speed: float) -> tuple[float, float]:
    turn_rate = TURN_GAIN * bearing * min(1.0, speed / FADE_SPEED)
    return _limited(gear, speed * max(0.0, math.cos(bearing)), turn_rate)


@compiled
def _limited(gear: Gear, speed: float, turn_rate: float) -> tuple[float, float]:
    scale = 1.0 if abs(turn_rate) <= MAX_TURN_RATE else MAX_TURN_RATE / abs(turn_rate)
    return saturated(gear, speed * scale, turn_rate * scale)
