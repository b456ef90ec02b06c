"""A smaller, slower Create, as a MuJoCo model: the same machine and code, other numbers.

No such machine was built; it is there for herds of two kinds. Grades of the constants as in `robots.create.model`. The
ring stands as high as the Create's, so that the two meet at their equators, and so does the laser's plane: all lasers
of a world scan one plane.
"""

from __future__ import annotations

from robots.create import bumpers
from robots.create.drive import Gear
from robots.create.model import (
    BUMPER_HEIGHT,
    DARK,
    LASER_MASS,
    LASER_SIZE,
    LASER_WINDOW,
    PLASTIC,
    SHEETING,
    Dimensions,
    Part,
)

# Base ---------------------------------------------------------------------------------------------
DIAMETER = 0.24  # m; ?
RADIUS = DIAMETER / 2  # D
AXLE_TRACK = 0.19  # m between the wheels' contact points; ?
WHEEL_RADIUS = 0.025  # m; ?
WHEEL_WIDTH = 0.018  # m; ?
CASTER_X = 0.095  # m, one before and one behind; ?
REAR_CLEARANCE = 0.0005  # m of the rear caster at rest: it only catches; ?
CASTER_RADIUS = 0.012  # m; ?
GROUND_CLEARANCE = 0.01  # m; ?
DECK_HEIGHT = 0.055  # m, top of the base; ?
BUMPER_OVERLAP = 0.025  # m either side of the middle where both bits are set; ?: about 12 degrees
BASE_MASS = 1.3  # kg with battery and wheels; ?: as the Create's by its volume
WHEEL_MASS = 0.06  # kg, the turning part of one wheel; ?
BATTERY_MASS = 0.25  # kg of the base's mass; ?
BATTERY_X = 0.022  # m before the axle; ?

# Payload ------------------------------------------------------------------------------------------
COMPUTER_MASS = 0.5  # kg; ?
COMPUTER_SIZE = (0.11, 0.11, 0.045)  # m, x y z; ?: a small desktop computer
COMPUTER_X = 0.015  # m before the axle; ?
LASER_HEIGHT = DECK_HEIGHT + COMPUTER_SIZE[2] + LASER_WINDOW  # D: the laser stands on the computer on the deck
LASER_X = 0.0  # m, before the axle; ?: over the robot's centre, so that bearings are the body's
SILHOUETTE_RADIUS = RADIUS  # m of the reflective cylinder; ?
SILHOUETTE_HEIGHT = 0.13  # m; ?: the laser's plane in its upper half
SILHOUETTE_MASS = 0.04  # kg; ?: about 0.1 m² of cardboard at 0.4 kg/m²

# Drive --------------------------------------------------------------------------------------------
MAX_SPEED = 0.3  # m/s of each wheel; ?
MAX_WHEEL_ACCELERATION = 0.9  # m/s² at the rim; ?: as the Create's
MAX_WHEEL_TORQUE = 0.18  # N m; ?: a little more than the tyre's grip

# How far tyres and caster sink in under their loads -----------------------------------------------
TYRE_MARGIN = 3.13363e-3  # m; D
CASTER_MARGIN = 2.686e-5  # m; D

CHASSIS_HEIGHT = DECK_HEIGHT - GROUND_CLEARANCE  # D
COMPUTER_TOP = DECK_HEIGHT + COMPUTER_SIZE[2]  # D
PARTS = (
    Part(
        "chassis",
        (RADIUS, CHASSIS_HEIGHT),
        (0.0, 0.0, GROUND_CLEARANCE + CHASSIS_HEIGHT / 2),
        BASE_MASS - BATTERY_MASS - 2 * WHEEL_MASS,
        PLASTIC,
        (0.78, 0.84, 0.9, 1.0),
    ),
    Part("battery", (0.08, 0.09, 0.03), (BATTERY_X, 0.0, 0.03), BATTERY_MASS, DARK, (0.2, 0.2, 0.2, 1.0)),
    Part(
        "computer",
        COMPUTER_SIZE,
        (COMPUTER_X, 0.0, DECK_HEIGHT + COMPUTER_SIZE[2] / 2),
        COMPUTER_MASS,
        DARK,
        (0.1, 0.1, 0.12, 1.0),
    ),
    Part(
        "hokuyo",
        LASER_SIZE,
        (LASER_X, 0.0, COMPUTER_TOP + LASER_SIZE[2] / 2),
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
        (0.24, 0.62, 0.86, 1.0),
    ),
)

DIMENSIONS = Dimensions(
    name="create-small",
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
