"""What every world with robots in it shares: the solver's options, and the parts of a robot that physics needs."""

from __future__ import annotations

import mujoco

TIMESTEP = 0.01
"""s. Chosen by evidence: tests/trials/simulations/robots/test_timestep.py holds motion, odometry and scans against
those at half of it."""

GRAVITY = 9.81
"""m/s²."""

FLOOR_MASK = 1
"""Contact bit of the floor (its contype) and of wheels and casters (their conaffinity)."""
HULL_MASK = 2
"""Contact bit of hulls and walls, in both fields: they meet one another, not the floor."""


def apply_options(spec: mujoco.MjSpec, timestep_s: float = TIMESTEP) -> None:
    """Sets the solver's options of a world in which robots drive.

    Newton's solver with a pyramidal cone. The integrator is the semi-implicit Euler one, which takes the wheels'
    servos explicitly: MuJoCo's implicit ones correct velocities after the contacts are solved, and tyres then
    slip by centimetres a second on every ramp. Euler's integrator is stable while gain × time step < 2 × the inertia
    of a free wheel, which holds for time steps below 22 ms.
    Mid-phase and multi-contact convex collision are of no use to spheres, planes and boxes.
    """
    spec.nuser_geom = 2  # reflectance: diffuse, retroreflective
    option = spec.option
    option.timestep = timestep_s
    option.gravity = (0.0, 0.0, -GRAVITY)
    option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    option.solver = mujoco.mjtSolver.mjSOL_NEWTON
    option.cone = mujoco.mjtCone.mjCONE_PYRAMIDAL
    option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_MIDPHASE | mujoco.mjtDisableBit.mjDSBL_MULTICCD)


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
