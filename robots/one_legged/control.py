"""Raibert's control of a hopping robot in three parts: hopping height, forward speed, attitude.

Source: Hodgins and Brogan 1994, section 4.1, which gives the parts and refers to Raibert 1986, "Legged robots that
balance", for the rest. Flight duration is set by how far the leg is extended in stance, speed by where the foot is put,
attitude by torques at the hip in stance. No gain is published: those of `Gains` are choices.

All functions are pure. Frames: b the robot's body (x forward, y left, z up along the trunk), w the world. The leg's
direction d points from the foot to the hip. Hinges turn about x, then y, then z.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from flocking.compilation import compiled
from flocking.errors import InputError

GRAVITY = 9.81
"""m/s²."""


class Gains(NamedTuple):
    """Of the control. All are choices; docs/one_legged.md tells what came of them."""

    spring: float = 16000.0
    """N/m, of the leg in stance."""
    spring_damping: float = 10.0
    """N s/m, likewise."""
    swing_spring: float = 1000.0
    """N/m, of the leg in flight, where it only carries itself."""
    swing_damping: float = 35.0
    """N s/m, likewise."""
    flight_s: float = 0.34
    """s, wanted from lift-off to touchdown."""
    trim: float = 0.1
    """How much of an error of the flight's duration, relative to that wanted, goes into the next thrust's energy."""
    draw: float = 0.05
    """m that the leg is drawn up in the first half of flight, so that the foot clears the ground."""
    placement: float = 0.10
    """s: metres that the foot is put further forward for each m/s too fast."""
    most_error: float = 0.5
    """m/s of error that count in it, at the most."""
    most_reach: float = 0.45
    """m from below the hip that the foot is put, at the most."""
    attitude: float = 200.0
    """N m/rad, of pitch and roll in stance."""
    attitude_damping: float = 50.0
    """N m s/rad, likewise."""
    grip: float = 0.6
    """Friction that pitch and roll may ask of the foot, as a share of the leg's force."""
    yaw: float = 60.0
    """N m/rad, of the heading in stance."""
    yaw_damping: float = 12.0
    """N m s/rad, likewise."""
    yaw_grip: float = 0.016
    """m: the turning moment that the heading may ask of the foot for each N of the leg's force; 0.8 of its friction."""
    swing: float = 60.0
    """N m/rad, of the hip's hinges about x and y in flight."""
    swing_rate: float = 6.0
    """N m s/rad, likewise."""
    twist: float = 0.3
    """N m/rad, of the hinge about the leg's own axis in flight, which brings the leg's twist back to zero."""
    twist_rate: float = 0.03
    """N m s/rad, likewise."""


def check_gains(gains: Gains, leg_m: float) -> None:
    """Raises `InputError` for gains that are no numbers, and for a foot put farther than the leg is long."""
    for name, value in gains._asdict().items():
        if not math.isfinite(value) or (name in ("spring", "swing_spring", "flight_s") and value <= 0.0):
            raise InputError(f"gain {name} = {value!r}: expected a finite number{' above 0' * math.isfinite(value)}")
    if gains.most_reach >= leg_m:
        raise InputError(f"gain most_reach = {gains.most_reach:g}: expected less than the leg's length, {leg_m:.3g} m")


@compiled
def thrust(mass: float, spring: float, flight_s: float, energy: float) -> float:
    """Hopping height: how far the leg's spring is to be compressed (m) at the bottom of stance.

    What it holds then lifts `mass` (kg) to where it is at rest, and gives it the speed v = g T / 2 with which it stays
    in the air for T = `flight_s`: k s²/2 = m g s + e m v²/2. `energy`: e, 1 where nothing is lost. `spring`: k, N/m.
    """
    weight, speed = mass * GRAVITY, 0.5 * GRAVITY * flight_s
    return (weight + math.sqrt(weight * weight + spring * mass * energy * speed * speed)) / spring


@compiled
def trimmed(energy: float, gain: float, flight_s: float, wanted_s: float) -> float:
    """The energy e of `thrust`, corrected by the duration of the flight that it gave; between a half and two."""
    return min(max(energy + gain * (wanted_s - flight_s) / wanted_s, 0.5), 2.0)


@compiled
def foot_place(
    vx: float, vy: float, wanted_x: float, wanted_y: float, stance_s: float, gain: float, most_error: float,
    reach: float,
) -> tuple[float, float]:  # fmt: skip
    """Forward speed: where the foot is to be at touchdown, from below the hip, m; in the axes of the velocities.

    The middle of the way that the body goes in a stance of `stance_s`, and further out by the error of the velocity (v
    less that wanted, m/s, limited to `most_error`) times `gain` (s). At most `reach` away.
    """
    error_x, error_y = vx - wanted_x, vy - wanted_y
    scale = min(1.0, most_error / max(math.hypot(error_x, error_y), 1e-12))
    x, y = 0.5 * vx * stance_s + gain * scale * error_x, 0.5 * vy * stance_s + gain * scale * error_y
    scale = min(1.0, reach / max(math.hypot(x, y), 1e-12))
    return scale * x, scale * y


@compiled
def leg_direction(hip_x: float, hip_y: float) -> tuple[float, float, float]:
    """d_b at these angles of the hip, rad."""
    return math.sin(hip_y), -math.sin(hip_x) * math.cos(hip_y), math.cos(hip_x) * math.cos(hip_y)


@compiled
def hip_angles(dx: float, dy: float, dz: float) -> tuple[float, float]:
    """The angles of hip_x and hip_y, rad, at which the leg has the direction d_b: `leg_direction` backwards."""
    return math.atan2(-dy, dz), math.asin(min(max(dx, -1.0), 1.0))


@compiled
def rotation(w: float, x: float, y: float, z: float) -> tuple[float, ...]:
    """The rotation (9,) of a unit quaternion, row by row: body axes to world axes."""
    return (
        1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y),
        2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x),
        2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y),
    )  # fmt: skip


@compiled
def to_body(turn: tuple[float, ...], x: float, y: float, z: float) -> tuple[float, float, float]:
    """A vector of the world in the axes of the body whose `rotation` that is."""
    return (
        turn[0] * x + turn[3] * y + turn[6] * z,
        turn[1] * x + turn[4] * y + turn[7] * z,
        turn[2] * x + turn[5] * y + turn[8] * z,
    )


@compiled
def to_world(turn: tuple[float, ...], x: float, y: float, z: float) -> tuple[float, float, float]:
    """A vector in the axes of the body whose `rotation` that is, in the world's."""
    return (
        turn[0] * x + turn[1] * y + turn[2] * z,
        turn[3] * x + turn[4] * y + turn[5] * z,
        turn[6] * x + turn[7] * y + turn[8] * z,
    )


@compiled
def upright_torque(
    turn: tuple[float, ...], rate_x: float, rate_y: float, gain: float, damping: float, most: float
) -> tuple[float, float]:  # fmt: skip
    """Attitude: the torque on the body about its x and y axes, N m, that turns its z axis upright.

    turn: its `rotation`; rate_x, rate_y: how fast it turns about these axes, rad/s; most: N m.
    """
    x, y = -gain * turn[7] - damping * rate_x, gain * turn[6] - damping * rate_y
    scale = min(1.0, most / max(math.hypot(x, y), 1e-12))
    return scale * x, scale * y


@compiled
def yaw_torque(error: float, rate: float, gain: float, damping: float, most: float) -> float:
    """Attitude: the torque on the body about its z axis, N m, for an error (wanted less real) of the heading, rad."""
    return min(max(gain * error - damping * rate, -most), most)


@compiled
def hip_torques(hip_x: float, hip_y: float, x: float, y: float, z: float) -> tuple[float, float, float]:
    """The torques of the three hinges, N m, that put the torque (x, y, z) on the body, in its axes.

    Each is the component about the hinge's axis of what the leg gets: the opposite torque.
    """
    dx, dy, dz = leg_direction(hip_x, hip_y)
    return -x, -(y * math.cos(hip_x) + z * math.sin(hip_x)), -(x * dx + y * dy + z * dz)


@compiled
def spring_force(short: float, rate: float, spring: float, damping: float) -> float:
    """The force along the leg, N, positive where it pushes: `short` m shorter than wanted, longer by `rate` m/s."""
    return spring * short - damping * rate
