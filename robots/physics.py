"""What every world with robots in it shares: the solver's options, and the parts of a robot that physics needs."""

from __future__ import annotations

import mujoco

TIMESTEP = 0.01
"""s. Chosen by evidence: tests/trials/simulations/robots/test_timestep.py holds motion, odometry and scans against
those at half of it, and what touches, slips and slides against 1 ms."""

GRAVITY = 9.81
"""m/s²."""

FLOOR_MASK = 1
"""Contact bit of the floor (its contype) and of wheels and casters (their conaffinity)."""
HULL_MASK = 2
"""Contact bit of hulls and walls, in both fields: they meet one another, not the floor."""


FRICTION_STIFFNESS = 400.0
"""How many times stiffer contacts are against sliding than against pressing (MuJoCo's impratio): tyres that give way
like springs (robots/create/model.py) then creep under a load by no more than 0.1 mm/s. D."""


def apply_options(spec: mujoco.MjSpec, timestep_s: float = TIMESTEP) -> None:
    """Sets the solver's options of a world in which robots drive.

    Newton's solver with an elliptic cone, in which friction can be stiffer than the normal force. The integrator is the
    semi-implicit Euler one; `take_servos_implicitly` makes it implicit in the wheels' servos. (MuJoCo's `implicit` ones
    correct velocities after the contacts are solved, and tyres then slip by centimetres a second on every ramp; its
    `discrete` one does not, but takes 2.2 times as long with 96 robots.)
    Mid-phase and multi-contact convex collision are of no use to spheres, planes and boxes.
    """
    spec.nuser_geom = 2  # reflectance: diffuse, retroreflective
    option = spec.option
    option.timestep = timestep_s
    option.gravity = (0.0, 0.0, -GRAVITY)
    option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    option.solver = mujoco.mjtSolver.mjSOL_NEWTON
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.impratio = FRICTION_STIFFNESS
    option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_MIDPHASE | mujoco.mjtDisableBit.mjDSBL_MULTICCD)


def take_servos_implicitly(spec: mujoco.MjSpec) -> None:
    """Lets every velocity servo on a joint act by the mean of its speeds before and after a step, the trapezoidal rule.
    To be called once, when the world is complete and its time step is set.

    A servo of gain k turns a wheel of inertia I by the torque k (ω* − ω) against the contacts' τ. Over a step of h that
    is I (ω' − ω) / h = k (ω* − (ω + ω') / 2) + τ, or (I + h k / 2) (ω' − ω) / h = k (ω* − ω) + τ: what an explicit step
    does with h k / 2 more of inertia at the joint, which the contact solver knows of. A wheel that slips so settles at
    the speed where servo and friction balance, whatever the step. Taken explicitly it would ring, since h k = 1.1 I for
    the Create at 10 ms, and its rim turn backwards. At its torque limit a servo has no gain but keeps that inertia: at
    10 ms a Create that rolls gathers speed a tenth more slowly there, a wheel that spins a third (D).
    """
    timestep = spec.option.timestep
    for servo in spec.actuators:
        gain = -servo.biasprm[2]
        if servo.trntype == mujoco.mjtTrn.mjTRN_JOINT and gain > 0.0:
            spec.joint(servo.target).armature += 0.5 * timestep * gain * servo.gear[0] ** 2


def bare(robot: mujoco.MjSpec) -> mujoco.MjSpec:
    """A copy of `robot` with what physics needs: without lights, without geoms that touch nothing, and without sites to
    which nothing refers.

    Bodies, joints and actuators stay as they are and keep their order. Masses and inertias are given as numbers, those
    that MuJoCo compiles for the whole robot: so the copy moves as the whole robot does, bit for bit, in 5 % less time.
    """
    whole, stripped = robot.compile(), robot.copy()
    for body in stripped.bodies[1:]:
        of = whole.body(body.name)
        body.explicitinertial = True
        body.mass, body.ipos, body.iquat, body.inertia = float(of.mass[0]), of.ipos, of.iquat, of.inertia
    seen = [geom for geom in stripped.geoms if geom.contype == 0 and geom.conaffinity == 0]
    on_sites = any(actuator.trntype == mujoco.mjtTrn.mjTRN_SITE for actuator in stripped.actuators)
    needs_sites = on_sites or len(stripped.sensors) > 0 or len(stripped.tendons) > 0 or len(stripped.equalities) > 0
    sites = [] if needs_sites else list(stripped.sites)
    for element in (*seen, *sites, *stripped.lights):
        stripped.delete(element)
    return stripped


BAD = (
    mujoco.mjtWarning.mjWARN_BADQPOS,
    mujoco.mjtWarning.mjWARN_BADQVEL,
    mujoco.mjtWarning.mjWARN_BADQACC,
    mujoco.mjtWarning.mjWARN_BADCTRL,
)
"""MuJoCo's warnings of a number that is not finite or too large: it then begins anew, or leaves out the control."""


class DivergedError(ValueError):
    """MuJoCo met such a number: what follows is worth nothing."""


def check_sound(data: mujoco.MjData) -> None:
    """Raises `DivergedError` if MuJoCo has met a number that is not finite or too large."""
    if sum(data.warning[int(kind)].number for kind in BAD):
        raise DivergedError(f"the physics diverged before {data.time:g} s")
