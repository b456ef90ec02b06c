"""What the cameras look at: a cone on a post, a board before a part of it, and posts of other colours."""

from __future__ import annotations

import math
from typing import NamedTuple

import mujoco
import numpy as np

from robots import body as bodies
from robots.eyes import CONE_EDGES, CONE_HEIGHT, CONE_RADIUS, CONE_RGBA, LENS_HEIGHT
from sensing.camera.lens import Lens
from sensing.camera.rendering import Cameras
from sensing.types import Picture
from trials.simulations.cones.fields import TrialFields

ROBOT, SHOWN = "eyes/", "shown/"
SHOWN_CONE = 1
"""Whose the cone's pixels are: the second of both."""
BOARD = (0.02, 0.4)
"""m: thickness and height of the board that hides a part of the cone. A choice."""
BEFORE_M = 0.03
"""How far before the cone's near side the board stands: a choice."""
POSTS = ((0.8, 0.05, 0.08), (0.98, 0.5, 0.45), (0.95, 0.85, 0.1), (0.4, 0.22, 0.1))
"""Red, salmon, yellow (as the papers of the thesis's figure 3.17) and brown. Choices."""
POST = (0.05, 0.45)
"""m: radius and height of posts. A choice."""
STREWN_M, STREWN_DEG = (0.8, 4.0), 110.0
"""Posts stand so far away, within so many degrees of straight ahead. A choice."""


class Place(NamedTuple):
    """Where the cone's axis stands, in the robot's frame, m."""

    x: float
    y: float


def lens_of(model: mujoco.MjModel, name: str) -> tuple[float, float]:
    """x and y of a camera of the robot that is alone in a model, m."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    x, y, _ = data.cam(name).xpos.tolist()
    return x, y


def axis_of(lens: tuple[float, float], distance_m: float, bearing_deg: float) -> Place:
    """Where a cone stands whose near side is so far from a lens, at that bearing."""
    bearing, away = math.radians(bearing_deg), distance_m + CONE_RADIUS
    return Place(lens[0] + away * math.cos(bearing), lens[1] + away * math.sin(bearing))


class Scene:
    """The compiled scene with its cameras; the cone can be put elsewhere."""

    def __init__(self, body: str, lens: Lens, given: TrialFields, rng: np.random.Generator) -> None:
        """Raises `InputError` where nothing renders."""
        robot = bodies.load(body).spec()
        self.lens_xy = lens_of(robot.copy().compile(), "camera_left")
        spec = mujoco.MjSpec()
        spec.copy_during_attach = True
        spec.worldbody.add_light(pos=[0.0, 0.0, 6.0], dir=[0.0, 0.0, -1.0])
        spec.worldbody.add_geom(
            name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0.0, 0.0, 1.0], rgba=[0.92, 0.92, 0.9, 1.0]
        )
        spec.attach(robot, prefix=ROBOT, frame=spec.worldbody.add_frame())
        if given.cone:
            _add_cone(spec, given, axis_of(self.lens_xy, given.distance_m, given.bearing_deg), self.lens_xy)
        _add_posts(spec, given.distractors, rng)
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)
        self.cameras = Cameras(self.model, [ROBOT, SHOWN], [lens, None], given.light)

    def put(self, x_m: float, y_m: float) -> None:
        """Moves the cone, and the board before it, by that much from where it stands."""
        self.data.mocap_pos[:, :2] = (x_m, y_m)
        self.data.time += 1.0  # so that cameras look anew


def _add_cone(spec: mujoco.MjSpec, given: TrialFields, axis: Place, lens: tuple[float, float]) -> None:
    """The cone on a post, its base as high as the lenses, and the board: all on one body that can be put elsewhere."""
    shown = spec.worldbody.add_body(name=f"{SHOWN}root", mocap=True)
    mesh = spec.add_mesh(name="shown", scale=(CONE_RADIUS, CONE_RADIUS, CONE_HEIGHT / 2))
    mesh.make_cone(nedge=CONE_EDGES, radius=0.0)
    at = [axis.x, axis.y]
    shown.add_geom(
        name=f"{SHOWN}cone", type=mujoco.mjtGeom.mjGEOM_MESH, meshname=mesh.name, rgba=CONE_RGBA,
        pos=[*at, LENS_HEIGHT + CONE_HEIGHT / 2],
    )  # fmt: skip
    shown.add_geom(
        name=f"{SHOWN}post", type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=[CONE_RADIUS / 2, LENS_HEIGHT / 2, 0.0],
        pos=[*at, LENS_HEIGHT / 2], rgba=[0.2, 0.2, 0.2, 1.0],
    )  # fmt: skip
    if given.hidden <= 0.0:
        return
    bearing = math.radians(given.bearing_deg)
    ahead, aside = np.array([math.cos(bearing), math.sin(bearing)]), np.array([-math.sin(bearing), math.cos(bearing)])
    away = given.distance_m + CONE_RADIUS
    nearer = max(given.distance_m - BEFORE_M, 0.5 * given.distance_m)
    half = CONE_RADIUS * nearer / away  # the cone's half width, as it appears at the board
    # from the right to where so much of the width is hidden, and 4 half widths farther to the right
    edge = (2.0 * given.hidden - 1.0) * half
    middle = np.array(lens) + nearer * ahead + (edge - 2.5 * half) * aside
    shown.add_geom(
        name=f"{SHOWN}board", type=mujoco.mjtGeom.mjGEOM_BOX, size=[BOARD[0] / 2, 2.5 * half, BOARD[1] / 2],
        pos=[*middle, LENS_HEIGHT], quat=[math.cos(bearing / 2), 0.0, 0.0, math.sin(bearing / 2)],
        rgba=[0.55, 0.57, 0.6, 1.0],
    )  # fmt: skip


def _add_posts(spec: mujoco.MjSpec, count: int, rng: np.random.Generator) -> None:
    for k in range(count):
        away, bearing = rng.uniform(*STREWN_M), math.radians(rng.uniform(-STREWN_DEG, STREWN_DEG))
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=[POST[0], POST[1] / 2, 0.0],
            pos=[away * math.cos(bearing), away * math.sin(bearing), POST[1] / 2], rgba=[*POSTS[k % len(POSTS)], 1.0],
        )  # fmt: skip


def blurred_over(pictures: list[Picture]) -> Picture:
    """(H, W, 3) the mean of the pictures of one exposure."""
    return np.asarray(np.round(np.mean(pictures, axis=0)), np.uint8)
