"""All one-legged robots in a world: velocities commanded, torques at hips and forces along legs out.

Each robot goes round four phases (`PHASES`): flight, loading, thrust, and fallen, which it does not leave. What it does
in each is in `robots.one_legged.control`. The controller reads the state of its robot (orientation, velocity, joints)
and whether the foot touches anything, as the publication's does.

Others see the velocity with which a robot last flew, held through stance (`velocities`): in stance a robot slows down
and speeds up again by a few tenths of a m/s. `actual_velocities` are those of now, `desired` those commanded.

Odometry counts the ground that the leg covers in stance, as seen from its joints and the attitude, and takes the speed
of the end of stance for that of the flight. Slip is invisible to it. There are no bumpers.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from flocking.angles import wrap
from flocking.compilation import compiled
from flocking.errors import InputError
from flocking.types import Bools, Floats, Ints
from robots import touching
from robots.one_legged import control, controller
from robots.one_legged import model as one_legged
from robots.one_legged.control import Gains
from robots.one_legged.imperfections import Imperfections, Senses
from robots.physics import HULL_MASK

PHASES = FLIGHT, LOADING, THRUST, FALLEN = range(4)
CAUSES = ("", "body low", "tilt", "hip at its stop", "not finite")
"""Why a robot fell; the first: it is upright."""
LOW = 0.4
"""m: a body whose centre is lower has fallen; ?: in the deepest stance at 3 m/s it is at 0.57 m."""
TILT = math.radians(60.0)
"""rad: a body that leans further has fallen; ?."""
SHORTEST_FLIGHT = 0.05
"""s after lift-off in which a touch is no touchdown: the foot rattles; ?."""
SHORTEST_STANCE = 0.02
"""s after touchdown in which there is no lift-off; ?."""
FIRST_STANCE = 0.15
"""s, what a stance is expected to last before there was one; D: near half a period of the mass on the spring."""
TURN_RATE = 1.5
"""rad/s at which the wanted heading comes round to the way the robot runs, at the most; ?."""
RUNS = 0.3
"""m/s: a robot told to run slower keeps its heading; ?."""
LIMP_DAMPING = 0.05
"""N m s/rad of the hip of a robot that has fallen; ?."""

MOST_TORQUE, MOST_TWIST, MOST_FORCE = 300.0, 20.0, 5000.0
"""N m at the hinges about x and y, N m at the one about z, N along the leg: ?. A robot that runs does not reach them
(docs/one_legged.md); they bound what one does whose control does not hold."""

GAINS, NONE = Gains(), Imperfections()

_EACH = np.dtype(
    [
        ("root", np.int64),  # where its free joint stands in qpos
        ("speed", np.int64),  # and in qvel
        ("joints", np.int64, (4,)),  # where hip_x, hip_y, hip_z and leg stand in qpos
        ("rates", np.int64, (4,)),  # in qvel
        ("motors", np.int64, (4,)),  # in ctrl
        ("phase", np.int64),
        ("since", np.float64),  # s in this phase; for thrust since touchdown
        ("touches", np.int64),  # 1 = its foot touched something in the last step
        ("length", np.float64),  # m that the leg is wanted longer than LENGTH
        ("stance", np.float64),  # s that its last stance took
        ("flight", np.float64),  # s that its last flight took
        ("energy", np.float64),  # of `control.thrust`
        ("hops", np.int64),  # touchdowns until now
        ("desired", np.float64, (2,)),  # m/s in the world
        ("nose", np.float64),  # rad, the heading wanted
        ("seen", np.float64, (2,)),  # m/s in the world, in flight
        ("fallen_at", np.float64),  # s, nan = upright
        ("cause", np.int64),
        ("steps", np.float64),  # begun until now
        ("foot", np.float64, (2,)),  # m, the foot from the hip in the world's axes after the last step
        ("pace", np.float64, (2,)),  # m/s in the world, by odometry
        ("yaw", np.float64),  # rad, its heading after the last step, unwrapped
        ("start", np.float64, (3,)),  # m, m, rad: where it began
        ("way", np.float64, (2,)),  # m in the world from its start, by odometry
        ("own_way", np.float64, (3,)),  # `way` and `yaw` when `own` was last asked
        ("own_steps", np.float64),
        ("own_rates", np.float64, (3,)),  # what `own` answered last
        ("meant_way", np.float64, (3,)),  # m, m in the world and rad from its start, as it was told
        ("meant_then", np.float64, (3,)),  # the same when `meant` was last asked
        ("meant_steps", np.float64),
        ("meant_rates", np.float64, (3,)),
    ]
)
"""One robot."""

_ALL = np.dtype([*((name, np.float64) for name in Gains._fields), ("timestep", np.float64), ("torque", np.float64)])
"""What all robots of a fleet share: its `Gains`, the time step (s), the most torque at a hinge (N m)."""


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
        count = len(prefixes)
        each, bodies = np.zeros(count, _EACH), np.zeros(count, np.int64)
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
        each["stance"], each["energy"], each["since"], each["fallen_at"] = FIRST_STANCE, 1.0, 1.0, np.nan
        self.root_bodies: Ints = bodies
        """(N,) body ids of the bodies with the hip."""
        self._each: Any = each
        self._all: Any = np.array([(*gains, model.opt.timestep, imperfections.torque_n_m)], dtype=_ALL)
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
            raise ValueError("a commanded velocity must be finite")
        self._each["desired"][k] = controller.limited(x_w, y_w)

    def desire_all(self, velocities_w: Floats) -> None:
        """(N, 2) `desire` for all robots."""
        _desire_all(self._each, velocities_w)

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
        _actuate(self._each, self._all, *read, self._ctrl)
        if self._any_fallen:
            _limp(self._each, self._all, self._qpos, self._qvel, self._ctrl)

    def after_step(self, data: mujoco.MjData) -> bool:
        """Count the way by odometry. Whether any outline may be pressed."""
        self._any_fallen = _counted(self._each, self._all, self._qpos, self._qvel, self._pushed)
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
        return self._each["phase"] == FLIGHT

    @property
    def upright(self) -> Bools:
        """(N,) not fallen."""
        return self._each["phase"] != FALLEN

    @property
    def fallen_at(self) -> Floats:
        """(N,) s, when each robot fell; nan = it is upright."""
        return self._each["fallen_at"].copy()

    @property
    def causes(self) -> tuple[str, ...]:
        """(N,) why each robot fell: one of `CAUSES`; empty = it is upright."""
        return tuple(CAUSES[cause] for cause in self._each["cause"])

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
def _desire_all(each: Any, velocities_w: Floats) -> None:
    for k in range(len(each)):
        each[k].desired[0], each[k].desired[1] = controller.limited(velocities_w[k, 0], velocities_w[k, 1])


@compiled
def _actuate(each: Any, shared: Any, qpos: Floats, qvel: Floats, pushed: Floats, ctrl: Floats) -> None:
    """One step of the control of all robots: phases, then the force along each leg and the torques at each hip.

    pushed (nv,): forces of contacts on each degree of freedom. On a leg's slide there are such only while its foot
    touches something.
    """
    given = shared[0]
    step = given.timestep
    for k in range(len(each)):
        robot = each[k]
        at, moves, motors = robot.root, robot.speed, robot.motors
        robot.touches = 1 if pushed[robot.rates[3]] != 0.0 else 0
        turn = control.rotation(qpos[at + 3], qpos[at + 4], qpos[at + 5], qpos[at + 6])
        hip_x, hip_y, hip_z = qpos[robot.joints[0]], qpos[robot.joints[1]], qpos[robot.joints[2]]
        rate_x, rate_y, rate_z = qvel[robot.rates[0]], qvel[robot.rates[1]], qvel[robot.rates[2]]
        longer, rate = qpos[robot.joints[3]], qvel[robot.rates[3]]
        vx, vy = qvel[moves], qvel[moves + 1]
        robot.steps += 1.0
        if robot.phase == FALLEN:
            continue
        _phase(robot, given, longer, rate, step)
        _turn_nose(robot, step)
        if robot.phase == FLIGHT:
            robot.length = -given.draw if robot.since < 0.5 * given.flight_s else 0.0
            x, y = control.foot_place(
                vx, vy, robot.desired[0], robot.desired[1], robot.stance, given.placement, given.most_error,
                given.most_reach,
            )  # fmt: skip
            down = math.sqrt(one_legged.LENGTH**2 - x * x - y * y)
            scale = 1.0 / one_legged.LENGTH
            dx, dy, dz = control.to_body(turn, -x * scale, -y * scale, down * scale)
            wanted_x, wanted_y = control.hip_angles(dx, dy, dz)
            torque_x = given.swing * (wanted_x - hip_x) - given.swing_rate * rate_x
            torque_y = given.swing * (wanted_y - hip_y) - given.swing_rate * rate_y
            torque_z = -given.twist * hip_z - given.twist_rate * rate_z
            force = control.spring_force(robot.length - longer, rate, given.swing_spring, given.swing_damping)
        else:
            force = control.spring_force(robot.length - longer, rate, given.spring, given.spring_damping)
            pressed = max(force, 0.0)
            body_x, body_y = control.upright_torque(
                turn, qvel[moves + 3], qvel[moves + 4], given.attitude, given.attitude_damping,
                given.grip * pressed * (one_legged.LENGTH + longer),
            )  # fmt: skip
            error = wrap(robot.nose - math.atan2(turn[3], turn[0]))
            body_z = control.yaw_torque(error, qvel[moves + 5], given.yaw, given.yaw_damping, given.yaw_grip * pressed)
            torque_x, torque_y, torque_z = control.hip_torques(hip_x, hip_y, body_x, body_y, body_z)
        most = min(given.torque, MOST_TORQUE)
        ctrl[motors[0]] = min(max(torque_x, -most), most)
        ctrl[motors[1]] = min(max(torque_y, -most), most)
        most = min(most, MOST_TWIST)
        ctrl[motors[2]] = min(max(torque_z, -most), most)
        ctrl[motors[3]] = min(max(force, -MOST_FORCE), MOST_FORCE)


@compiled
def _fallen(height: float, upright: float, hip: float, other: float) -> int:
    """Which of `CAUSES` holds; 0 = none.

    height: of the body, m; upright: the vertical component of its axis; hip: the greater of its angles about x and y,
    rad; other: what must be finite too.
    """
    if not math.isfinite(height + upright + hip + other):
        return 4
    if height < LOW:
        return 1
    if upright < math.cos(TILT):
        return 2
    return 3 if hip > one_legged.HIP_RANGE else 0


@compiled
def _limp(each: Any, shared: Any, qpos: Floats, qvel: Floats, ctrl: Floats) -> None:
    """Robots that have fallen: a hip without torque, but for friction, and a leg that keeps its length by itself."""
    given = shared[0]
    for k in range(len(each)):
        robot = each[k]
        if robot.phase == FALLEN:
            for hinge in range(3):
                ctrl[robot.motors[hinge]] = -LIMP_DAMPING * qvel[robot.rates[hinge]]
            longer, rate = qpos[robot.joints[3]], qvel[robot.rates[3]]
            ctrl[robot.motors[3]] = control.spring_force(-longer, rate, given.swing_spring, given.swing_damping)


@compiled
def _phase(robot: Any, given: Any, longer: float, rate: float, step: float) -> None:
    """Brings the phase up to date: touchdown, the bottom of stance, lift-off."""
    robot.since += step
    if robot.phase == FLIGHT:
        if robot.touches > 0 and robot.since > SHORTEST_FLIGHT:
            if robot.hops > 0:
                robot.flight = robot.since
                robot.energy = control.trimmed(robot.energy, given.trim, robot.since, given.flight_s)
            robot.phase, robot.since, robot.length = LOADING, 0.0, 0.0
            robot.hops += 1
    elif robot.touches == 0 and robot.since > SHORTEST_STANCE:
        robot.stance = 0.5 * (robot.stance + robot.since)
        robot.phase, robot.since = FLIGHT, 0.0
    elif robot.phase == LOADING and rate >= 0.0 and robot.since > step:
        mass = one_legged.BODY_MASS + one_legged.UPPER_MASS
        robot.length = longer + control.thrust(mass, given.spring, given.flight_s, robot.energy)
        robot.phase = THRUST


@compiled
def _turn_nose(robot: Any, step: float) -> None:
    """Lets the wanted heading come round to the way that the robot is told to run."""
    if math.hypot(robot.desired[0], robot.desired[1]) > RUNS:
        away = wrap(math.atan2(robot.desired[1], robot.desired[0]) - robot.nose)
        most = TURN_RATE * step
        robot.nose += min(max(away, -most), most)
    robot.meant_way[0] += robot.desired[0] * step
    robot.meant_way[1] += robot.desired[1] * step
    robot.meant_way[2] = robot.nose - robot.start[2]


@compiled
def _counted(each: Any, shared: Any, qpos: Floats, qvel: Floats, pushed: Floats) -> bool:
    """After a step: who has fallen, what others see, the odometry. pushed (nv,): as of `_actuate`.

    Whether any has fallen.
    """
    step, any_fallen = shared[0].timestep, False
    for k in range(len(each)):
        robot = each[k]
        at = robot.root
        turn = control.rotation(qpos[at + 3], qpos[at + 4], qpos[at + 5], qpos[at + 6])
        robot.yaw += wrap(math.atan2(turn[3], turn[0]) - robot.yaw)
        if robot.phase != FALLEN:
            hip = max(abs(qpos[robot.joints[0]]), abs(qpos[robot.joints[1]]))
            robot.cause = _fallen(qpos[at + 2], turn[8], hip, qvel[robot.speed] + qvel[robot.speed + 1])
            if robot.cause > 0:
                robot.phase, robot.fallen_at = FALLEN, robot.steps * step
        touches = pushed[robot.rates[3]] != 0.0
        if robot.phase == FLIGHT and not touches:
            robot.seen[0], robot.seen[1] = qvel[robot.speed], qvel[robot.speed + 1]
        length = one_legged.LENGTH + qpos[robot.joints[3]]
        dx, dy, dz = control.leg_direction(qpos[robot.joints[0]], qpos[robot.joints[1]])
        x, y, _ = control.to_world(turn, -length * dx, -length * dy, -length * dz)
        if touches and (robot.phase == LOADING or robot.phase == THRUST):
            robot.pace[0], robot.pace[1] = (robot.foot[0] - x) / step, (robot.foot[1] - y) / step
        elif robot.phase == FALLEN:
            robot.pace[0], robot.pace[1] = 0.0, 0.0
            robot.seen[0], robot.seen[1] = 0.0, 0.0
        robot.foot[0], robot.foot[1] = x, y
        robot.way[0] += robot.pace[0] * step
        robot.way[1] += robot.pace[1] * step
        any_fallen |= robot.phase == FALLEN
    return any_fallen


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
