"""What the one-legged robots of a fleet do at each physics step, compiled for all of them at once.

Each robot goes round three phases (`PHASES`), flight, loading and thrust, until it has fallen, a phase that it does not
leave. What it does in each is in `robots.one_legged.control`.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from flocking.angles import wrap
from flocking.compilation import compiled
from flocking.types import Floats
from robots.one_legged import control
from robots.one_legged import model as one_legged
from robots.one_legged.control import Gains

PHASES = FLIGHT, LOADING, THRUST, FALLEN = range(4)
CAUSES = ("", "body low", "tilt", "hip at its stop", "not finite")
"""Why a robot fell; the first: it is upright."""
LOW = 0.4
"""m: a body whose centre is lower has fallen; ?: one that runs is never below 0.55 m."""
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

MOST_TORQUE = 300.0
"""N m at the hinges about x and y; ?: bounds what a robot does whose control does not hold."""
MOST_TWIST = 20.0
"""N m at the hinge about z; ?: reached in the hardest turns; with more, a foot slips round under noisy control."""
MOST_FORCE = 5000.0
"""N along the leg; ?: likewise. No robot that runs upright reaches this or `MOST_TORQUE`."""

EACH = np.dtype(
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

ALL = np.dtype([*((name, np.float64) for name in Gains._fields), ("timestep", np.float64), ("torque", np.float64)])
"""What all robots of a fleet share: its `Gains`, the time step (s), the most torque at a hinge (N m)."""


@compiled
def actuate(each: Any, shared: Any, qpos: Floats, qvel: Floats, pushed: Floats, ctrl: Floats) -> None:
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
def limp(each: Any, shared: Any, qpos: Floats, qvel: Floats, ctrl: Floats) -> None:
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
def counted(each: Any, shared: Any, qpos: Floats, qvel: Floats, pushed: Floats) -> bool:
    """After a step: who has fallen, what others see, the odometry. pushed (nv,): as of `actuate`.

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
