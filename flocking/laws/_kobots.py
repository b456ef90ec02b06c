"""What the two laws of Kobots, `turgut` and `gokce_sahin`, share: sensors, alignment, proximal control, parameters.

Source: Turgut, Çelikkanat, Gökçe and Şahin 2008, "Self-organized flocking in mobile robot swarms"; Gökçe and Şahin
2009, "To flock or not to flock: the pros and cons of flocking in long-range migration of mobile robot swarms"; Fine
2015, table A.1. The formulas are told in `turgut`. Metres; distances are between centres.
"""

from __future__ import annotations

import math
from typing import Annotated, Any

from flocking.compilation import compiled
from flocking.parameters import Parameter
from flocking.taxonomy import Filled
from flocking.terms import NEGLIGIBLE, mean_direction, unit
from flocking.types import Bools, Floats

SENSORS = 8
"""In a ring around the body, each of which looks into an eighth of the circle."""
TOUCHING = 7.0
"""The level that a sensor reads of a thing that touches the body; 0 is nothing in reach. No unit."""

FOR_CREATES = {"range_m": 5.6, "sensed_m": 1.4, "touching_m": 0.35, "speed_m_s": 0.25}
"""Parameter values that both laws have with iRobot Creates."""

RangeM = Annotated[float, Parameter("m", "our choice: of the radio that tells headings", low=0.0)]
SensedM = Annotated[float, Parameter("m", "our choice: infrared sensors that reach 0.2 m", low=0.0)]
TouchingM = Annotated[float, Parameter("m", "our choice: a Kobot's diameter", low=0.0)]
DesiredLevel = Annotated[float, Parameter("", "our choice: o_des for robots", low=0.0, high=6.9)]
ProximalWeight = Annotated[float, Parameter("", "our choice: beta", low=0.0)]
SpeedMS = Annotated[float, Parameter("m/s", "our choice: u_max", low=0.0)]

LEVELS = Filled(
    "sensing",
    "table A.1 writes distances in place of the infrared sensors' levels, without changing the signs",
    "levels as in the original, falling linearly from touching to the sensors' range",
    misprint=True,
)
ANGLES = Filled(
    "motion computation",
    "table A.1 leaves the sum of headings without its length, and prints sensor angles of 4k/pi",
    "the unit vector along the sum, and k pi/4, as in the original",
    misprint=True,
)


@compiled
def sensor(x: float, y: float) -> int:
    """Index of the sensor in whose eighth of the circle (x, y) lies; 0 looks ahead, counter-clockwise."""
    eighth = math.floor(abs(math.atan2(y, x)) / (math.pi / 4.0) + 0.5)
    return eighth if y >= 0.0 else (SENSORS - eighth) % SENSORS


@compiled
def level(distance: float, touching: float, reach: float) -> float:
    """What a sensor makes of a thing at that distance: `TOUCHING` at touching or closer, 0 at reach or farther."""
    if distance <= touching:
        return TOUCHING
    if distance >= reach:
        return 0.0
    return TOUCHING * (reach - distance) / (reach - touching)


@compiled
def push(read: float, desired: float) -> float:
    """f of one sensor: below 0 away from the thing, above 0 towards it."""
    share = (read - desired) / (TOUCHING - desired)
    return -share * abs(share)


@compiled
def alignment(headings: Floats, heard: Bools) -> tuple[int, float, float]:
    """How many are heard, and the unit vector along the sum of their headings; (0, 0) if they cancel out.

    Straight ahead if nobody is heard.
    """
    found, x, y = mean_direction(headings, heard)
    if found == 0:
        return 0, 1.0, 0.0
    if math.hypot(x, y) < NEGLIGIBLE:
        return found, 0.0, 0.0
    ux, uy = unit(x, y)
    return found, ux, uy


@compiled
def proximal(positions: Floats, sensed: Bools, points: Floats, parameters: Any) -> tuple[int, float, float]:
    """How many things are sensed, and p: the mean push over all sensors, along x and y of the body.

    Things are the members `sensed`, at their centres, and the obstacles' nearest `points` (K, 2). `parameters` are
    those of either law.
    """
    touching_m, sensed_m, desired = parameters.touching_m, parameters.sensed_m, parameters.desired_level
    body = touching_m / 2.0
    found, px, py = 0, 0.0, 0.0
    for k in range(SENSORS):
        read, wanted, any_here = 0.0, 0.0, False
        for j in range(len(sensed)):
            x, y = positions[j, 0], positions[j, 1]
            if sensed[j] and (x != 0.0 or y != 0.0) and sensor(x, y) == k:
                here = level(math.hypot(x, y), touching_m, sensed_m)
                found += 1
                if not any_here or here > read:
                    read, wanted, any_here = here, desired, True
        for j in range(len(points)):
            x, y = points[j, 0], points[j, 1]
            here = level(math.hypot(x, y), body, sensed_m - body)
            if here > 0.0 and (x != 0.0 or y != 0.0) and sensor(x, y) == k:
                found += 1
                if not any_here or here > read:
                    read, wanted, any_here = here, 0.0, True
        if any_here:
            f = push(read, wanted) / SENSORS
            px += f * math.cos(k * math.pi / 4.0)
            py += f * math.sin(k * math.pi / 4.0)
    return found, px, py


@compiled
def steered(x: float, y: float, speed_m_s: float) -> tuple[float, float]:
    """Turn towards (x, y) and the speed that goes with it; straight on at full speed if it has no length."""
    length = math.hypot(x, y)
    if length < NEGLIGIBLE:
        return 0.0, speed_m_s
    return math.atan2(y, x), speed_m_s * max(0.0, x / length)
