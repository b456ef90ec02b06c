"""Walls: segments compiled into MJCF boxes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import mujoco
import numpy as np

from flocking.types import Floats
from robots import physics

HEIGHT = 0.5
"""m; above the laser's plane. A choice."""
THICKNESS = 0.1
"""m; a wall's box lies to the right of its segment, seen from start to end. A choice."""


class Walls(NamedTuple):
    """What a world is fenced by."""

    segments: Floats
    """(K, 4) inner faces x0, y0, x1, y1, m; free space lies on the left of each."""
    reflectance: float
    """Diffuse albedo, 0 to 1."""


def closed(corners: Sequence[tuple[float, float]]) -> Floats:
    """Segments (K, 4) of the closed polygon with these corners, counter-clockwise: free space on the left."""
    points = np.asarray(corners, dtype=np.float64)
    return np.ascontiguousarray(np.hstack([points, np.roll(points, -1, axis=0)]))


def clearance(segments: Floats, points: Floats) -> Floats:
    """(N,) distance (m) of points (N, 2) from the nearest of the segments (K, 4): negative behind it, inf without any.

    Behind is on the right of a segment, seen from its start to its end. Where two are equally near, as at a corner, a
    point is behind only if it is behind both.
    """
    found = np.full(len(points), -math.inf)
    nearest = np.full(len(points), math.inf)
    for x0, y0, x1, y1 in segments:
        along, offset = np.array([x1 - x0, y1 - y0]), points - (x0, y0)
        share = np.clip(offset @ along / (along @ along), 0.0, 1.0)
        to_point = offset - share[:, None] * along
        distance = np.hypot(to_point[:, 0], to_point[:, 1])
        signed = np.where(along[0] * offset[:, 1] - along[1] * offset[:, 0] >= 0.0, distance, -distance)
        tied = np.abs(distance - nearest) <= 1e-9 * np.maximum(distance, 1.0)
        found = np.where(tied, np.maximum(found, signed), np.where(distance < nearest, signed, found))
        nearest = np.minimum(nearest, distance)
    return found if len(segments) else nearest


def add_walls(spec: mujoco.MjSpec, walls: Walls) -> None:
    """Adds one box for each segment, whose face lies on the segment.

    The boxes reach one thickness past both ends of the segment behind the face, so that corners are tight.
    """
    for number, (x0, y0, x1, y1) in enumerate(walls.segments):
        length = math.hypot(x1 - x0, y1 - y0)
        direction = math.atan2(y1 - y0, x1 - x0)
        half = THICKNESS / 2
        spec.worldbody.add_geom(
            name=f"wall-{number + 1}",
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=[length / 2 + THICKNESS, half, HEIGHT / 2],
            pos=[
                (x0 + x1) / 2 + half * math.sin(direction),
                (y0 + y1) / 2 - half * math.cos(direction),
                HEIGHT / 2,
            ],
            quat=[math.cos(direction / 2), 0.0, 0.0, math.sin(direction / 2)],
            contype=physics.HULL_MASK,
            conaffinity=physics.HULL_MASK,
            userdata=[walls.reflectance, 0.0],
            rgba=[0.75, 0.75, 0.72, 1.0],
        )
