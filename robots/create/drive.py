"""The Open Interface's drive command, and differential-drive kinematics beneath it.

A drive command (opcode 137) is a mean wheel speed, −500 to 500 mm/s, and a radius to the robot's centre,
−2000 to 2000 mm (positive: to the left), both whole; radius 0x8000 is straight, ±1 turns in place (then the
speed is that of each wheel). All that a Create is told goes through this: it can do no more than the real one.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from flocking.compilation import compiled
from flocking.errors import InputError

DRIVE_OPCODE = 137  # P: Open Interface
MAX_VELOCITY_MM_S = 500  # P: Open Interface, drive command
MAX_RADIUS_MM = 2000  # P: Open Interface, drive command
STRAIGHT = -0x8000  # P: 0x8000 as a signed 16-bit number
ALSO_STRAIGHT = 0x7FFF  # P: the manual's other code for straight
IN_PLACE_LEFT, IN_PLACE_RIGHT = 1, -1  # P: counter-clockwise, clockwise


class Gear(NamedTuple):
    """What drives a robot of this kind. Compiled code takes it, or the record that `recorded` makes of it."""

    axle_track: float
    """m between the wheels' contact points."""
    wheel_radius: float
    """m."""
    top_speed: float
    """m/s of each wheel's rim."""
    wheel_acceleration: float
    """m/s² of each wheel's rim at the most."""


GEAR_DTYPE = np.dtype([(name, np.float64) for name in Gear._fields])


def recorded(gear: Gear) -> Any:
    """(1,) `gear` as an array of one record, which costs a compiled call from Python 0.1 µs, a named tuple 1.5 µs."""
    return np.array([tuple(gear)], dtype=GEAR_DTYPE)


@compiled
def wheel_speeds(gear: Gear, speed: float, turn_rate: float) -> tuple[float, float]:
    """Left and right rim speed, m/s, of a body twist (m/s, rad/s)."""
    half = 0.5 * gear.axle_track * turn_rate
    return speed - half, speed + half


@compiled
def twist(gear: Gear, left: float, right: float) -> tuple[float, float]:
    """Body twist (m/s, rad/s) of left and right rim speeds, m/s."""
    return 0.5 * (left + right), (right - left) / gear.axle_track


@compiled
def saturated(gear: Gear, speed: float, turn_rate: float) -> tuple[float, float]:
    """The twist slowed down until no wheel is faster than the top speed; the radius stays."""
    fastest = abs(speed) + 0.5 * gear.axle_track * abs(turn_rate)
    if fastest <= gear.top_speed:
        return speed, turn_rate
    scale = gear.top_speed / fastest
    return speed * scale, turn_rate * scale


@compiled
def meant(gear: Gear, velocity_mm_s: int, radius_mm: int) -> tuple[float, float]:
    """The twist (m/s, rad/s) that a drive command asks for, slowed where a wheel would pass the limit (`saturated`).

    500 mm/s on a radius of 200 mm would need 0.82 m/s of the Create's outer wheel: it is driven at 0.304 m/s on the
    same radius, the outer wheel at its limit of 0.5 m/s. The Open Interface's manual says no more than that "internal
    and environmental restrictions may prevent Create from accurately carrying out some drive commands"; that the radius
    stays is our choice.
    """
    velocity = 0.001 * velocity_mm_s
    if radius_mm in (STRAIGHT, ALSO_STRAIGHT):
        return saturated(gear, velocity, 0.0)
    if radius_mm in (IN_PLACE_LEFT, IN_PLACE_RIGHT):
        return saturated(gear, 0.0, 2.0 * velocity * radius_mm / gear.axle_track)
    if radius_mm == 0:
        return 0.0, 0.0
    return saturated(gear, velocity, velocity / (0.001 * radius_mm))


@compiled
def _misfit(gear: Gear, velocity_mm_s: int, radius_mm: int, speed: float, turn_rate: float) -> float:
    """By how much the wheel that is farther off misses its speed, m/s."""
    got_speed, got_turn_rate = meant(gear, velocity_mm_s, radius_mm)
    return abs(got_speed - speed) + 0.5 * gear.axle_track * abs(got_turn_rate - turn_rate)


@compiled
def nearest_command(gear: Gear, speed: float, turn_rate: float) -> tuple[int, int]:
    """The drive command (mm/s, mm) whose wheel speeds come nearest to those of a twist (m/s, rad/s).

    Nearest of all commands, in both numbers together: the greater miss of the two wheels is the least. So a radius
    beyond 4 m is driven straight, one between 2 and 4 m with 2 m; and where whole millimetres of radius are coarse, the
    speed gives way (0.0152 m/s at 2.003 rad/s, a radius of 7.6 mm, becomes 16 mm/s on 8 mm). A twist beyond the wheels'
    limit is slowed first, keeping its radius, as `meant` slows a command.
    """
    speed, turn_rate = saturated(gear, speed, turn_rate)
    middle = round(1000.0 * speed)
    best_velocity, best_radius = middle, STRAIGHT
    misfit = _misfit(gear, middle, STRAIGHT, speed, turn_rate)
    if turn_rate == 0.0:
        return best_velocity, best_radius
    spin = round(500.0 * gear.axle_track * abs(turn_rate))
    side = IN_PLACE_LEFT if turn_rate > 0.0 else IN_PLACE_RIGHT
    candidate = _misfit(gear, spin, side, speed, turn_rate)
    if candidate < misfit:
        best_velocity, best_radius, misfit = spin, side, candidate
    # Arcs, from the nearest velocity outwards: one that is d off misses by d at the least, whatever its radius.
    off = 0
    while 0.001 * (off - 0.5) < misfit:
        for velocity in (middle - off, middle + off):
            if velocity == 0 or abs(velocity) > MAX_VELOCITY_MM_S:
                continue
            exact = velocity / turn_rate
            for size in (float(math.floor(abs(exact))), float(math.ceil(abs(exact))), _tightest(gear, velocity)):
                radius = _arc(exact, size)
                candidate = _misfit(gear, velocity, radius, speed, turn_rate)
                if candidate < misfit:
                    best_velocity, best_radius, misfit = velocity, radius, candidate
        off += 1
    # Arcs with the outer wheel at its limit, where any greater velocity means the same: the inner wheel decides.
    half = 0.5 * gear.axle_track
    inner = abs(speed) - half * abs(turn_rate)
    exact = 1000.0 * half * (gear.top_speed + inner) / (gear.top_speed - inner)
    for size in (float(math.floor(exact)), float(math.ceil(exact))):
        radius = _arc(speed * turn_rate, size)
        velocity = math.ceil(1000.0 * gear.top_speed / (1.0 + half / (0.001 * abs(radius))))
        velocity = min(velocity, MAX_VELOCITY_MM_S) if speed > 0.0 else -min(velocity, MAX_VELOCITY_MM_S)
        candidate = _misfit(gear, velocity, radius, speed, turn_rate)
        if candidate < misfit:
            best_velocity, best_radius, misfit = velocity, radius, candidate
    return best_velocity, best_radius


@compiled
def _arc(signed: float, size: float) -> int:
    """The radius of an arc (mm), of that size as far as a command can say it, and of the sign of `signed`."""
    radius = int(min(max(size, 2.0), float(MAX_RADIUS_MM)))
    return radius if signed > 0.0 else -radius


@compiled
def _tightest(gear: Gear, velocity_mm_s: int) -> float:
    """The smallest radius (mm) that a velocity can be driven on without being slowed; inf = none."""
    velocity = 0.001 * abs(velocity_mm_s)
    if velocity >= gear.top_speed:
        return math.inf
    return float(math.ceil(500.0 * gear.axle_track * velocity / (gear.top_speed - velocity)))


def encode(velocity_mm_s: int, radius_mm: int) -> bytes:
    """The five bytes of a drive command.

    Raises
    ------
    InputError
        Where a number is outside what the Open Interface takes.
    """
    if not -MAX_VELOCITY_MM_S <= velocity_mm_s <= MAX_VELOCITY_MM_S:
        raise InputError(f"drive velocity {velocity_mm_s} mm/s: expected −{MAX_VELOCITY_MM_S} to {MAX_VELOCITY_MM_S}")
    if not -MAX_RADIUS_MM <= radius_mm <= MAX_RADIUS_MM and radius_mm not in (
        STRAIGHT,
        0x8000,
        ALSO_STRAIGHT,
    ):
        raise InputError(f"drive radius {radius_mm} mm: expected −{MAX_RADIUS_MM} to {MAX_RADIUS_MM} or 0x8000")
    radius = radius_mm & 0xFFFF
    return bytes([DRIVE_OPCODE]) + (velocity_mm_s & 0xFFFF).to_bytes(2, "big") + radius.to_bytes(2, "big")


def decode(command: bytes) -> tuple[int, int]:
    """Velocity (mm/s) and radius (mm; 0x8000 as `STRAIGHT`) of the five bytes of a drive command."""
    if len(command) != 5 or command[0] != DRIVE_OPCODE:
        raise InputError(f"{command.hex(' ')}: expected {DRIVE_OPCODE} and four bytes")
    velocity = int.from_bytes(command[1:3], "big", signed=True)
    radius = int.from_bytes(command[3:5], "big", signed=True)
    encode(velocity, radius)
    return velocity, radius
