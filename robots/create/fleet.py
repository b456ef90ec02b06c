"""All Creates of one size in a world: commands in, wheel servos, odometry and bumpers out."""

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
from robots.create.model import DIMENSIONS, Dimensions

_EACH = np.dtype(
    [
        ("root", np.int64),  # where its free joint stands in qpos
        ("wheels", np.int64, (2,)),  # where its wheels' angles stand in qpos: left, right, as all pairs below
        ("servos", np.int64, (2,)),  # where its wheels' speeds stand in ctrl
        ("target", np.float64, (2,)),  # rad/s, as commanded
        ("setpoint", np.float64, (2,)),  # rad/s, on its way to the target
        ("angle", np.float64, (2,)),  # rad, of its wheels after the last step
        ("polled", np.float64, (2,)),  # rad, of its wheels at the last request
        ("pose", np.float64, (3,)),  # by odometry: m, m, rad
        ("distance", np.float64),  # m, by odometry since `own` was last asked
        ("turn", np.float64),  # rad, likewise
        ("requests", np.float64),  # to the encoders, likewise
        ("rates", np.float64, (2,)),  # speed and turn rate that `own` answered last: m/s, rad/s
        ("pressed", np.uint8, (2,)),  # 1 = that bumper is pressed now
        ("latched", np.uint8, (2,)),  # 1 = it was pressed since `own` was last asked
        ("meant_way", np.float64, (2,)),  # rad, of its set-points since `meant` was last asked
        ("meant_step", np.float64),  # the step at that time
        ("meant_pose", np.float64, (3,)),  # by its set-points, at that time: m, m, rad
        ("meant_rates", np.float64, (2,)),  # speed and turn rate that `meant` answered last: m/s, rad/s
    ]
)
"""One robot. A record costs a call 0.15 µs more than a plain array: a hundredth of a step of six robots at the most."""

_ALL = np.dtype(
    [
        *((name, np.float64) for name in drive.Gear._fields),
        ("period", np.float64),  # s between requests to the encoders
        ("requests", np.float64),  # made until now
        ("timestep", np.float64),  # s
        ("steps", np.float64),  # begun until now
        ("ramp", np.float64),  # rad/s that a set-point changes in one step, at the most
    ]
)
"""What all robots of a fleet share: its `Gear`, and the clock of the requests."""


class Fleet:
    """The Creates of one size in a compiled model, in the order of their `prefixes`; k is an index into it.

    Around each step: `before_step(data)`, `mj_step`, `after_step(data)`. A fleet belongs to one run from time 0: after
    a reset of the data, make a new one.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        prefixes: Sequence[str],
        polling_s: float = odometry.POLLING,
        dimensions: Dimensions = DIMENSIONS,
    ) -> None:
        if not polling_s > 0.0:
            raise InputError(f"polling_s = {polling_s!r}: expected a time above 0 s")
        count = len(prefixes)
        each, bodies, first = np.zeros(count, _EACH), np.zeros(count, np.int64), np.zeros(count, np.int64)
        for k, prefix in enumerate(prefixes):
            try:
                bodies[k] = model.body(f"{prefix}base").id
                each[k]["root"] = model.joint(f"{prefix}root").qposadr[0]
                for side, wheel in enumerate(("left", "right")):
                    each[k]["wheels"][side] = model.joint(f"{prefix}{wheel}").qposadr[0]
                    each[k]["servos"][side] = model.actuator(f"{prefix}{wheel}").id
            except KeyError as error:
                raise InputError(f"no Create with prefix {prefix!r} in the model: {error.args[0]}") from None
            first[k] = model.joint(f"{prefix}root").dofadr[0]
        each["angle"] = each["polled"] = model.qpos0[each["wheels"]]
        gear, timestep = dimensions.gear, model.opt.timestep
        ramp = gear.wheel_acceleration / gear.wheel_radius * timestep
        self.root_bodies: Ints = bodies
        """(N,) body ids of the bases."""
        self._each: Any = each
        self._all: Any = np.array([(*gear, polling_s, 0.0, timestep, 0.0, ramp)], dtype=_ALL)
        self._ring = bumpers.recorded(dimensions.ring)
        self._hulls = touching.hulls_of(model, bodies)
        self._linear = first.reshape(-1, 1) + np.arange(2)
        self.pressing: Floats = np.zeros((count, 2))
        """(N, 2) N that press on the left and the right bumper since the last step."""
        self._pressed = False

    def command(self, k: int, speed: float, turn_rate: float) -> None:
        """Tell robot k to drive at `speed` (m/s) and `turn_rate` (rad/s), as far as its drive command can say."""
        _command(self._each, self._all, k, speed, turn_rate)

    def stop(self, k: int) -> None:
        """Tell robot k to stand still (it brakes with its wheels' acceleration limit)."""
        self.command(k, 0.0, 0.0)

    def before_step(self, data: mujoco.MjData) -> None:
        """Ramp the wheels' set-points towards the commands."""
        _ramped(self._each, self._all, data.ctrl)

    def after_step(self, data: mujoco.MjData) -> bool:
        """Poll encoders and bumpers. Whether any hull is pressed."""
        contact = data.contact
        pairs = contact.geom
        near: bool = _polled(self._each, self._all, data.time, data.qpos, pairs, self._hulls)
        if not (near or self._pressed):
            return False
        self._pressed = _felt(
            self._each, self._ring, self.root_bodies, self._hulls, pairs, contact.pos, contact.efc_address,
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

    def velocity(self, k: int) -> tuple[float, float]:
        """Mean speed (m/s) and turn rate (rad/s) by odometry since this was last asked for robot k.

        The answer before, where no request was made in between. Contacts stay latched.
        """
        motion, latched = np.empty(3), self._each[k]["latched"].copy()
        self.own(k, motion, np.empty(2, dtype=np.bool_))
        self._each[k]["latched"] = latched
        return float(motion[0]), float(motion[2])

    def own(self, k: int, motion: Floats, contacts: Bools) -> None:
        """`velocity` and `take_contacts` of robot k in one call: fills motion (3,), its velocity over ground in its
        own axes (m/s) and its turn rate (rad/s), and contacts (2,)."""
        _own(self._each, self._all, k, motion, contacts)

    def meant(self, k: int, motion: Floats) -> None:
        """Fills motion (3,) as `own` does, by the wheels' set-points instead of the encoders.

        The set-points are the drive commands and the wheels' acceleration limit: what a robot knows without measuring.
        """
        _meant(self._each, self._all, k, motion)

    def meant_pose(self, k: int) -> Floats:
        """(3,) x, y, heading of robot k by its set-points when `meant` was last asked, in the frame of its start."""
        return self._each["meant_pose"][k].copy()

    def counted_pose(self, k: int) -> Floats:
        """(3,) x, y, heading of robot k by its odometry, in the frame of its start."""
        return self._each["pose"][k].copy()

    @property
    def bumpers(self) -> Bools:
        """(N, 2) left and right bumper pressed now."""
        return self._each["pressed"] > 0

    def take_contacts(self, k: int) -> Bools:
        """(2,) left and right bumper of robot k pressed at any step since this was last asked."""
        latched = self._each["latched"][k] > 0
        self._each["latched"][k] = 0
        return latched


@compiled
def _own(each: Any, shared: Any, k: int, motion: Floats, contacts: Bools) -> None:
    robot = each[k]
    elapsed = robot.requests * shared[0].period
    if elapsed > 0.0:
        robot.rates[0], robot.rates[1] = robot.distance / elapsed, robot.turn / elapsed
        robot.distance, robot.turn, robot.requests = 0.0, 0.0, 0.0
    motion[0], motion[1], motion[2] = robot.rates[0], 0.0, robot.rates[1]
    for side in range(2):
        contacts[side] = robot.latched[side] > 0
        robot.latched[side] = 0


@compiled
def _meant(each: Any, shared: Any, k: int, motion: Floats) -> None:
    robot, fleet = each[k], shared[0]
    steps = fleet.steps - robot.meant_step
    if steps > 0.0:
        left, right = fleet.wheel_radius * robot.meant_way[0], fleet.wheel_radius * robot.meant_way[1]
        distance, angle = drive.twist(fleet, left, right)
        odometry.move(robot.meant_pose, distance, angle)
        robot.meant_way[0], robot.meant_way[1], robot.meant_step = 0.0, 0.0, fleet.steps
        robot.meant_rates[0] = distance / (steps * fleet.timestep)
        robot.meant_rates[1] = angle / (steps * fleet.timestep)
    motion[0], motion[1], motion[2] = robot.meant_rates[0], 0.0, robot.meant_rates[1]


@compiled
def _command(each: Any, shared: Any, k: int, speed: float, turn_rate: float) -> None:
    if not (math.isfinite(speed) and math.isfinite(turn_rate)):
        raise ValueError("a drive command must be finite")
    fleet = shared[0]
    velocity_mm_s, radius_mm = drive.nearest_command(fleet, speed, turn_rate)
    meant_speed, meant_turn_rate = drive.meant(fleet, velocity_mm_s, radius_mm)
    left, right = drive.wheel_speeds(fleet, meant_speed, meant_turn_rate)
    each[k].target[0] = left / fleet.wheel_radius
    each[k].target[1] = right / fleet.wheel_radius


@compiled
def _ramped(each: Any, shared: Any, ctrl: Floats) -> None:
    fleet = shared[0]
    timestep, ramp = fleet.timestep, fleet.ramp
    fleet.steps += 1.0
    for k in range(len(each)):
        robot = each[k]
        for side in range(2):
            setpoint = robot.setpoint[side]
            change = robot.target[side] - setpoint
            setpoint += min(max(change, -ramp), ramp)
            robot.setpoint[side] = setpoint
            robot.meant_way[side] += setpoint * timestep
            ctrl[robot.servos[side]] = setpoint


@compiled
def _polled(each: Any, shared: Any, time: float, qpos: Floats, pairs: Ints, hulls: Ints) -> bool:
    """The encoders at the requests that were due since the last step. Whether any contact (C, 2) is one of a hull."""
    fleet = shared[0]
    period, timestep = fleet.period, fleet.timestep
    due = fleet.requests
    while (due + 1.0) * period <= time + 1e-9:
        due += 1.0
    for k in range(len(each)):
        robot = each[k]
        left, right = qpos[robot.wheels[0]], qpos[robot.wheels[1]]
        for request in range(int(fleet.requests) + 1, int(due) + 1):
            back = min(max((time - request * period) / timestep, 0.0), 1.0)
            left_then = left + back * (robot.angle[0] - left)
            right_then = right + back * (robot.angle[1] - right)
            distance_mm, angle_deg = odometry.request(fleet, left_then - robot.polled[0], right_then - robot.polled[1])
            robot.polled[0], robot.polled[1] = left_then, right_then
            distance, angle = 0.001 * distance_mm, math.radians(angle_deg)
            odometry.move(robot.pose, distance, angle)
            robot.distance += distance
            robot.turn += angle
            robot.requests += 1.0
        robot.angle[0], robot.angle[1] = left, right
    fleet.requests = due
    return touching.any_hull(pairs, hulls)


@compiled
def _felt(
    each: Any, rings: Any, roots: Ints, hulls: Ints, pairs: Ints, points: Floats, rows: Ints,
    efc_force: Floats, xpos: Floats, xmat: Floats, pressing: Floats,
) -> bool:  # fmt: skip
    """The bumpers, from the contacts that the step has found. Whether any hull is pressed.

    Arguments as in `bumpers.add` and `touching.normal_force`. They are arrays and not a tuple of them, which would cost
    as much as all the rest of the call.
    """
    pressing[:] = 0.0
    pressed = False
    for c in range(len(pairs)):
        for end in range(2):
            k = hulls[pairs[c, end]]
            if k != touching.UNOWNED:
                force = touching.normal_force(rows[c], efc_force)
                if force > 0.0:
                    root = roots[k]
                    bumpers.add(force, points[c], rings[0], xpos[root], xmat[root], pressing[k])
                    pressed = True
    for k in range(len(each)):
        robot = each[k]
        for side in range(2):
            robot.pressed[side] = 1 if pressing[k, side] > bumpers.FORCE else 0
            robot.latched[side] |= robot.pressed[side]
    return pressed
