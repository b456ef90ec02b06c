"""Images of cones drawn by geometry alone, and a robot's model with two cameras, without robots/ or a renderer."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import mujoco
import numpy as np

from sensing.camera.images import Images
from sensing.camera.lens import PINHOLE, Lens, column_angles, remap_tables

RADIUS, HEIGHT = 0.0508, 0.1524
ORANGE = (190, 47, 0)
"""As the cone is rendered at nominal light."""
GREY = (120, 120, 120)
YAW = math.radians(47.5)
MOUNTS = ((0.10, 0.03, YAW), (0.10, -0.03, -YAW))


class Cone(NamedTuple):
    """A cone whose base is on the horizon: x, y of its axis in the robot's body frame, m."""

    x: float
    y: float
    rgb: tuple[int, int, int] = ORANGE


class Bar(NamedTuple):
    """Something grey and upright between two bearings (rad) of the body frame that hides what is farther."""

    first: float
    last: float
    distance: float


def model_with_cameras(mounts: Sequence[tuple[float, float, float]] = MOUNTS, pitch: float = 0.0) -> mujoco.MjModel:
    """A robot that is two cameras, named as in the robots' models, off the world's origin and turned."""
    spec = mujoco.MjSpec()
    base = spec.worldbody.add_body(name="base", pos=(1.0, 2.0, 0.0), quat=(0.6, 0.0, 0.0, 0.8))
    base.add_freejoint()
    base.add_geom(size=[0.1, 0, 0])
    for name, (x, y, yaw) in zip(("camera_left", "camera_right"), mounts, strict=True):
        right = (math.sin(yaw), -math.cos(yaw), 0.0)
        up = (-math.cos(yaw) * math.sin(pitch), -math.sin(yaw) * math.sin(pitch), math.cos(pitch))
        axes = np.column_stack((right, up, np.cross(right, up)))  # a camera looks along its −z
        quat = np.empty(4)
        mujoco.mju_mat2Quat(quat, axes.ravel())
        base.add_camera(name=f"r0/{name}", pos=(x, y, 0.3), quat=quat)
    return spec.compile()


def pictures(
    things: Sequence[Cone | Bar],
    lens: Lens,
    mounts: Sequence[tuple[float, float, float]] = MOUNTS,
    time: float = 0.0,
) -> tuple[Images, np.ndarray]:
    """Both images, and which of the things each pixel shows: (2, H, W), −1 = none."""
    made, owners = zip(*(_picture(things, lens, mount) for mount in mounts), strict=True)
    return Images(time, *made), np.stack(owners)


def _picture(things: Sequence[Cone | Bar], lens: Lens, mount: tuple[float, float, float]) -> tuple[np.ndarray, ...]:
    rows = lens.height_px
    picture = np.full((rows, lens.width_px, 3), GREY, np.uint8)
    owners = np.full((rows, lens.width_px), -1)
    angles = column_angles(lens)
    tables = remap_tables(lens)
    focal = rows / 2.0 / math.tan(tables.fovy_rad / 2.0)
    assert lens.projection == PINHOLE or tables.map1 is not None

    def distance(thing: Cone | Bar) -> float:
        if isinstance(thing, Bar):
            return thing.distance
        return math.hypot(thing.x - mount[0], thing.y - mount[1])

    for number in sorted(range(len(things)), key=lambda n: -distance(things[n])):
        thing, far = things[number], distance(things[number])
        if isinstance(thing, Bar):
            seen = (thing.first <= angles + mount[2]) & (angles + mount[2] <= thing.last)
            picture[:, seen], owners[:, seen] = GREY, -1
            continue
        bearing = math.atan2(thing.y - mount[1], thing.x - mount[0]) - mount[2]
        off = np.abs((angles - bearing + math.pi) % (2 * math.pi) - math.pi)
        top = HEIGHT * (1.0 - far * np.sin(np.minimum(off, math.pi / 2)) / RADIUS)
        pixels = np.where(top > 0.0, focal * top / far / np.cos(angles), 0.0)
        for column in np.flatnonzero(pixels > 0.0):
            first = max(round(rows / 2 - pixels[column]), 0)
            first = min(first, rows // 2 - 1)
            picture[first : rows // 2, column] = thing.rgb
            owners[first : rows // 2, column] = number
    return picture, owners
