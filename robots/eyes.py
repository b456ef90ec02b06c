"""What a robot with eyes carries, whatever its base: two offset cameras and the orange cone (Kirchner 2006, 3.1).

The heights are one choice for all bodies with eyes, so that herds can be mixed. The cameras look level, and the cone's
base, its widest part, stands as high as their lenses: it lies on the horizon of every level camera, in the image's
middle row, from the nearest to the farthest distance. Its flank is seen above that row, and its underside never.
Housings end `HOUSING_ABOVE` over the lens, so that a robot's own cameras hide no more of its cone's base from others.

Grades of the constants as in `robots.create.model`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import mujoco

CAMERAS = ("camera_left", "camera_right")
"""Names of the cameras, and of the sites that look along their x axis the same way."""

YAW = math.radians(47.5)  # of either camera off the robot's nose; P: Kirchner 2006, section 3.1
RESOLUTION = (640, 480)  # pixels; P: Kirchner 2006, section 3.1
WIDE = math.radians(125.0)  # rad that a camera sees horizontally; P: Kirchner 2006, section 3.1
TALL = 2.0 * math.atan(math.tan(WIDE / 2.0) * 0.75)  # rad, vertically, of a pinhole image of 640 x 480: 110.472 deg; D
LENS_HEIGHT = 0.305  # m above the floor, of lenses and cone's base; ?: a housing's height above the Pioneer's deck
HOUSING = (0.03, 0.03, 0.033)  # m, x y z; ?
HOUSING_ABOVE = 0.005  # m of the housing over the lens; ?
HOUSING_MASS = 0.07  # kg of one camera; ?
LENS_AHEAD = 0.002  # m of the lens before its housing's face, along the view; ?
CONE_RADIUS = 2 * 0.0254  # m at the base; P: Kirchner 2006, section 3.6.6
CONE_HEIGHT = 6 * 0.0254  # m; ?: the common small size (the thesis gives none)
CONE_MASS = 0.1  # kg; ?
CONE_EDGES = 64  # of the base; D: its outline is within 0.06 mm of a circle
CONE_RGBA = (1.0, 0.25, 0.0, 1.0)  # ?: inside the thesis's hue and saturation (5 to 20 degrees, above 0.8)
CONE_REFLECTANCE = (0.6, 0.0)  # light plastic, for lasers; ?
PLINTH_RADIUS = 0.03  # m of what the cone stands on; ?
PLINTH_MASS = 0.05  # kg; ?
BLACK = (0.1, 0.0)  # reflectance of housings and plinth; ?


class Eyes(NamedTuple):
    """Where cameras and cone stand on a robot, m in its frame."""

    camera_x: float
    """Of both housings' centres."""
    camera_y: float
    """Of the left housing's centre; the right one's is at minus that."""
    cone_x: float
    """Of the cone's axis, which stands over the middle line."""
    deck: float
    """Height of what the housings and the cone's plinth stand on."""


def add(robot: mujoco.MjSpec, base: mujoco.MjsBody, eyes: Eyes) -> None:
    """Fastens the cameras `CAMERAS`, their sites and the geom `cone` to `base`."""
    for name, side in zip(CAMERAS, (1.0, -1.0), strict=True):
        _add_camera(base, eyes, name, side)
    plinth = LENS_HEIGHT - eyes.deck
    seen = {"contype": 0, "conaffinity": 0}
    base.add_geom(
        name="plinth", type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=(PLINTH_RADIUS, plinth / 2, 0),
        pos=(eyes.cone_x, 0, eyes.deck + plinth / 2), mass=PLINTH_MASS, rgba=(0.2, 0.2, 0.2, 1), userdata=BLACK, **seen,
    )  # fmt: skip
    paint = robot.add_material(name="cone", rgba=CONE_RGBA, specular=0.0, shininess=0.0)
    mesh = robot.add_mesh(name="cone", scale=(CONE_RADIUS, CONE_RADIUS, CONE_HEIGHT / 2))
    mesh.make_cone(nedge=CONE_EDGES, radius=0.0)  # a unit cone from z = −1 to 1, which ends in a point
    base.add_geom(
        name="cone", type=mujoco.mjtGeom.mjGEOM_MESH, meshname=mesh.name, material=paint.name, rgba=CONE_RGBA,
        pos=(eyes.cone_x, 0, LENS_HEIGHT + CONE_HEIGHT / 2), mass=CONE_MASS, userdata=CONE_REFLECTANCE, **seen,
    )  # fmt: skip


def _add_camera(base: mujoco.MjsBody, eyes: Eyes, name: str, side: float) -> None:
    yaw = side * YAW
    turned = (math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2))
    ahead = HOUSING[0] / 2 + LENS_AHEAD
    x, y = eyes.camera_x, side * eyes.camera_y
    lens = (x + ahead * math.cos(yaw), y + ahead * math.sin(yaw), LENS_HEIGHT)
    base.add_geom(
        name=f"{name}_housing", type=mujoco.mjtGeom.mjGEOM_BOX, size=[length / 2 for length in HOUSING], quat=turned,
        pos=(x, y, LENS_HEIGHT + HOUSING_ABOVE - HOUSING[2] / 2), mass=HOUSING_MASS, rgba=(0.15, 0.15, 0.15, 1),
        userdata=BLACK, contype=0, conaffinity=0,
    )  # fmt: skip
    base.add_site(name=name, pos=lens, quat=turned, size=(0.005, 0.005, 0.005))
    camera = base.add_camera(name=name, pos=lens, fovy=math.degrees(TALL), resolution=RESOLUTION)
    camera.quat = looking(yaw)


def looking(yaw: float) -> tuple[float, float, float, float]:
    """The orientation (w, x, y, z) of a level camera that looks along `yaw` (rad): −z ahead, x to its right, y up.

    That is a turn by 90 degrees about x, which lifts the view from straight down to ahead along y, and then one about
    the upright by yaw − 90 degrees.
    """
    half = (yaw - math.pi / 2) / 2
    c, s, root = math.cos(half), math.sin(half), math.sqrt(0.5)
    return (c * root, c * root, s * root, s * root)
