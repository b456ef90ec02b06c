"""Self-organised flocking of Kobots: heading alignment and proximal control over eight sensors.

Source: Turgut, Çelikkanat, Gökçe and Şahin 2008, "Self-organized flocking in mobile robot swarms"; Fine 2015, table
A.1. Metres and seconds; distances are between centres.

The desired heading is that of h + beta p. h is the unit vector along the sum of the neighbours' noisy headings, within
radio range. p = 1/8 sum over the sensors k of f_k, along the sensor's direction k pi/4. A sensor reads the nearest
thing in its eighth of the circle as a level o from 0 (nothing) to 7 (touching), and f = -(o - o_des)²/C above the
desired level and +(o - o_des)²/C below, with o_des = 3 for robots and 0 for obstacles; C makes f -1 at level 7. The
speed is u_max times the cosine of the turn to the desired heading, and 0 for more than a right angle.

Needs positions, headings and obstacles. Nobody heard: the own heading takes the place of h, so that a member alone
moves straight on at full speed.
The noise turns all headings of one call alike, as an error of the member's own compass does, and so does not average
out over the neighbours (`FILLED`).
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.compilation import compiled
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import mean_direction, normal, rotated, unit
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

SOURCE = "Turgut et al. 2008"
SENSORS = 8
TOUCHING = 7.0
TOO_SHORT = 1e-12

NEEDS = frozenset({"positions", "headings", "obstacles"})
RULES = ("alone", "align", "proximal", "align and proximal")
SETS = {"heard": "distance-based(0, range_m)", "sensed": "distance-based(0, sensed_m)"}
RELATIONS = ("touching_m below sensed_m",)
DRAWS = 1
TAXONOMY = Taxonomy("homogeneous", "constrained", "discrete", "all", False, True, True, False)
VALIDATION = Validation("SP", False, "global", "-", "local", "bounded free")
FILLED = (
    Filled(
        "member detection",
        "table 3.2 lists velocity and no orientation, although the formula reads headings",
        "the row is given as printed; the law reads headings and no velocities",
    ),
    Filled(
        "sensing",
        "table A.1 writes distances in place of the infrared sensors' levels, without changing the signs",
        "levels as in the original, falling linearly from touching to the sensors' range",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "table A.1 leaves the sum of headings without its length, and prints sensor angles of 4k/pi",
        "the unit vector along the sum, and k pi/4, as in the original",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "the noise's mean in table A.1 is a sum of headings",
        "a vector of length noise at a normal angle to the heading heard, added to it, as in the original",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "each heading that is heard has a noise of its own, as far as is known; the formula in table A.1 is garbled",
        "one draw turns all alike, since a law's draws have a fixed number: noise does not average over the neighbours",
    ),
    Filled(
        "motion computation",
        "what h is for a member that hears nobody",
        "its own heading, without noise",
    ),
    Filled(
        "physical motion",
        "the robot turns at a rate in proportion to the turn that is left",
        "the desired heading is handed on; how fast a body turns is its own affair",
    ),
)
HERD = Herd(spacing_m=0.3, speed_m_s=0.07, dt_s=0.1)
CREATE = {"range_m": 5.6, "sensed_m": 1.4, "touching_m": 0.35, "speed_m_s": 0.25}


class Parameters(NamedTuple):
    """Of Kobots that align and keep their distance."""

    range_m: Annotated[float, Parameter("m", "our choice: of the radio that tells headings", low=0.0)] = 20.0
    sensed_m: Annotated[float, Parameter("m", "our choice: infrared sensors that reach 0.2 m", low=0.0)] = 0.32
    touching_m: Annotated[float, Parameter("m", "our choice: a Kobot's diameter", low=0.0)] = 0.12
    desired_level: Annotated[float, Parameter("", "our choice: o_des for robots", low=0.0, high=6.9)] = 3.0
    proximal_weight: Annotated[float, Parameter("", "our choice: beta", low=0.0)] = 4.0
    noise: Annotated[float, Parameter("", "our choice: length of the noise vector", low=0.0)] = 0.0
    noise_rad: Annotated[
        float, Parameter("rad", "our choice: standard deviation of the noise vector's angle", low=0.0)
    ] = math.pi / 2.0
    speed_m_s: Annotated[float, Parameter("m/s", "our choice: u_max", low=0.0)] = 0.07


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
    if math.hypot(x, y) < TOO_SHORT:
        return found, 0.0, 0.0
    ux, uy = unit(x, y)
    return found, ux, uy


@compiled
def proximal(
    positions: Floats, sensed: Bools, points: Floats, touching_m: float, sensed_m: float, desired: float
) -> tuple[int, float, float]:
    """How many things are sensed, and p: the mean push over all sensors."""
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
    if length < TOO_SHORT:
        return 0.0, speed_m_s
    return math.atan2(y, x), speed_m_s * max(0.0, x / length)


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: alignment and proximal control; the speed falls with the turn."""
    heard, hx, hy = alignment(members.headings, sets[0])
    if heard > 0:
        angle = parameters.noise_rad * normal(u[0])
        error = math.atan2(parameters.noise * math.sin(angle), 1.0 + parameters.noise * math.cos(angle))
        hx, hy = rotated(hx, hy, error)
    sensed, px, py = proximal(
        members.positions,
        sets[1],
        obstacles.points,
        parameters.touching_m,
        parameters.sensed_m,
        parameters.desired_level,
    )
    weight = parameters.proximal_weight
    bearing, speed = steered(hx + weight * px, hy + weight * py, parameters.speed_m_s)
    rule = (1 if heard > 0 else 0) + (2 if sensed > 0 else 0)
    return Motion(Kind.HEADING, bearing, speed, rule)
