"""A Create with the eyes of Kirchner's robots, as a MuJoCo model: the Create's base and laptop, and on a mast above
them a shelf that carries two cameras in front and the orange cone over the robot's centre.

It carries no laser: a mesh cone is no prism, which the planar laser asks for of all that stands in its plane. Grades of
the constants as in `robots.create.model`.
"""

from __future__ import annotations

import mujoco

from robots import eyes
from robots.create import model as create
from robots.create.model import DARK, LAPTOP_TOP, PLASTIC, Dimensions, Part

SHELF_TOP = eyes.LENS_HEIGHT + eyes.HOUSING_ABOVE - eyes.HOUSING[2]  # m; D: the housings stand on it
SHELF_SIZE = (0.13, 0.005)  # m, radius and thickness; ?: within the outline
SHELF_MASS = 0.08  # kg; ?: plywood
MAST_RADIUS = 0.015  # m; ?
MAST_MASS = 0.06  # kg; ?: a wooden rod
MAST_HEIGHT = SHELF_TOP - SHELF_SIZE[1] - LAPTOP_TOP  # m; D
CAMERA_X, CAMERA_Y = 0.10, 0.03  # m, of the left housing's centre; ?: side by side at the front of the shelf
CONE_X = 0.0  # m; ?: over the centre, so that the bearing of a cone is the robot's
# How far tyres and caster sink in under their loads, with shelf, cameras and cone in place of laser and cylinder
TYRE_MARGIN = 2.57468e-3  # m; D
CASTER_MARGIN = 3.764e-5  # m; D

EYES = eyes.Eyes(CAMERA_X, CAMERA_Y, CONE_X, SHELF_TOP)

DIMENSIONS: Dimensions = create.DIMENSIONS._replace(
    name="create-with-cameras",
    silhouette_radius=eyes.CONE_RADIUS,  # what eyes see of it
    tyre_margin=TYRE_MARGIN,
    caster_margin=CASTER_MARGIN,
    parts=(
        *(part for part in create.PARTS if part.name not in {"hokuyo", "sheeting"}),
        Part(
            "mast",
            (MAST_RADIUS, MAST_HEIGHT),
            (0.0, 0.0, LAPTOP_TOP + MAST_HEIGHT / 2),
            MAST_MASS,
            DARK,
            (0.3, 0.3, 0.3, 1.0),
        ),
        Part(
            "shelf",
            SHELF_SIZE,
            (0.0, 0.0, SHELF_TOP - SHELF_SIZE[1] / 2),
            SHELF_MASS,
            PLASTIC,
            (0.6, 0.6, 0.62, 1.0),
        ),
    ),
)


def spec() -> mujoco.MjSpec:
    """As `robots.create.model.spec`, with the cameras and the cone of `robots.eyes` and without the site `laser`."""
    robot = create.spec(DIMENSIONS)
    robot.delete(robot.site("laser"))
    eyes.add(robot, robot.body("base"), EYES)
    return robot
