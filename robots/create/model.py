"""The iRobot Create (first generation) with its payload, as a MuJoCo model.

Grades of the constants: P a primary document says so; C read in published code; S a secondary page;
D derived; ? not found, a choice of ours. The frame's origin stands on the floor midway between the
wheels, x forward, z up.

The outline meets walls and other robots through one sphere whose equator is the bumper's ring: against
vertical walls and other Creates it touches exactly where an upright cylinder would, at one point, at the
bumper's height, and at a fraction of the cost. It is invisible (alpha 0), as are the spheres on which
the wheels roll; what lasers and eyes see are plain cylinders and boxes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from robots.create import bumpers
from robots.create.bumpers import Ring
from robots.create.drive import Gear
from robots.physics import FLOOR_MASK, HULL_MASK

# Base ---------------------------------------------------------------------------------------------
DIAMETER = 0.33  # m; C: Player's create driver
RADIUS = DIAMETER / 2  # D
AXLE_TRACK = 0.258  # m between the wheels' contact points; C: libcreate (CREATE_1), Player's create driver
WHEEL_RADIUS = 0.033  # m; C: turtlebot's model of the Create 1
WHEEL_WIDTH = 0.023  # m; C: turtlebot's model
CASTER_X = 0.13  # m, one before and one behind; C: turtlebot's model
REAR_CLEARANCE = 0.0005  # m of the rear caster at rest: it only catches; ?
CASTER_RADIUS = 0.015  # m; ?
GROUND_CLEARANCE = 0.012  # m; ?
DECK_HEIGHT = 0.065  # m, top of the base; ?
BUMPER_HEIGHT = 0.045  # m, middle of the bumper's ring, for Creates of all sizes: so rings meet at their equators; ?
BASE_MASS = 2.5  # kg with battery and wheels; S: models 2 to 2.5, the real machine 2.5 to 3
WHEEL_MASS = 0.1  # kg, the turning part of one wheel; ?
BATTERY_MASS = 0.5  # kg of the base's mass; ?
BATTERY_X = 0.03  # m before the axle; ?: the bare machine rests on its front caster

# Payload ------------------------------------------------------------------------------------------
LAPTOP_MASS = 1.0  # kg, ASUS Eee PC; S
LAPTOP_SIZE = (0.164, 0.225, 0.035)  # m, closed, x y z; S: Eee PC 900
LAPTOP_X = 0.02  # m before the axle; ?: within the outline
LASER_MASS = 0.16  # kg, Hokuyo URG-04LX-UG01; S: data sheet
LASER_SIZE = (0.05, 0.05, 0.045)  # m, housing below its window; S: 50 x 50 mm, its height is ?
LASER_WINDOW = 0.055  # m, scan plane above the laser's foot; ?
LASER_HEIGHT = DECK_HEIGHT + LAPTOP_SIZE[2] + LASER_WINDOW  # D: the laser stands on the laptop on the deck
LASER_X = 0.0  # m, before the axle; ?: over the robot's centre, so that bearings are the body's
SILHOUETTE_RADIUS = RADIUS  # m of the reflective cylinder; ?: about the base's (Fine 2015, figure 2.4)
SILHOUETTE_HEIGHT = 0.12  # m; ?: the laser's plane in its upper half
SILHOUETTE_MASS = 0.05  # kg; ?: about 0.12 m² of cardboard at 0.4 kg/m²

# Reflectance (diffuse albedo; on-axis brightness of the retroreflective part relative to white paper) ------------
SHEETING = (0.5, 1500.0)  # reflective paper; S: sheeting is about 1500 times diffuse white on axis; albedo ?
PLASTIC = (0.6, 0.0)  # light plastic; ?
DARK = (0.1, 0.0)  # black plastic and rubber; ?

# Drive --------------------------------------------------------------------------------------------
MAX_SPEED = 0.5  # m/s of each wheel; P: Open Interface, drive command
MAX_WHEEL_ACCELERATION = 0.9  # m/s² at the rim; C: Create 3 (none is published for the first generation)
MAX_WHEEL_TORQUE = 0.45  # N m; ?: a little more than the grip of a tyre, pressed down as well by the friction at a wall
WHEEL_SERVO_GAIN = 0.06  # N m s/rad; ?: follows within about 40 ms
ROTOR_INERTIA = 5e-4  # kg m² at the wheel's axis, of motor and gear; ?
TYRE_FRICTION = 0.6  # rubber on a smooth floor; ?
BUMPER_FRICTION = 0.3  # plastic on paint; ?
BUMPER_TRAVEL = 0.004  # m; ?: how far before the outline contact with a wall begins (see `BUMPER`)
BUMPER_OVERLAP = 0.035  # m either side of the middle where both bits are set; ?: about 12 degrees


class Part(NamedTuple):
    """A solid that gives the robot mass (and looks): a cylinder about z, or a box."""

    name: str
    size: tuple[float, ...]
    """m: cylinder (radius, height); box (x, y, z), full lengths."""
    position: tuple[float, float, float]
    """m, of its centre."""
    mass: float
    reflectance: tuple[float, float]
    rgba: tuple[float, float, float, float]


CHASSIS_HEIGHT = DECK_HEIGHT - GROUND_CLEARANCE  # D
LAPTOP_TOP = DECK_HEIGHT + LAPTOP_SIZE[2]  # D
PARTS = (
    Part(
        "chassis",
        (RADIUS, CHASSIS_HEIGHT),
        (0.0, 0.0, GROUND_CLEARANCE + CHASSIS_HEIGHT / 2),
        BASE_MASS - BATTERY_MASS - 2 * WHEEL_MASS,
        PLASTIC,
        (0.86, 0.87, 0.88, 1.0),
    ),
    Part("battery", (0.1, 0.12, 0.04), (BATTERY_X, 0.0, 0.035), BATTERY_MASS, DARK, (0.2, 0.2, 0.2, 1.0)),
    Part(
        "laptop",
        LAPTOP_SIZE,
        (LAPTOP_X, 0.0, DECK_HEIGHT + LAPTOP_SIZE[2] / 2),
        LAPTOP_MASS,
        DARK,
        (0.1, 0.1, 0.12, 1.0),
    ),
    Part(
        "hokuyo",
        LASER_SIZE,
        (LASER_X, 0.0, LAPTOP_TOP + LASER_SIZE[2] / 2),
        LASER_MASS,
        DARK,
        (0.15, 0.15, 0.15, 1.0),
    ),
    Part(
        "sheeting",
        (SILHOUETTE_RADIUS, SILHOUETTE_HEIGHT),
        (0.0, 0.0, DECK_HEIGHT + SILHOUETTE_HEIGHT / 2),
        SILHOUETTE_MASS,
        SHEETING,
        (0.93, 0.55, 0.12, 1.0),
    ),
)

# Contacts. MuJoCo's convex friction couples sliding with lifting: a contact that slides at v settles μ b v / k higher
# than one at rest. A stiff tyre, which at rest is pressed in by a hundredth of that, would hop from step to step, and
# all that slips would hang on the time step. So tyres give way like springs: pressed in by 3 mm under their loads,
# they keep to the floor at any slip that a Create can reach. Their solref is stiffness K (1/s²) and damping B (1/s),
# negative by MuJoCo's convention; their solimp the impedance d. At rest a tyre with load N and inverse inertia A
# (MuJoCo's body_invweight0) is pressed in by (1 − d) A N / K, of which a slip of v lifts μ B v / K: all of it at 0.6
# m/s. Slip in grip fades at B / d = 100/s, as fast as steps of 10 ms allow. With solref (0.02, 1) casters and bumper
# have a time constant, at least twice the time step, and a damping ratio.
# The margins, the distances at which contact begins, are what tyres and caster are pressed in under their loads: so
# the robot starts at rest, stands at z = 0, and its wheels roll on their nominal radius (a test reads this back). The
# casters are softer than MuJoCo's limit, or braking would lift the front one for a step at a time.
TYRE = {"solref": (-3000.0, -20.0), "solimp": (0.2, 0.2, 0.001, 0.5, 2.0)}
TYRE_MARGIN = 3.00848e-3  # m; D
CASTER = {"solref": (0.02, 1.0), "solimp": (0.9, 0.9, 0.001, 0.5, 2.0)}
CASTER_MARGIN = 2.848e-5  # m; D
# The bumper gives way: contact begins `BUMPER_TRAVEL` before the outline and grows stiff towards it, because at
# 0.5 m/s a robot moves 5 mm in one step of 10 ms, and would stand that deep in a wall before any contact were found.
# Where two robots meet both bumpers give: their contact begins at twice that, they press on one another some 5 mm
# apart, and a robot on a wall some 2 mm from it.
BUMPER = {"solref": (0.02, 1.0), "solimp": (0.5, 0.95, 0.004, 0.5, 2.0), "margin": BUMPER_TRAVEL}


class Inertia(NamedTuple):
    """Mass properties of the base with its payload, without the wheels."""

    mass: float
    """kg."""
    centre: tuple[float, float, float]
    """m."""
    tensor: NDArray[np.float64]
    """(3, 3) about the centre of mass, along the body's axes, kg m²."""


class Dimensions(NamedTuple):
    """What differs from one size of Create to another; lengths in m, masses in kg."""

    name: str
    gear: Gear
    ring: Ring
    radius: float
    """Of the outline."""
    silhouette_radius: float
    """Of what stands at the laser's height."""
    parts: tuple[Part, ...]
    """Of the base and its payload."""
    laser: tuple[float, float, float]
    """Of its site: x, y, height."""
    wheel_width: float
    wheel_mass: float
    caster_x: float
    """Of the front one; the rear one as far behind."""
    caster_radius: float
    rear_clearance: float
    max_wheel_torque: float
    """N m."""
    tyre_margin: float
    caster_margin: float


DIMENSIONS = Dimensions(
    name="create",
    gear=Gear(AXLE_TRACK, WHEEL_RADIUS, MAX_SPEED, MAX_WHEEL_ACCELERATION),
    ring=bumpers.ring(RADIUS, BUMPER_HEIGHT, BUMPER_OVERLAP),
    radius=RADIUS,
    silhouette_radius=SILHOUETTE_RADIUS,
    parts=PARTS,
    laser=(LASER_X, 0.0, LASER_HEIGHT),
    wheel_width=WHEEL_WIDTH,
    wheel_mass=WHEEL_MASS,
    caster_x=CASTER_X,
    caster_radius=CASTER_RADIUS,
    rear_clearance=REAR_CLEARANCE,
    max_wheel_torque=MAX_WHEEL_TORQUE,
    tyre_margin=TYRE_MARGIN,
    caster_margin=CASTER_MARGIN,
)


def base_inertia(parts: Sequence[Part] = PARTS) -> Inertia:
    """From the parts' masses and shapes: solid cylinders and boxes, moved by the parallel-axis theorem.

    The model's own inertia is MuJoCo's sum over the same parts; a test holds one against the other.
    """
    masses = np.array([part.mass for part in parts])
    places = np.array([part.position for part in parts])
    centre = masses @ places / masses.sum()
    tensor = np.zeros((3, 3))
    for part, offset in zip(parts, places - centre, strict=True):
        if len(part.size) == 3:
            x2, y2, z2 = np.square(part.size)
            own = np.array((y2 + z2, x2 + z2, x2 + y2)) / 12
        else:
            r2, h2 = np.square(part.size)
            own = np.array((r2 / 4 + h2 / 12, r2 / 4 + h2 / 12, r2 / 2))
        tensor += part.mass * (np.diag(own) + offset @ offset * np.eye(3) - np.outer(offset, offset))
    return Inertia(float(masses.sum()), tuple(centre.tolist()), tensor)


def spec(dimensions: Dimensions = DIMENSIONS) -> mujoco.MjSpec:
    """One robot on the plane z = 0 at the origin, facing +x: no floor, no light, no solver options.

    Body `base` with the free joint `root`; bodies, joints and actuators `left` and `right` of the wheels
    (control: wheel speed, rad/s); sites `laser`, and `bumper_left`, `bumper_right` where the bumpers feel. To be
    attached to a world.
    """
    robot = mujoco.MjSpec()
    robot.modelname = dimensions.name
    base = robot.worldbody.add_body(name="base")
    base.add_freejoint(name="root")
    for part in dimensions.parts:
        _add_part(base, part)
    sphere, ring = mujoco.mjtGeom.mjGEOM_SPHERE, dimensions.ring
    base.add_geom(
        name="hull", type=sphere, size=(dimensions.radius, 0, 0), pos=(0, 0, ring.height), mass=0.0,
        contype=HULL_MASK, conaffinity=HULL_MASK, condim=3, priority=1,
        friction=(BUMPER_FRICTION, 0, 0), rgba=(0, 0, 0, 0), group=3, userdata=DARK, **BUMPER,
    )  # fmt: skip
    gear = {
        "contype": 0,
        "conaffinity": FLOOR_MASK,
        "priority": 1,
        "userdata": DARK,
    }
    for name, x, z in (
        ("front_caster", dimensions.caster_x, 0.0),
        ("rear_caster", -dimensions.caster_x, dimensions.rear_clearance),
    ):
        base.add_geom(
            name=name, type=sphere, size=(dimensions.caster_radius, 0, 0), pos=(x, 0, z + dimensions.caster_radius),
            mass=0.0, condim=1, rgba=(0.2, 0.2, 0.2, 1), margin=dimensions.caster_margin, **gear, **CASTER,
        )  # fmt: skip
    for name, side in (("left", 1.0), ("right", -1.0)):
        _add_wheel(robot, base, dimensions, name, side * dimensions.gear.axle_track / 2, gear)
        zone = bumpers.zone(ring, side)
        base.add_site(
            name=f"bumper_{name}", type=mujoco.mjtGeom.mjGEOM_BOX, group=4, size=zone.half_lengths, pos=zone.centre
        )
    base.add_site(name="laser", pos=dimensions.laser, size=(0.005, 0.005, 0.005))
    return robot


def _add_part(base: mujoco.MjsBody, part: Part) -> None:
    box = len(part.size) == 3
    size = [length / 2 for length in part.size] if box else [part.size[0], part.size[1] / 2, 0.0]
    base.add_geom(
        name=part.name, type=mujoco.mjtGeom.mjGEOM_BOX if box else mujoco.mjtGeom.mjGEOM_CYLINDER, size=size,
        pos=part.position, mass=part.mass, contype=0, conaffinity=0, rgba=part.rgba, userdata=part.reflectance,
    )  # fmt: skip


def _add_wheel(
    robot: mujoco.MjSpec, base: mujoco.MjsBody, dimensions: Dimensions, name: str, y: float, gear: dict[str, Any]
) -> None:
    radius = dimensions.gear.wheel_radius
    wheel = base.add_body(name=name, pos=(0, y, radius))
    wheel.add_joint(name=name, axis=(0, 1, 0), armature=ROTOR_INERTIA)
    wheel.add_geom(
        name=f"{name}_rim", type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=(radius, dimensions.wheel_width / 2, 0),
        quat=(math.sqrt(0.5), math.sqrt(0.5), 0, 0), mass=dimensions.wheel_mass, contype=0, conaffinity=0,
        rgba=(0.1, 0.1, 0.1, 1), userdata=DARK,
    )  # fmt: skip
    wheel.add_geom(
        name=f"{name}_tyre", type=mujoco.mjtGeom.mjGEOM_SPHERE, size=(radius, 0, 0), mass=0.0, condim=3,
        friction=(TYRE_FRICTION, 0, 0), rgba=(0, 0, 0, 0), group=3, margin=dimensions.tyre_margin, **gear, **TYRE,
    )  # fmt: skip
    servo = robot.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    servo.set_to_velocity(kv=WHEEL_SERVO_GAIN)
    servo.forcelimited = True
    servo.forcerange = (-dimensions.max_wheel_torque, dimensions.max_wheel_torque)
