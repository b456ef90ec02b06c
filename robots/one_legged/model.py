"""The one-legged hopping robot of Hodgins and Brogan 1994 as a MuJoCo model: a body, a hip of three hinges, a leg that
slides.

Grades of the constants: P a primary document says so (tables 1 and 2 of "Robot herds", unless another is named); D
derived; ? not found, a choice of ours. The frame's origin stands on the floor below the hip in the canonical
configuration, x forward, y left, z up. The hip is in the body's centre of mass (table 2: the body's distal joint is 0.0
from it), so the body's own weight never tips it.
"""

from __future__ import annotations

from math import sqrt

import mujoco
import numpy as np

from robots.physics import FLOOR_MASK, HULL_MASK

# Links, tables 1 and 2 ----------------------------------------------------------------------------
BODY_MASS = 23.1  # kg; P
BODY_INERTIA = (0.9, 0.9, 0.602)  # kg m² about its centre of mass, x, y, z, as of all links; P
UPPER_MASS = 1.4  # kg; P
UPPER_INERTIA = (0.018463, 0.017297, 0.001441)  # kg m²; P
UPPER_TO_HIP = 0.095  # m from the upper leg's centre of mass up to the hip; P
UPPER_TO_LEG = 0.095  # m from it down to the sliding joint; P
LOWER_MASS = 0.64  # kg; P
LOWER_INERTIA = (0.0197, 0.0197, 0.000176)  # kg m²; P
LOWER_TO_LEG = 0.221  # m from the lower leg's centre of mass up to the sliding joint; P
LOWER_TO_FOOT = 0.304  # m from it down to the sole; ?: half a uniform rod of that mass and inertia, sqrt(12 I / m) / 2

LENGTH = UPPER_TO_HIP + UPPER_TO_LEG + LOWER_TO_LEG + LOWER_TO_FOOT  # m, hip to sole with the spring at rest; D
MASS = BODY_MASS + UPPER_MASS + LOWER_MASS  # kg; D

# Stops, which a running robot does not reach ------------------------------------------------------
HIP_RANGE = 1.3  # rad to either side of the hip's hinges about x and y; ?: short of where the axes of x and z meet
TWIST_RANGE = 2.0  # rad to either side of the hinge about z; ?
LEG_RANGE = (-0.35, 0.15)  # m shorter and longer than with the spring at rest; ?

# Foot ---------------------------------------------------------------------------------------------
FOOT_RADIUS = 0.02  # m; ?: a sphere
FOOT_FRICTION = 1.0  # ?: rubber on a rough floor
FOOT_TORSION = 0.02  # m: a foot pressed on by F resists a turn about the vertical up to this times F; ?
FOOT_SOLREF = (0.01, 1.0)  # s and damping ratio of the contact; ?: two of the robot's own time steps

# Outline ------------------------------------------------------------------------------------------
RADIUS = sqrt(2.0 * BODY_INERTIA[2] / BODY_MASS)  # m; D: of a uniform upright cylinder with the body's mass and inertia
HEIGHT = sqrt(12.0 * BODY_INERTIA[0] / BODY_MASS - 3.0 * RADIUS**2)  # m of the same cylinder; D
HULL_DEPTH = 0.45  # m below the hip that its outline reaches, a capsule; ?: it meets walls half a metre high
LYING_FRICTION = 0.5  # of the body on the floor when it has fallen; ?
LYING_TURNING = 0.05  # m, against turning and rolling there: a sphere stands for what is no sphere; ?
TIMESTEP = 0.005  # s, the greatest at which the robot is simulated; ?: at 0.01 s it falls (docs/one_legged.md)

JOINTS = ("hip_x", "hip_y", "hip_z", "leg")
"""In the order of the chain, from the body to the foot: the order of the hip's axes is a choice."""
DARK = (0.1, 0.0)  # reflectance, diffuse and retroreflective: black plastic; ?
BODY_COLOUR, LEG_COLOUR = (0.75, 0.55, 0.2, 1.0), (0.4, 0.42, 0.45, 1.0)


def spec() -> mujoco.MjSpec:
    """One robot with its sole on the plane z = 0 at the origin, facing +x: no floor, no light, no solver options.

    Body `base` with the free joint `root`, its origin in the hip; below it `upper_leg` on the hinges `hip_x`, `hip_y`,
    `hip_z` and `lower_leg` on the slide `leg`, positive where the leg is longer. A motor on each of the four, called
    like its joint: N m, N. Robots of this kind do not meet one another (section 4 of the publication: collisions have
    no effect and are counted); they meet walls and robots of other kinds. To be attached to a world.
    """
    robot = mujoco.MjSpec()
    robot.modelname = "one-legged"
    robot.compiler.degree = False
    base = robot.worldbody.add_body(name="base", pos=(0.0, 0.0, LENGTH))
    base.add_freejoint(name="root")
    _weigh(base, BODY_MASS, BODY_INERTIA, 0.0)
    base.add_geom(
        name="trunk", type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=(RADIUS, HEIGHT / 2, 0), contype=0, conaffinity=0,
        mass=0.0, rgba=BODY_COLOUR, userdata=DARK,
    )  # fmt: skip
    base.add_geom(
        name="lying", type=mujoco.mjtGeom.mjGEOM_SPHERE, size=(RADIUS, 0, 0), contype=0, conaffinity=FLOOR_MASK,
        mass=0.0, condim=6, priority=1, friction=(LYING_FRICTION, LYING_TURNING, LYING_TURNING), rgba=(0, 0, 0, 0),
        group=3, userdata=DARK,
    )  # fmt: skip
    base.add_geom(
        name="hull", type=mujoco.mjtGeom.mjGEOM_CAPSULE, size=(RADIUS, HULL_DEPTH / 2, 0), pos=(0, 0, -HULL_DEPTH / 2),
        contype=0, conaffinity=HULL_MASK, mass=0.0, condim=3, priority=1, friction=(LYING_FRICTION, 0, 0),
        rgba=(0, 0, 0, 0), group=3, userdata=DARK,
    )  # fmt: skip
    upper = base.add_body(name="upper_leg")
    for axis, name in enumerate(JOINTS[:3]):
        most = TWIST_RANGE if axis == 2 else HIP_RANGE
        upper.add_joint(name=name, axis=np.eye(3)[axis], limited=1, range=(-most, most))
    _weigh(upper, UPPER_MASS, UPPER_INERTIA, -UPPER_TO_HIP)
    _rod(upper, "thigh", 0.04, 0.0, -UPPER_TO_HIP - UPPER_TO_LEG)
    lower = upper.add_body(name="lower_leg", pos=(0.0, 0.0, -UPPER_TO_HIP - UPPER_TO_LEG))
    lower.add_joint(name="leg", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=(0, 0, -1), limited=1, range=LEG_RANGE)
    _weigh(lower, LOWER_MASS, LOWER_INERTIA, -LOWER_TO_LEG)
    _rod(lower, "shin", 0.018, 0.0, -LOWER_TO_LEG - LOWER_TO_FOOT)
    lower.add_geom(
        name="foot", type=mujoco.mjtGeom.mjGEOM_SPHERE, size=(FOOT_RADIUS, 0, 0),
        pos=(0, 0, FOOT_RADIUS - LOWER_TO_LEG - LOWER_TO_FOOT), contype=0, conaffinity=FLOOR_MASK, mass=0.0,
        condim=4, friction=(FOOT_FRICTION, FOOT_TORSION, 0), priority=1, solref=FOOT_SOLREF, rgba=LEG_COLOUR,
        userdata=DARK,
    )  # fmt: skip
    for name in JOINTS:
        robot.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    return robot


def _weigh(body: mujoco.MjsBody, mass: float, inertia: tuple[float, float, float], z: float) -> None:
    """Gives a link its mass and inertia, with the centre of mass at height z of its frame."""
    body.explicitinertial = True
    body.mass, body.inertia, body.ipos = mass, inertia, (0.0, 0.0, z)


def _rod(body: mujoco.MjsBody, name: str, radius: float, top: float, bottom: float) -> None:
    """What is seen of a link of the leg."""
    body.add_geom(
        name=name, type=mujoco.mjtGeom.mjGEOM_CAPSULE, size=(radius, (top - bottom) / 2 - radius, 0),
        pos=(0, 0, (top + bottom) / 2), contype=0, conaffinity=0, mass=0.0, rgba=LEG_COLOUR, userdata=DARK,
    )  # fmt: skip
