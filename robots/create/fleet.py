"""All Creates of one world: commands in, wheel servos, odometry and bumpers out; one compiled call a step."""

from __future__ import annotations

import math
from collections.abc import Sequence

import mujoco
import numpy as np

from flocking.compilation import compiled
from flocking.errors import InputError
from flocking.types import Bools, Floats, Ints
from robots.create import drive, odometry
from robots.create import model as create

BUMPER_FORCE = 0.5
"""N that press a bumper's switch; ?"""

# Columns of a robot's row in the state (wheels left, right; rad and rad/s)
_TARGET, _SETPOINT, _ANGLE, _POLLED = 0, 2, 4, 6
_POSE = 8  # x, y, heading by odometry
_SINCE = 11  # distance, angle, requests since the velocity was last asked for
_PRESSED, _LATCHED = 14, 16  # bumpers left, right
_MEANT = 18  # way of either wheel by its set-points (rad) since `meant` was last asked, and the step at that time
_MEANT_POSE = 21  # x, y, heading by the set-points
_MEANT_RATES = 24  # mean speed and turn rate by the set-points when last asked
_COLUMNS = 26
# Columns of a robot's row in the addresses
_ROOT, _WHEELS, _SERVOS, _BUMPERS = 0, 1, 3, 5


class Fleet:
    """The Creates of a compiled model, in the order of their `prefixes`; k is an index into it.

    Around each step: `before_step(data)`, `mj_step`, `after_step(data)`. A fleet belongs to one run from time 0: after
    a reset of the data, make a new one.
    """

    def __init__(self, model: mujoco.MjModel, prefixes: Sequence[str], polling_s: float = odometry.POLLING) -> None:
        addresses = np.zeros((len(prefixes), 7), dtype=np.int64)
        bodies = np.zeros(len(prefixes), dtype=np.int64)
        for k, prefix in enumerate(prefixes):
            try:
                bodies[k] = model.body(f"{prefix}base").id
                addresses[k] = (
                    model.joint(f"{prefix}root").qposadr[0],
                    model.joint(f"{prefix}left").qposadr[0],
                    model.joint(f"{prefix}right").qposadr[0],
                    model.actuator(f"{prefix}left").id,
                    model.actuator(f"{prefix}right").id,
                    model.sensor(f"{prefix}bumper_left").adr[0],
                    model.sensor(f"{prefix}bumper_right").adr[0],
                )
            except KeyError as error:
                raise InputError(f"no Create with prefix {prefix!r} in the model: {error.args[0]}") from None
        if not polling_s > 0.0:
            raise InputError(f"polling_s = {polling_s!r}: expected a time above 0 s")
        self.root_bodies: Ints = bodies
        """(N,) body ids of the bases."""
        self._addresses = addresses
        first = np.array([model.joint(f"{prefix}root").dofadr[0] for prefix in prefixes], dtype=np.int64)
        self._linear = first.reshape(-1, 1) + np.arange(2)
        self._state = np.zeros((len(prefixes), _COLUMNS))
        self._clock = np.array([polling_s, 0.0, model.opt.timestep, 0.0])  # period, requests made, timestep, steps
        self._ramp = create.MAX_WHEEL_ACCELERATION / create.WHEEL_RADIUS * model.opt.timestep
        self._last_velocity = np.zeros((len(prefixes), 2))
        self._start(model.qpos0)

    def _start(self, qpos: Floats) -> None:
        for side in range(2):
            angles = qpos[self._addresses[:, _WHEELS + side]]
            self._state[:, _ANGLE + side] = self._state[:, _POLLED + side] = angles

    def command(self, k: int, speed: float, turn_rate: float) -> None:
        """Tell robot k to drive at `speed` (m/s) and `turn_rate` (rad/s), as far as its drive command can say."""
        _command(self._state, k, speed, turn_rate)

    def stop(self, k: int) -> None:
        """Tell robot k to stand still (it brakes with its wheels' acceleration limit)."""
        _command(self._state, k, 0.0, 0.0)

    def before_step(self, data: mujoco.MjData) -> None:
        """Ramp the wheels' set-points towards the commands."""
        _ramped(self._state, self._addresses, self._ramp, self._clock, data.ctrl)

    def after_step(self, data: mujoco.MjData) -> None:
        """Poll encoders and bumpers."""
        _polled(self._state, self._addresses, self._clock, data.time, data.qpos, data.sensordata)

    def poses(self, data: mujoco.MjData) -> Floats:
        """(N, 3) true x, y (m) and heading (rad, in (−π, π]) of all robots, at `data.time`."""
        poses = np.empty((len(self._addresses), 3))
        _poses(self._addresses, data.qpos, poses)
        return poses

    def velocities(self, data: mujoco.MjData) -> Floats:
        """(N, 2) true velocity of all robots over ground in the world frame, m/s."""
        return data.qvel[self._linear]

    @property
    def odometry(self) -> Floats:
        """(N, 3) x, y (m), heading (rad, unwrapped) by each robot's odometry, in the frame of its start."""
        return self._state[:, _POSE : _POSE + 3].copy()

    def velocity(self, k: int) -> tuple[float, float]:
        """Mean speed (m/s) and turn rate (rad/s) by odometry since this was last asked for robot k.

        The answer before, where no request was made in between. Contacts stay latched.
        """
        motion, latched = np.empty(3), self._state[k, _LATCHED : _LATCHED + 2].copy()
        self.own(k, motion, np.empty(2, dtype=np.bool_))
        self._state[k, _LATCHED : _LATCHED + 2] = latched
        return float(motion[0]), float(motion[2])

    def own(self, k: int, motion: Floats, contacts: Bools) -> None:
        """`velocity` and `take_contacts` of robot k in one call: fills motion (3,), its velocity over ground in its
        own axes (m/s) and its turn rate (rad/s), and contacts (2,)."""
        _own(self._state, k, self._clock[0], self._last_velocity, motion, contacts)

    def meant(self, k: int, motion: Floats) -> None:
        """Fills motion (3,) as `own` does, by the wheels' set-points instead of the encoders.

        The set-points are the drive commands and the wheels' acceleration limit: what a robot knows without measuring.
        """
        _meant(self._state, k, self._clock, motion)

    def meant_pose(self, k: int) -> Floats:
        """(3,) x, y, heading of robot k by its set-points when `meant` was last asked, in the frame of its start."""
        return self._state[k, _MEANT_POSE : _MEANT_POSE + 3].copy()

    def counted_pose(self, k: int) -> Floats:
        """(3,) x, y, heading of robot k by its odometry, in the frame of its start."""
        return self._state[k, _POSE : _POSE + 3].copy()

    @property
    def bumpers(self) -> Bools:
        """(N, 2) left and right bumper pressed now."""
        return self._state[:, _PRESSED : _PRESSED + 2] > 0.0

    def take_contacts(self, k: int) -> Bools:
        """(2,) left and right bumper of robot k pressed at any step since this was last asked."""
        latched = self._state[k, _LATCHED : _LATCHED + 2] > 0.0
        self._state[k, _LATCHED : _LATCHED + 2] = 0.0
        return latched


@compiled
def _own(state: Floats, k: int, period: float, last: Floats, motion: Floats, contacts: Bools) -> None:
    row = state[k]
    elapsed = row[_SINCE + 2] * period
    if elapsed > 0.0:
        last[k, 0], last[k, 1] = row[_SINCE] / elapsed, row[_SINCE + 1] / elapsed
        row[_SINCE], row[_SINCE + 1], row[_SINCE + 2] = 0.0, 0.0, 0.0
    motion[0], motion[1], motion[2] = last[k, 0], 0.0, last[k, 1]
    for side in range(2):
        contacts[side] = row[_LATCHED + side] > 0.0
        row[_LATCHED + side] = 0.0


@compiled
def _meant(state: Floats, k: int, clock: Floats, motion: Floats) -> None:
    row = state[k]
    steps = clock[3] - row[_MEANT + 2]
    if steps > 0.0:
        left, right = create.WHEEL_RADIUS * row[_MEANT], create.WHEEL_RADIUS * row[_MEANT + 1]
        distance, angle = drive.twist(left, right)
        x, y, heading = odometry.moved(row[_MEANT_POSE], row[_MEANT_POSE + 1], row[_MEANT_POSE + 2], distance, angle)
        row[_MEANT_POSE], row[_MEANT_POSE + 1], row[_MEANT_POSE + 2] = x, y, heading
        row[_MEANT], row[_MEANT + 1], row[_MEANT + 2] = 0.0, 0.0, clock[3]
        row[_MEANT_RATES] = distance / (steps * clock[2])
        row[_MEANT_RATES + 1] = angle / (steps * clock[2])
    motion[0], motion[1], motion[2] = row[_MEANT_RATES], 0.0, row[_MEANT_RATES + 1]


@compiled
def _command(state: Floats, k: int, speed: float, turn_rate: float) -> None:
    if not (math.isfinite(speed) and math.isfinite(turn_rate)):
        raise ValueError("a drive command must be finite")
    velocity_mm_s, radius_mm = drive.nearest_command(speed, turn_rate)
    left, right = drive.wheel_speeds(*drive.meant(velocity_mm_s, radius_mm))
    state[k, _TARGET] = left / create.WHEEL_RADIUS
    state[k, _TARGET + 1] = right / create.WHEEL_RADIUS


@compiled
def _ramped(state: Floats, addresses: Ints, ramp: float, clock: Floats, ctrl: Floats) -> None:
    timestep = clock[2]
    clock[3] += 1.0
    for k in range(len(state)):
        for side in range(2):
            setpoint = state[k, _SETPOINT + side]
            change = state[k, _TARGET + side] - setpoint
            setpoint += min(max(change, -ramp), ramp)
            state[k, _SETPOINT + side] = setpoint
            state[k, _MEANT + side] += setpoint * timestep
            ctrl[addresses[k, _SERVOS + side]] = setpoint


@compiled
def _polled(state: Floats, addresses: Ints, clock: Floats, time: float, qpos: Floats, sensordata: Floats) -> None:
    period, timestep = clock[0], clock[2]
    due = clock[1]
    while (due + 1.0) * period <= time + 1e-9:
        due += 1.0
    for k in range(len(state)):
        row = state[k]
        left, right = qpos[addresses[k, _WHEELS]], qpos[addresses[k, _WHEELS + 1]]
        for request in range(int(clock[1]) + 1, int(due) + 1):
            back = min(max((time - request * period) / timestep, 0.0), 1.0)
            left_then = left + back * (row[_ANGLE] - left)
            right_then = right + back * (row[_ANGLE + 1] - right)
            distance_mm, angle_deg = odometry.request(left_then - row[_POLLED], right_then - row[_POLLED + 1])
            row[_POLLED], row[_POLLED + 1] = left_then, right_then
            distance, angle = 0.001 * distance_mm, math.radians(angle_deg)
            x, y, heading = odometry.moved(row[_POSE], row[_POSE + 1], row[_POSE + 2], distance, angle)
            row[_POSE], row[_POSE + 1], row[_POSE + 2] = x, y, heading
            row[_SINCE] += distance
            row[_SINCE + 1] += angle
            row[_SINCE + 2] += 1.0
        row[_ANGLE], row[_ANGLE + 1] = left, right
        for side in range(2):
            pressed = sensordata[addresses[k, _BUMPERS + side]] > BUMPER_FORCE
            row[_PRESSED + side] = 1.0 if pressed else 0.0
            if pressed:
                row[_LATCHED + side] = 1.0
    clock[1] = due


@compiled
def _poses(addresses: Ints, qpos: Floats, poses: Floats) -> None:
    for k in range(len(addresses)):
        at = addresses[k, _ROOT]
        w, x, y, z = qpos[at + 3], qpos[at + 4], qpos[at + 5], qpos[at + 6]
        poses[k, 0], poses[k, 1] = qpos[at], qpos[at + 1]
        poses[k, 2] = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
