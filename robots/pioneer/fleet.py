"""All Pioneers in a world: velocity commands in, wheel servos, odometry and bumpers out.

A command is a speed and a turn rate, in whole mm/s and whole degrees/s, as ARIA sends them. The firmware ramps both
with an acceleration of its own and makes wheel speeds of them by the track that it is configured with; by the same
track it makes a heading of its wheels' angles. The two wheels of a side are told the same speed (on the machine a belt
joins them), and a side that lags behind its way catches up. The odometry counts wheels: slip is invisible to it. It is
not rounded: the machine's packets have 1 mm and 0.09 degrees.

The two bits of the contract are the left and right of the front bumper, since whoever reads them backs off and turns;
the rear bumper's are `rear_bumpers`. Sides have none: a touch there presses no switch, and is still noted as a touch.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from flocking.compilation import compiled
from flocking.errors import InputError
from flocking.types import Bools, Floats, Ints
from robots import planar, touching
from robots.create import bumpers, drive, odometry
from robots.pioneer import model as pioneer

_EACH = np.dtype(
    [
        ("root", np.int64),  # where its free joint stands in qpos
        ("wheels", np.int64, (4,)),  # where its wheels' angles stand in qpos: left front, left rear, right ones alike
        ("servos", np.int64, (4,)),  # where its wheels' speeds stand in ctrl
        ("target", np.float64, (2,)),  # speed and turn rate as commanded: m/s, rad/s
        ("setpoint", np.float64, (2,)),  # on their way to the target
        ("lag", np.float64, (2,)),  # rad that a side is behind its way: left, right, as all pairs below
        ("angle", np.float64, (2,)),  # rad, of a side's wheels after the last step, their mean
        ("pose", np.float64, (3,)),  # by odometry: m, m, rad
        ("distance", np.float64),  # m, by odometry since `own` was last asked
        ("turn", np.float64),  # rad, likewise
        ("elapsed", np.float64),  # s, likewise
        ("rates", np.float64, (2,)),  # speed and turn rate that `own` answered last: m/s, rad/s
        ("pressed", np.uint8, (4,)),  # 1 = pressed now: front left, front right, rear left, rear right
        ("latched", np.uint8, (2,)),  # 1 = that front one was pressed since `own` was last asked
        ("meant_way", np.float64, (2,)),  # m, rad by its set-points since `meant` was last asked
        ("meant_time", np.float64),  # s, likewise
        ("meant_pose", np.float64, (3,)),  # by its set-points, at that time: m, m, rad
        ("meant_rates", np.float64, (2,)),  # speed and turn rate that `meant` answered last: m/s, rad/s
    ]
)
"""One robot."""

_ALL = np.dtype(
    [
        *((name, np.float64) for name in drive.Gear._fields),
        ("timestep", np.float64),  # s
        ("ramp", np.float64),  # m/s that a set-point's speed changes in one step, at the most
        ("turn_ramp", np.float64),  # rad/s that its turn rate changes
        ("catch_up", np.float64),  # 1/s: a side is told this times its lag more
        ("most_lag", np.float64),  # rad
        ("hull_x", np.float64),  # m before the middle from where a touch presses the bumper
        ("overlap", np.float64),  # m of either bumper's switches over the middle
    ]
)
"""What all robots of a fleet share."""


class Fleet:
    """The Pioneers in a compiled model, in the order of their `prefixes`; k is an index into it.

    Around each step: `before_step(data)`, `mj_step`, `after_step(data)`. A fleet belongs to one run from time 0: after
    a reset of the data, make a new one.
    """

    def __init__(self, model: mujoco.MjModel, prefixes: Sequence[str]) -> None:
        count = len(prefixes)
        each, bodies, first = np.zeros(count, _EACH), np.zeros(count, np.int64), np.zeros(count, np.int64)
        for k, prefix in enumerate(prefixes):
            try:
                bodies[k] = model.body(f"{prefix}base").id
                each[k]["root"] = model.joint(f"{prefix}root").qposadr[0]
                for place, wheel in enumerate(pioneer.WHEELS):
                    each[k]["wheels"][place] = model.joint(f"{prefix}{wheel}").qposadr[0]
                    each[k]["servos"][place] = model.actuator(f"{prefix}{wheel}").id
            except KeyError as error:
                raise InputError(f"no Pioneer with prefix {prefix!r} in the model: {error.args[0]}") from None
            first[k] = model.joint(f"{prefix}root").dofadr[0]
        step = model.opt.timestep
        ramps = pioneer.ACCELERATION * step, pioneer.TURN_ACCELERATION * step
        self.root_bodies: Ints = bodies
        """(N,) body ids of the bases."""
        self._each: Any = each
        self._all: Any = np.array(
            [(*pioneer.GEAR, step, *ramps, pioneer.CATCH_UP, pioneer.MOST_LAG, pioneer.HULL_X, pioneer.BUMPER_OVERLAP)],
            dtype=_ALL,
        )
        self._hulls = touching.hulls_of(model, bodies)
        self._linear = first.reshape(-1, 1) + np.arange(2)
        self.pressing: Floats = np.zeros((count, 4))
        """(N, 4) N that press on the bumpers since the last step: front left and right, rear left and right."""
        self._pressed = False

    def command(self, k: int, speed: float, turn_rate: float) -> None:
        """Tell robot k to drive at `speed` (m/s) and `turn_rate` (rad/s): whole mm/s and degrees/s."""
        _command(self._each, self._all, k, speed, turn_rate)

    def before_step(self, data: mujoco.MjData) -> None:
        """Ramp the set-points towards the commands, and tell the wheels."""
        _ramped(self._each, self._all, data.ctrl)

    def after_step(self, data: mujoco.MjData) -> bool:
        """Read encoders and bumpers. Whether any hull is pressed."""
        contact = data.contact
        pairs = contact.geom
        near: bool = _counted(self._each, self._all, data.qpos, pairs, self._hulls)
        if not (near or self._pressed):
            return False
        self._pressed = _felt(
            self._each, self._all, self.root_bodies, self._hulls, pairs, contact.pos, contact.efc_address,
            data.efc_force, data.xpos, data.xmat, self.pressing,
        )  # fmt: skip
        return self._pressed

    def poses(self, data: mujoco.MjData) -> Floats:
        """(N, 3) true x, y (m) and heading (rad, in (−π, π]) of all robots, at `data.time`."""
        poses = np.empty((len(self._each), 3))
        planar.write_poses(self._each, data.qpos, poses)
        return poses

    def velocities(self, data: mujoco.MjData) -> Floats:
        """(N, 2) true velocity of all robots over ground in the world frame, m/s."""
        return data.qvel[self._linear]

    @property
    def odometry(self) -> Floats:
        """(N, 3) x, y (m), heading (rad, unwrapped) by each robot's odometry, in the frame of its start."""
        return self._each["pose"].copy()

    def own(self, k: int, motion: Floats, contacts: Bools) -> None:
        """Fills motion (3,), robot k's mean velocity over ground in its own axes (m/s) and its turn rate (rad/s) by
        odometry since this was last asked, and contacts (2,), left and right of its front bumper since then."""
        _own(self._each, k, motion, contacts)

    def meant(self, k: int, motion: Floats) -> None:
        """Fills motion (3,) as `own` does, by the set-points instead of the encoders."""
        _meant(self._each, k, motion)

    def meant_pose(self, k: int) -> Floats:
        """(3,) x, y, heading of robot k by its set-points when `meant` was last asked, in the frame of its start."""
        return self._each["meant_pose"][k].copy()

    def counted_pose(self, k: int) -> Floats:
        """(3,) x, y, heading of robot k by its odometry, in the frame of its start."""
        return self._each["pose"][k].copy()

    @property
    def bumpers(self) -> Bools:
        """(N, 2) left and right of the front bumper pressed now."""
        return self._each["pressed"][:, :2] > 0

    @property
    def rear_bumpers(self) -> Bools:
        """(N, 2) left and right of the rear bumper pressed now."""
        return self._each["pressed"][:, 2:] > 0


@compiled
def _command(each: Any, shared: Any, k: int, speed: float, turn_rate: float) -> None:
    if not (math.isfinite(speed) and math.isfinite(turn_rate)):
        raise ValueError("a drive command must be finite")
    speed, turn_rate = drive.saturated(shared[0], speed, turn_rate)
    each[k].target[0] = 0.001 * round(1000.0 * speed)
    each[k].target[1] = math.radians(float(round(math.degrees(turn_rate))))


@compiled
def _ramped(each: Any, shared: Any, ctrl: Floats) -> None:
    fleet = shared[0]
    for k in range(len(each)):
        robot = each[k]
        for part in range(2):
            most = fleet.ramp if part == 0 else fleet.turn_ramp
            change = robot.target[part] - robot.setpoint[part]
            robot.setpoint[part] += min(max(change, -most), most)
            robot.meant_way[part] += robot.setpoint[part] * fleet.timestep
        robot.meant_time += fleet.timestep
        left, right = drive.wheel_speeds(fleet, robot.setpoint[0], robot.setpoint[1])
        for side in range(2):
            rate = (left if side == 0 else right) / fleet.wheel_radius
            robot.lag[side] += rate * fleet.timestep
            for wheel in range(2):
                ctrl[robot.servos[2 * side + wheel]] = rate + fleet.catch_up * robot.lag[side]


@compiled
def _counted(each: Any, shared: Any, qpos: Floats, pairs: Ints, hulls: Ints) -> bool:
    """The encoders after a step. Whether any contact (C, 2) is one of a hull."""
    fleet = shared[0]
    for k in range(len(each)):
        robot = each[k]
        moved = np.empty(2)
        for side in range(2):
            angle = 0.5 * (qpos[robot.wheels[2 * side]] + qpos[robot.wheels[2 * side + 1]])
            moved[side] = angle - robot.angle[side]
            robot.angle[side] = angle
            lag = robot.lag[side] - moved[side]
            robot.lag[side] = min(max(lag, -fleet.most_lag), fleet.most_lag)
        distance, turn = drive.twist(fleet, fleet.wheel_radius * moved[0], fleet.wheel_radius * moved[1])
        odometry.move(robot.pose, distance, turn)
        robot.distance += distance
        robot.turn += turn
        robot.elapsed += fleet.timestep
    return touching.any_hull(pairs, hulls)


@compiled
def _own(each: Any, k: int, motion: Floats, contacts: Bools) -> None:
    robot = each[k]
    if robot.elapsed > 0.0:
        robot.rates[0], robot.rates[1] = robot.distance / robot.elapsed, robot.turn / robot.elapsed
        robot.distance, robot.turn, robot.elapsed = 0.0, 0.0, 0.0
    motion[0], motion[1], motion[2] = robot.rates[0], 0.0, robot.rates[1]
    for side in range(2):
        contacts[side] = robot.latched[side] > 0
        robot.latched[side] = 0


@compiled
def _meant(each: Any, k: int, motion: Floats) -> None:
    robot = each[k]
    if robot.meant_time > 0.0:
        distance, angle = robot.meant_way[0], robot.meant_way[1]
        odometry.move(robot.meant_pose, distance, angle)
        robot.meant_rates[0], robot.meant_rates[1] = distance / robot.meant_time, angle / robot.meant_time
        robot.meant_way[0], robot.meant_way[1], robot.meant_time = 0.0, 0.0, 0.0
    motion[0], motion[1], motion[2] = robot.meant_rates[0], 0.0, robot.meant_rates[1]


@compiled
def _felt(
    each: Any, shared: Any, roots: Ints, hulls: Ints, pairs: Ints, points: Floats, rows: Ints, efc_force: Floats,
    xpos: Floats, xmat: Floats, pressing: Floats,
) -> bool:  # fmt: skip
    """The bumpers, from the contacts that the step has found. Whether any hull is pressed.

    A contact before the front sphere's centre presses the front bumper, one behind the rear one's the rear bumper.
    """
    fleet = shared[0]
    pressing[:] = 0.0
    pressed = False
    for c in range(len(pairs)):
        for end in range(2):
            k = hulls[pairs[c, end]]
            if k == touching.UNOWNED:
                continue
            force = touching.normal_force(rows[c], efc_force)
            if force <= 0.0:
                continue
            pressed = True
            turn, away = xmat[roots[k]], points[c] - xpos[roots[k]]
            x = turn[0] * away[0] + turn[3] * away[1] + turn[6] * away[2]
            y = turn[1] * away[0] + turn[4] * away[1] + turn[7] * away[2]
            if abs(x) >= fleet.hull_x:
                first = 0 if x > 0.0 else 2
                if y >= -fleet.overlap:
                    pressing[k, first] += force
                if y <= fleet.overlap:
                    pressing[k, first + 1] += force
    for k in range(len(each)):
        robot = each[k]
        for switch in range(4):
            robot.pressed[switch] = 1 if pressing[k, switch] > bumpers.FORCE else 0
        for side in range(2):
            robot.latched[side] |= robot.pressed[side]
    return pressed
