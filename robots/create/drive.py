"""The Open Interface's drive command, and differential-drive kinematics beneath it.

A drive command (opcode 137) is a mean wheel speed, −500 to 500 mm/s, and a radius to the robot's centre,
−2000 to 2000 mm (positive: to the left), both whole; radius 0x8000 is straight, ±1 turns in place (then the
speed is that of each wheel). All that a Create is told goes through this: it can do no more than the real one.
"""

from __future__ import annotations

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
    """The twist (m/s, rad/s) that a drive command asks for, slowed where its outer wheel would pass the limit.

    What the machine does with such a command is not documented; that it keeps the radius is our choice.
    """
    velocity = 0.001 * velocity_mm_s
    if radius_mm in (STRAIGHT, ALSO_STRAIGHT):
        return velocity, 0.0
    if radius_mm in (IN_PLACE_LEFT, IN_PLACE_RIGHT):
        return 0.0, 2.0 * velocity * radius_mm / gear.axle_track
    if radius_mm == 0:
        return 0.0, 0.0
    return saturated(gear, velocity, velocity / (0.001 * radius_mm))


@compiled
def _misfit(gear: Gear, velocity_mm_s: int, radius_mm: int, speed: float, turn_rate: float) -> float:
    got_speed, got_turn_rate = meant(gear, velocity_mm_s, radius_mm)
    return abs(got_speed - speed) + 0.5 * gear.axle_track * abs(got_turn_rate - turn_rate)


@compiled
def nearest_command(gear: Gear, speed: float, turn_rate: float) -> tuple[int, int]:
    """The drive command (mm/s, mm) whose wheel speeds come nearest to those of a twist (m/s, rad/s).

    Straight, in place and the arc are compared: so a radius beyond 4 m is driven straight, one between 2 and 4 m
    with 2 m. Wheels too fast are slowed first, keeping the radius.
    """
    speed, turn_rate = saturated(gear, speed, turn_rate)
    velocity = round(1000.0 * speed)
    best_velocity, best_radius = velocity, STRAIGHT
    misfit = _misfit(gear, velocity, STRAIGHT, speed, turn_rate)
    spin = round(500.0 * gear.axle_track * abs(turn_rate))
    side = IN_PLACE_LEFT if turn_rate > 0.0 else IN_PLACE_RIGHT
    candidate = _misfit(gear, spin, side, speed, turn_rate)
    if candidate < misfit:
        best_velocity, best_radius, misfit = spin, side, candidate
    if velocity != 0 and turn_rate != 0.0:
        exact = velocity / turn_rate
        sign = 1 if exact > 0.0 else -1
        radius = sign * round(min(max(abs(exact), 2.0), float(MAX_RADIUS_MM)))
        candidate = _misfit(gear, velocity, radius, speed, turn_rate)
        if candidate < misfit:
            best_velocity, best_radius = velocity, radius
    return best_velocity, best_radius


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
