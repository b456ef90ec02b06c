"""All one-legged robots in a world: velocities commanded, torques at hips and forces along legs out.

What is done at each step is in `robots.one_legged.stepping`. The controller reads the state of its robot (orientation,
velocity, joints) and whether the foot touches anything, as the publication's does.

Others see the velocity with which a robot last flew, held through stance (`velocities`): in stance a robot slows down
and speeds up again, at 2 m/s by about 0.1 m/s. `actual_velocities` are those of now, `desired` those commanded.

Odometry counts the ground that the leg covers in stance, as seen from its joints and the attitude, and takes the speed
of the end of stance for that of the flight. Slip is invisible to it. There are no bumpers.
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
from robots import touching
from robots.one_legged import controller, stepping
from robots.one_legged import model as one_legged
from robots.one_legged.control import Gains, check_gains
from robots.one_legged.imperfections import Imperfections, Senses
from robots.physics import HULL_MASK

GAINS, NONE = Gains(), Imperfections()
_NOT_FINITE = "a commanded velocity must be finite"


class Fleet:
    """The one-legged robots in a compiled model, in the order of their `prefixes`; k is an index into it.

    Around each step: `before_step(data)`, `mj_step`, `after_step(data)`. A fleet belongs to one run from time 0: after
    a reset of the data, make a new one. Raises `InputError` for a prefix that no such robot has, and for a time step
    above `model.TIMESTEP`.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        prefixes: Sequence[str],
        gains: Gains = GAINS,
        imperfections: Imperfections = NONE,
        rng: np.random.Generator | None = None,
    ) -> None:
        """`rng`: of the imperfections' noise."""
        check_gains(gains, one_legged.LENGTH)
        count = len(prefixes)
        each, bodies = np.zeros(count, stepping.EACH), np.zeros(count, np.int64)
        hulls = np.full(model.ngeom, touching.UNOWNED, dtype=np.int64)
        if model.opt.timestep > one_legged.TIMESTEP + 1e-12:
            raise InputError(
                f"time step {model.opt.timestep:g} s: expected at most {one_legged.TIMESTEP:g} s with one-legged robots"
            )
        for k, prefix in enumerate(prefixes):
            try:
                bodies[k] = model.body(f"{prefix}base").id
                each[k]["root"] = model.joint(f"{prefix}root").qposadr[0]
                each[k]["speed"] = model.joint(f"{prefix}root").dofadr[0]
                for place, name in enumerate(one_legged.JOINTS):
                    each[k]["joints"][place] = model.joint(f"{prefix}{name}").qposadr[0]
                    each[k]["rates"][place] = model.joint(f"{prefix}{name}").dofadr[0]
                    each[k]["motors"][place] = model.actuator(f"{prefix}{name}").id
                hulls[model.geom(f"{prefix}hull").id] = k
            except KeyError as error:
                raise InputError(f"no one-legged robot with prefix {prefix!r} in the model: {error.args[0]}") from None
            w, x, y, z = model.qpos0[each[k]["root"] + 3 : each[k]["root"] + 7]
            heading = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
            each[k]["start"] = (*model.qpos0[each[k]["root"] : each[k]["root"] + 2], heading)
            each[k]["nose"] = each[k]["yaw"] = heading
        each["stance"], each["energy"], each["since"], each["fallen_at"] = stepping.FIRST_STANCE, 1.0, 1.0, np.nan
        self.root_bodies: Ints = bodies
        """(N,) body ids of the bodies with the hip."""
        self._each: Any = each
        self._all: Any = np.array([(*gains, model.opt.timestep, imperfections.torque_n_m)], dtype=stepping.ALL)
        self._hulls = hulls
        self._meets = bool((model.geom_contype & HULL_MASK).any())  # whether there is what a hull could meet
        self._data: mujoco.MjData | None = None
        self._senses = Senses(imperfections, each, model.opt.timestep, rng)
        self._shoved = self._any_fallen = False
        self._linear = each["speed"].reshape(-1, 1) + np.arange(2)

    # told ------------------------------------------------------------------------------------------
    def command(self, k: int, forward: float, left: float) -> None:
        """Tell robot k to run at this velocity, m/s, along the axes that it has now; limited to `MAX_SPEED`."""
        heading = float(self._each["yaw"][k])
        c, s = math.cos(heading), math.sin(heading)
        self.desire(k, c * forward - s * left, s * forward + c * left)

    def desire(self, k: int, x_w: float, y_w: float) -> None:
        """The same in the world's axes."""
        if not (math.isfinite(x_w) and math.isfinite(y_w)):
            raise ValueError(_NOT_FINITE)
        self._each["desired"][k] = controller.limited(x_w, y_w)

    def desire_all(self, velocities_w: Floats) -> None:
        """(N, 2) `desire` for all robots."""
        if not _desire_all(self._each, velocities_w):
            raise ValueError(_NOT_FINITE)

    def desire_limited(self, velocities_w: Floats) -> None:
        """The same; the velocities (N, 2) are themselves limited to `MAX_SPEED`."""
        self.desire_all(velocities_w)
        _desired(self._each, velocities_w)

    def push(self, data: mujoco.MjData, k: int, impulse_w: Sequence[float] | Floats) -> None:
        """Push robot k's body in its centre with an impulse (3,), N s in the world's axes, within the next step."""
        data.xfrc_applied[self.root_bodies[k], :3] = np.asarray(impulse_w) / self._all["timestep"][0]
        self._shoved = True

    # around each step ------------------------------------------------------------------------------
    def before_step(self, data: mujoco.MjData) -> None:
        """Bring torques and forces up to date with the robots' state."""
        if data is not self._data:  # the same arrays each step: to ask for them anew costs as much as to use them
            self._data = data
            self._qpos, self._qvel, self._ctrl, self._pushed = data.qpos, data.qvel, data.ctrl, data.qfrc_constraint
        read = self._qpos, self._qvel, self._pushed
        if self._senses.acts:
            read = self._senses.read(*read)
        stepping.actuate(self._each, self._all, *read, self._ctrl)
        if self._any_fallen:
            stepping.limp(self._each, self._all, self._qpos, self._qvel, self._ctrl)

    def after_step(self, data: mujoco.MjData) -> bool:
        """Count the way by odometry. Whether any outline may be pressed."""
        self._any_fallen = stepping.counted(self._each, self._all, self._qpos, self._qvel, self._pushed)
        if self._shoved:
            data.xfrc_applied[self.root_bodies] = 0.0
            self._shoved = False
        return self._meets and bool(touching.any_hull(data.contact.geom, self._hulls))

    # seen ------------------------------------------------------------------------------------------
    def poses(self, data: mujoco.MjData) -> Floats:
        """(N, 3) true x, y (m) of the hip and heading (rad, in (−π, π]) of all robots, at `data.time`."""
        poses = np.empty((len(self._each), 3))
        _poses(self._each, data.qpos, poses)
        return poses

    def velocities(self, data: mujoco.MjData) -> Floats:
        """(N, 2) what others see of the robots' velocities, in the world frame: as last seen in flight, m/s."""
        return self._each["seen"].copy()

    def look(self, data: mujoco.MjData, places_w: Floats, velocities_w: Floats, flying: Bools) -> None:
        """Fills places_w (N, 2) of the hips, m, `velocities` (N, 2) and `flying` (N,): all at once, for each step."""
        _look(self._each, data.qpos, places_w, velocities_w, flying)

    def actual_velocities(self, data: mujoco.MjData) -> Floats:
        """(N, 2) true velocities of the bodies now, in stance too, m/s."""
        return data.qvel[self._linear]

    @property
    def desired(self) -> Floats:
        """(N, 2) commanded velocities in the world frame, limited, m/s."""
        return self._each["desired"].copy()

    @property
    def flying(self) -> Bools:
        """(N,) in flight now."""
        return self._each["phase"] == stepping.FLIGHT

    @property
    def upright(self) -> Bools:
        """(N,) not fallen."""
        return self._each["phase"] != stepping.FALLEN

    @property
    def fallen_at(self) -> Floats:
        """(N,) s, when each robot fell; nan = it is upright."""
        return self._each["fallen_at"].copy()

    @property
    def causes(self) -> tuple[str, ...]:
        """(N,) why each robot fell: one of `stepping.CAUSES`; empty = it is upright."""
        return tuple(stepping.CAUSES[cause] for cause in self._each["cause"])

    @property
    def hops(self) -> Ints:
        """(N,) touchdowns until now."""
        return self._each["hops"].copy()

    @property
    def durations(self) -> Floats:
        """(N, 2) how long each robot's last stance and last flight took, s; 0 before there was a flight."""
        return np.column_stack([self._each["stance"], self._each["flight"]])

    # what a robot knows of itself ------------------------------------------------------------------
    @property
    def odometry(self) -> Floats:
        """(N, 3) x, y (m), heading (rad, unwrapped) by each robot's odometry, in the frame of its start."""
        return np.array([self.counted_pose(k) for k in range(len(self._each))])

    @property
    def bumpers(self) -> Bools:
        """(N, 2) all False: the robot has none."""
        return np.zeros((len(self._each), 2), dtype=np.bool_)

    def own(self, k: int, motion: Floats, contacts: Bools) -> None:
        """Fills motion (3,), robot k's mean velocity in its own axes (m/s) and its turn rate (rad/s) by odometry since
        this was last asked, and contacts (2,): none."""
        _own(self._each, self._all, k, motion)
        contacts[0] = contacts[1] = False

    def meant(self, k: int, motion: Floats) -> None:
        """Fills motion (3,) as `own` does, by the velocities that robot k was told and the heading it wants."""
        _meant(self._each, self._all, k, motion)

    def meant_pose(self, k: int) -> Floats:
        """(3,) x, y, heading of robot k by what it was told when `meant` was last asked, in the frame of its start."""
        robot = self._each[k]
        return _from_start(robot["start"], robot["meant_then"])

    def counted_pose(self, k: int) -> Floats:
        """(3,) x, y, heading of robot k by its odometry, in the frame of its start."""
        robot = self._each[k]
        return _from_start(robot["start"], np.array([*robot["way"], robot["yaw"] - robot["start"][2]]))


def _from_start(start: Floats, way: Floats) -> Floats:
    """(3,) a way in the world's axes, in those of the pose that it began from."""
    c, s = math.cos(start[2]), math.sin(start[2])
    return np.array([c * way[0] + s * way[1], c * way[1] - s * way[0], way[2]])


@compiled
def _desire_all(each: Any, velocities_w: Floats) -> bool:
    for k in range(len(each)):
        if not abs(velocities_w[k, 0]) + abs(velocities_w[k, 1]) < math.inf:
            return False
        each[k].desired[0], each[k].desired[1] = controller.limited(velocities_w[k, 0], velocities_w[k, 1])
    return True


@compiled
def _desired(each: Any, velocities_w: Floats) -> None:
    for k in range(len(each)):
        velocities_w[k, 0], velocities_w[k, 1] = each[k].desired[0], each[k].desired[1]


@compiled
def _look(each: Any, qpos: Floats, places_w: Floats, velocities_w: Floats, flying: Bools) -> None:
    for k in range(len(each)):
        robot = each[k]
        places_w[k, 0], places_w[k, 1] = qpos[robot.root], qpos[robot.root + 1]
        velocities_w[k, 0], velocities_w[k, 1] = robot.seen[0], robot.seen[1]
        flying[k] = robot.phase == stepping.FLIGHT


@compiled
def _own(each: Any, shared: Any, k: int, motion: Floats) -> None:
    robot = each[k]
    elapsed = (robot.steps - robot.own_steps) * shared[0].timestep
    if elapsed > 0.0:
        x, y = robot.way[0] - robot.own_way[0], robot.way[1] - robot.own_way[1]
        turned = robot.yaw - robot.start[2] - robot.own_way[2]
        _rates(robot.own_rates, x, y, turned, robot.yaw, elapsed)
        robot.own_way[0], robot.own_way[1], robot.own_way[2] = robot.way[0], robot.way[1], robot.yaw - robot.start[2]
        robot.own_steps = robot.steps
    motion[0], motion[1], motion[2] = robot.own_rates[0], robot.own_rates[1], robot.own_rates[2]


@compiled
def _meant(each: Any, shared: Any, k: int, motion: Floats) -> None:
    robot = each[k]
    elapsed = (robot.steps - robot.meant_steps) * shared[0].timestep
    if elapsed > 0.0:
        x, y = robot.meant_way[0] - robot.meant_then[0], robot.meant_way[1] - robot.meant_then[1]
        _rates(robot.meant_rates, x, y, robot.meant_way[2] - robot.meant_then[2], robot.nose, elapsed)
        for part in range(3):
            robot.meant_then[part] = robot.meant_way[part]
        robot.meant_steps = robot.steps
    motion[0], motion[1], motion[2] = robot.meant_rates[0], robot.meant_rates[1], robot.meant_rates[2]


@compiled
def _rates(rates: Floats, x: float, y: float, turned: float, heading: float, elapsed: float) -> None:
    """Fills rates (3,): a way in the world's axes as a velocity in those of that heading, and the turn rate."""
    c, s = math.cos(heading), math.sin(heading)
    rates[0], rates[1], rates[2] = (c * x + s * y) / elapsed, (c * y - s * x) / elapsed, turned / elapsed


@compiled
def _poses(each: Any, qpos: Floats, poses: Floats) -> None:
    for k in range(len(each)):
        at = each[k].root
        w, x, y, z = qpos[at + 3], qpos[at + 4], qpos[at + 5], qpos[at + 6]
        poses[k, 0], poses[k, 1] = qpos[at], qpos[at + 1]
        poses[k, 2] = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
