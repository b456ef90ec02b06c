"""Where a herd starts in an environment: about its marker `start`, in the free space, with no wall in between."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from flocking.errors import InputError
from flocking.types import Bools, Floats
from generation.environment import START, Environment
from generation.free_space import clearance, distance, in_solid, reached
from generation.primitives import Point

INSIDE_M = 0.1
"""How far behind a face a place counts as inside of its wall: `worlds.walls.THICKNESS`."""


def marker(environment: Environment) -> Point | None:
    """The place, with a heading, at which a herd starts; None where the environment has none: it is then the origin."""
    mark = environment.markers.get(START)
    return mark if isinstance(mark, Point) else None


def put_at_start(environment: Environment, poses: Floats) -> Floats:
    """Poses (N, 3) about the origin, looking along x, as they stand about the marker and look along it."""
    mark = marker(environment)
    if mark is None:
        return poses
    c, s = math.cos(mark.heading_rad), math.sin(mark.heading_rad)
    x, y = poses[:, 0], poses[:, 1]
    return np.stack([mark.x_m + c * x - s * y, mark.y_m + s * x + c * y, poses[:, 2] + mark.heading_rad], axis=1)


class Starting(NamedTuple):
    """Members at their start, N of them."""

    names: Sequence[str]
    poses_w: Floats
    """(N, 3)."""
    radii: Floats
    """(N,) m."""
    together: Bools
    """(N,) which of them stand in the formation about the world's start."""


def check_apart(herd: Starting) -> None:
    """Refuses members that overlap: `InputError`."""
    places, widest = herd.poses_w[:, :2], 2.0 * float(herd.radii.max(initial=0.0))
    for a, b in sorted(cKDTree(places).query_pairs(widest)) if widest > 0.0 else ():
        overlap = herd.radii[a] + herd.radii[b] - math.hypot(*(places[a] - places[b]))
        if overlap > 0.0:
            raise InputError(
                f"{herd.names[a]} and {herd.names[b]} overlap by {overlap:.2f} m at the start; "
                "expected formations that stand apart"
            )


def check(herd: Starting, environment: Environment, half_fence_m: float = 0.0) -> None:
    """Refuses members that start in a wall or nearer to it than their radius, or that walls keep apart: `InputError`.

    `half_fence_m`: half the thickness of a fence.
    """
    _check_walls(herd, environment, half_fence_m)
    if not herd.together.any():
        return
    mark, places = marker(environment), herd.poses_w[herd.together, :2]
    start = np.array([mark.x_m, mark.y_m]) if mark is not None else places[0]
    joined = reached(environment.walls(), start, places, float(herd.radii.min()) + half_fence_m)
    if not joined.all():
        apart = int(np.flatnonzero(herd.together)[(~joined).argmax()])
        raise InputError(
            f"{_told(herd, apart)}, and walls keep it apart from the herd's start at ({start[0]:.2f}, {start[1]:.2f}) "
            f"m; expected a formation that fits the free space there{_advice(environment, herd.together[apart])}"
        )


def _check_walls(herd: Starting, environment: Environment, half_fence_m: float) -> None:
    clear = clearance(environment.faces(), herd.poses_w[:, :2])
    beside = distance(environment.fences(), herd.poses_w[:, :2]) - half_fence_m
    solid = in_solid(environment, herd.poses_w[:, :2])
    clear = np.where(solid, -np.abs(clear), clear)
    nearest = int((np.minimum(clear, beside) - herd.radii).argmin())
    room, radius = min(clear[nearest], beside[nearest]), herd.radii[nearest]
    if room >= radius and not solid.any():
        return
    if clear[nearest] <= 0.0:
        where = "inside a wall" if solid[nearest] or clear[nearest] > -INSIDE_M else "behind a wall"
    elif beside[nearest] <= 0.0:
        where = "in a fence"
    else:
        kind = "wall" if clear[nearest] <= beside[nearest] else "fence"
        where = f"and reaches {radius - room:.2f} m into a {kind}"
    advice = _advice(environment, herd.together[nearest])
    raise InputError(f"{_told(herd, nearest)}, {where}; expected a start within the world{advice}")


def _told(herd: Starting, member: int) -> str:
    x, y = herd.poses_w[member, :2]
    return f"{herd.names[member]} starts at ({x:.2f}, {y:.2f}) m"


def _advice(environment: Environment, together: bool) -> str:
    """For an environment from a file, what would help a formation about its start."""
    if not together:
        return ""
    if marker(environment) is not None:
        return ", as by a smaller formation or a larger world.scale"
    return ", or a marker 'start' to put it at" if environment.markers or environment.origin else ""
