"""Dead reckoning as the Open Interface allows it: whole millimetres and whole degrees since the last request.

The Create counts its wheels' encoders. Each request (here every 15 ms, the machine's data period) returns the
distance and the angle since the request before, truncated towards zero, and starts anew: the remainder is
lost. So a rotation slower than 1 degree in 15 ms (67 degrees/s) reads as none at all, and so does a
translation slower than 1 mm in 15 ms (67 mm/s); all that is faster reads short by up to one unit a request:
0.25 m/s reads as 0.2 m/s. Slip is invisible: only the wheels are counted.

Open Interface: sensor packets 19 (distance) and 20 (angle).
"""

from __future__ import annotations

import math

from flocking.compilation import compiled
from flocking.types import Floats
from robots.create.drive import Gear

POLLING = 0.015
"""s between requests. P: the Open Interface's data period."""

WHOLE = 1e-3
"""mm or degrees: a count this close below a whole number is taken for it (rounding must not cost a unit)."""


@compiled
def request(gear: Gear, left_rad: float, right_rad: float) -> tuple[float, float]:
    """Distance (whole mm) and angle (whole degrees) reported for the wheels' rotations since the last request."""
    distance = 500.0 * gear.wheel_radius * (left_rad + right_rad)
    angle = math.degrees(gear.wheel_radius * (right_rad - left_rad) / gear.axle_track)
    return _whole(distance), _whole(angle)


@compiled
def _whole(value: float) -> float:
    return math.copysign(math.floor(abs(value) + WHOLE), value)


@compiled
def moved(x: float, y: float, heading: float, distance: float, angle: float) -> tuple[float, float, float]:
    """The pose (m, m, rad) after `distance` (m) along an arc through `angle` (rad), by its chord's direction."""
    middle = heading + 0.5 * angle
    return x + distance * math.cos(middle), y + distance * math.sin(middle), heading + angle


@compiled
def move(pose: Floats, distance: float, angle: float) -> None:
    """Changes the pose (3,), m, m, rad, as `moved` does."""
    pose[0], pose[1], pose[2] = moved(pose[0], pose[1], pose[2], distance, angle)
