"""The Pioneer P2-AT8 as a MuJoCo model: what Kirchner's robots were (sections 3.1 and 3.3).

Grades of the constants: P a primary document says so; C read in published code; S a secondary page; D derived; ? not
found, a choice of ours. The frame's origin stands on the floor midway between the four wheels, x forward, z up.

It steers by skidding. Each wheel rolls on a sphere that touches the floor at one point, with Coulomb friction the same
in all directions. Nothing here says how far it turns when its sides run at different speeds: that comes out of the four
contacts. The track that the firmware believes in, `CONFIGURED_TRACK`, turns commands into wheel speeds and wheel
angles into odometry, and touches no contact.

The outline meets walls and other robots through two invisible spheres one behind the other, as high as the Creates'
rings: a stadium of 626 x 505 mm, whose sides are dented by 7 mm midway.
"""

from __future__ import annotations

import math

import mujoco

from robots import eyes
from robots.create.drive import Gear
from robots.create.model import BUMPER_HEIGHT, DARK, PLASTIC, TYRE
from robots.physics import FLOOR_MASK, HULL_MASK

# Outline ------------------------------------------------------------------------------------------
LENGTH = 0.626  # m; C: ARIA's parameters of the p2at8 (RobotLength)
WIDTH = 0.505  # m; C: ARIA's parameters of the p2at8 (RobotWidth)
HULL_RADIUS = WIDTH / 2  # m of either sphere; D
HULL_X = LENGTH / 2 - HULL_RADIUS  # m of the front sphere's centre, the rear one is as far behind; D
RADIUS = HULL_X + HULL_RADIUS  # m; D
HULL_FRICTION = 0.3  # plastic on paint; ?: as the Create's bumper
BUMPER_OVERLAP = 0.05  # m either side of the middle where both bits are set; ?: the middle one of five segments
BUMPER_TRAVEL = 0.008  # m before the outline where contact begins; ?: what it drives in one step at its top speed

# Wheels -------------------------------------------------------------------------------------------
WHEEL_RADIUS = 0.11  # m; C: Webots' Pioneer 3-AT
WHEEL_X = 0.133  # m before and behind the middle; C: Webots' Pioneer 3-AT
WHEEL_Y = 0.197  # m to either side; C: Webots' Pioneer 3-AT (a track of 394 mm)
WHEEL_WIDTH = 0.08  # m; ?: what is seen of it
WHEEL_MASS = 0.8  # kg, the turning part of one wheel; ?
ROTOR_INERTIA = 0.01  # kg m² at each wheel's axis, of motor, gear and belt; ?
TYRE_FRICTION = 0.6  # rubber on a smooth floor; ?: as the Create's
TYRE_MARGIN = 1.6657e-3  # m that tyres sink in under their loads; D

# Masses and what is seen --------------------------------------------------------------------------
MACHINE_MASS = 12.0  # kg with batteries and wheels, without eyes; C: Webots' Pioneer 3-AT
BATTERY_MASS = 4.5  # kg of the machine's mass; ?
BATTERY_X = 4.4e-4  # m; D: with the eyes aboard all four wheels then bear the same load
BATTERY_SIZE = (0.20, 0.16, 0.10)  # m; ?
CLEARANCE = 0.055  # m under the chassis; ?
CHASSIS_SIZE = (0.50, 0.28, 0.165)  # m; ?: between the wheels
RING_SIZE = (0.48, 0.26, 0.05)  # m of the box that carries the sonars; D: as wide as they stand apart
DECK_HEIGHT = 0.277  # m, its top; C: Webots' Pioneer 3-AT (its height)
DECK_SIZE = (0.50, 0.38, 0.007)  # m; ?
DECK_MASS = 1.0  # kg of the machine's mass; ?
RING_MASS = 0.8  # kg of the machine's mass; ?
BUMPER_SIZE = (0.04, 0.36, 0.05)  # m of the strip in front, as behind, that is seen; ?
BUMPER_MASS = 0.3  # kg of each, of the machine's mass; ?
SONAR_HEIGHT = 0.245  # m; ?: the ring lies above the wheels and below the deck

# Eyes ---------------------------------------------------------------------------------------------
CAMERA_X, CAMERA_Y = 0.20, 0.05  # m, of the left housing's centre; ?: at the front end of the deck
CONE_X = -0.20  # m; P: "on the back end" of the lead robot (section 4.1); how far back is ?
EYES = eyes.Eyes(CAMERA_X, CAMERA_Y, CONE_X, DECK_HEIGHT)

# Drive --------------------------------------------------------------------------------------------
MAX_SPEED = 0.8  # m/s; P: Kirchner 2006, section 3.3
ACCELERATION = 0.3  # m/s² along its way; ?: the firmware has one for the speed and one for the turn rate
TURN_ACCELERATION = math.radians(100.0)  # rad/s²; ?
DIFF_CONV_FACTOR = 0.0034  # rad per mm of difference, times two; C: ARIA's parameters of the p2at8
CONFIGURED_TRACK = 2e-3 / DIFF_CONV_FACTOR  # m, 588 mm; D: what the firmware takes for the track when it turns
MAX_WHEEL_TORQUE = 3.0  # N m at each wheel; ?: a little more than a tyre's grip
WHEEL_SERVO_GAIN = 10.0  # N m s/rad; ?: follows within about 10 ms
CATCH_UP = 5.0  # 1/s; ?: with it a side whose wheels lag behind their way catches up, as the firmware's PID does
MOST_LAG = 0.1  # rad; ?: what a side has lost beyond that is lost

GEAR = Gear(CONFIGURED_TRACK, WHEEL_RADIUS, MAX_SPEED, ACCELERATION)

WHEELS = {
    "left_front": (WHEEL_X, WHEEL_Y),
    "left_rear": (-WHEEL_X, WHEEL_Y),
    "right_front": (WHEEL_X, -WHEEL_Y),
    "right_rear": (-WHEEL_X, -WHEEL_Y),
}
"""Bodies, joints and actuators of the wheels → x, y, m."""

CHASSIS_MASS = MACHINE_MASS - BATTERY_MASS - DECK_MASS - RING_MASS - 2 * BUMPER_MASS - 4 * WHEEL_MASS  # kg; D
GREY, RED, BLACK = (0.35, 0.36, 0.38, 1.0), (0.62, 0.1, 0.1, 1.0), (0.1, 0.1, 0.1, 1.0)
BUMPER_X = LENGTH / 2 - BUMPER_SIZE[0] / 2  # m; D
BOXES = (
    ("chassis", CHASSIS_SIZE, (0.0, 0.0, CLEARANCE + CHASSIS_SIZE[2] / 2), CHASSIS_MASS, PLASTIC, RED),
    ("battery", BATTERY_SIZE, (BATTERY_X, 0.0, CLEARANCE + BATTERY_SIZE[2] / 2), BATTERY_MASS, DARK, BLACK),
    ("ring", RING_SIZE, (0.0, 0.0, SONAR_HEIGHT), RING_MASS, PLASTIC, GREY),
    ("deck", DECK_SIZE, (0.0, 0.0, DECK_HEIGHT - DECK_SIZE[2] / 2), DECK_MASS, DARK, BLACK),
    ("front_bumper", BUMPER_SIZE, (BUMPER_X, 0.0, BUMPER_HEIGHT + 0.03), BUMPER_MASS, DARK, BLACK),
    ("rear_bumper", BUMPER_SIZE, (-BUMPER_X, 0.0, BUMPER_HEIGHT + 0.03), BUMPER_MASS, DARK, BLACK),
)
"""Name, size (m), centre (m), mass (kg), reflectance, rgba."""

BUMPER = {"solref": (0.02, 1.0), "solimp": (0.5, 0.95, BUMPER_TRAVEL, 0.5, 2.0), "margin": BUMPER_TRAVEL}
"""As the Create's (`robots.create.model`), with twice the travel: it is faster."""


def spec() -> mujoco.MjSpec:
    """One robot on the plane z = 0 at the origin, facing +x: no floor, no light, no solver options.

    Body `base` with the free joint `root`; bodies, joints and actuators of `WHEELS` (control: wheel speed, rad/s); the
    site `sonar` over the middle; cameras, sites and the cone of `robots.eyes`. To be attached to a world.
    """
    robot = mujoco.MjSpec()
    robot.modelname = "pioneer"
    base = robot.worldbody.add_body(name="base")
    base.add_freejoint(name="root")
    for name, size, centre, mass, reflectance, rgba in BOXES:
        base.add_geom(
            name=name, type=mujoco.mjtGeom.mjGEOM_BOX, size=[length / 2 for length in size], pos=centre, mass=mass,
            contype=0, conaffinity=0, rgba=rgba, userdata=reflectance,
        )  # fmt: skip
    for name, x in (("front_hull", HULL_X), ("rear_hull", -HULL_X)):
        base.add_geom(
            name=name, type=mujoco.mjtGeom.mjGEOM_SPHERE, size=(HULL_RADIUS, 0, 0), pos=(x, 0, BUMPER_HEIGHT), mass=0.0,
            contype=HULL_MASK, conaffinity=HULL_MASK, condim=3, priority=1, friction=(HULL_FRICTION, 0, 0),
            rgba=(0, 0, 0, 0), group=3, userdata=DARK, **BUMPER,
        )  # fmt: skip
    for name, (x, y) in WHEELS.items():
        _add_wheel(robot, base, name, x, y)
    base.add_site(name="sonar", pos=(0, 0, SONAR_HEIGHT), size=(0.005, 0.005, 0.005))
    eyes.add(robot, base, EYES)
    return robot


def _add_wheel(robot: mujoco.MjSpec, base: mujoco.MjsBody, name: str, x: float, y: float) -> None:
    wheel = base.add_body(name=name, pos=(x, y, WHEEL_RADIUS))
    wheel.add_joint(name=name, axis=(0, 1, 0), armature=ROTOR_INERTIA)
    wheel.add_geom(
        name=f"{name}_rim", type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=(WHEEL_RADIUS, WHEEL_WIDTH / 2, 0),
        quat=(math.sqrt(0.5), math.sqrt(0.5), 0, 0), mass=WHEEL_MASS, contype=0, conaffinity=0, rgba=BLACK,
        userdata=DARK,
    )  # fmt: skip
    wheel.add_geom(
        name=f"{name}_tyre", type=mujoco.mjtGeom.mjGEOM_SPHERE, size=(WHEEL_RADIUS, 0, 0), mass=0.0, condim=3,
        friction=(TYRE_FRICTION, 0, 0), rgba=(0, 0, 0, 0), group=3, margin=TYRE_MARGIN, contype=0,
        conaffinity=FLOOR_MASK, priority=1, userdata=DARK, **TYRE,
    )  # fmt: skip
    servo = robot.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    servo.set_to_velocity(kv=WHEEL_SERVO_GAIN)
    servo.forcelimited = True
    servo.forcerange = (-MAX_WHEEL_TORQUE, MAX_WHEEL_TORQUE)
