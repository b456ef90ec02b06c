"""Where the free space of an environment is: how far places are from walls, and which of them walls keep apart."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
import shapely

from flocking.types import Bools, Floats, Ints
from generation.environment import Environment
from generation.primitives import OUTSIDE, Circle, Polygon, is_fence, places

_AT_A_TIME = 1_000_000
"""Distances of points from pieces that are held at a time."""


def clearance(faces: Floats, points: Floats) -> Floats:
    """(N,) distance (m) of points (N, 2) from the nearest of the faces (K, 4): negative behind it, inf without any.

    Behind is on the right of a face, seen from its start to its end. Where two are equally near, as at a corner, a
    point is behind only if it is behind both.
    """
    found = np.full(len(points), math.inf)
    if len(faces) == 0:
        return found
    step = max(1, _AT_A_TIME // len(faces))
    for first in range(0, len(points), step):
        distances, sides = _apart(faces, points[first : first + step])
        nearest = distances.min(axis=1, keepdims=True)
        tied = distances - nearest <= 1e-9 * np.maximum(distances, 1.0)
        signed = np.where(sides >= 0.0, distances, -distances)
        found[first : first + step] = np.where(tied, signed, -math.inf).max(axis=1)
    return found


def in_solid(environment: Environment, points: Floats) -> Bools:
    """(N,) whether points (N, 2) lie inside of a solid: the smallest closed shape about a point has no space inside.

    So a room may lie within a solid, as a building's rooms within its outline, and pillars within a room.
    """
    found = np.zeros(len(points), dtype=np.bool_)
    closed = [each for each in environment.primitives if isinstance(each, Polygon | Circle) and not is_fence(each)]
    if not any(each.free == OUTSIDE for each in closed):
        return found
    shapes = [(shapely.Polygon(places(each)), each.free == OUTSIDE) for each in closed]
    spots, left = shapely.points(points), np.ones(len(points), dtype=np.bool_)
    for shape, solid in sorted(shapes, key=lambda one: float(one[0].area)):
        shapely.prepare(shape)
        inside = left & shapely.contains_properly(shape, spots)
        found |= inside & solid
        left &= ~inside
    return found


def distance(walls: Floats, points: Floats) -> Floats:
    """(N,) distance (m) of points (N, 2) from the nearest of the walls (K, 4), on whichever side; inf without any."""
    found = np.full(len(points), math.inf)
    step = max(1, _AT_A_TIME // max(1, len(walls)))
    for first in range(0, len(points) if len(walls) else 0, step):
        found[first : first + step] = _apart(walls, points[first : first + step])[0].min(axis=1)
    return found


def _apart(walls: Floats, points: Floats) -> tuple[Floats, Floats]:
    """(N, K) distances of points from walls, and on which side of each they are: positive on its left."""
    along = walls[:, 2:] - walls[:, :2]
    offsets = points[:, None] - walls[:, :2]
    share = np.clip((offsets * along).sum(axis=2) / (along * along).sum(axis=1), 0.0, 1.0)
    to_points = offsets - share[..., None] * along
    sides = along[:, 0] * offsets[..., 1] - along[:, 1] * offsets[..., 0]
    return np.hypot(to_points[..., 0], to_points[..., 1]), sides


def crossed(walls: Floats, start: Floats, points: Floats) -> Bools:
    """(N,) whether the straight way from a place (2,) to each of the points (N, 2) meets any of the walls (K, 4)."""
    found = np.zeros(len(points), dtype=np.bool_)
    if len(walls) == 0:
        return found
    along, offset = walls[:, 2:] - walls[:, :2], walls[:, :2] - start
    step = max(1, _AT_A_TIME // len(walls))
    for first in range(0, len(points), step):
        way = points[first : first + step, None] - start
        cross = way[..., 0] * along[:, 1] - way[..., 1] * along[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):  # parallel: never met, or touched along its length
            part = (offset[:, 0] * along[:, 1] - offset[:, 1] * along[:, 0]) / cross
            share = (offset[:, 0] * way[..., 1] - offset[:, 1] * way[..., 0]) / cross
        met = (part >= 0.0) & (part <= 1.0) & (share >= 0.0) & (share <= 1.0)
        found[first : first + step] = met.any(axis=1)
    return found


def reached(walls: Floats, start: Floats, points: Floats, radius_m: float = 0.0) -> Bools:
    """(N,) whether a disc of that radius can get from a place (2,) to each of the points (N, 2), around walls (K, 4).

    Where the place itself is nearer to a wall than the radius, a point must do.
    """
    radius = radius_m if distance(walls, start[None])[0] > radius_m else 0.0
    found = ~crossed(walls, start, points)
    if radius > 0.0:
        found &= _beside(walls, start, points) >= radius
    if found.all():
        return found
    regions = _regions(walls.tobytes(), radius)
    found[~found] = _region_of(regions, points[~found]) == _region_of(regions, start[None])[0]
    return found


def _beside(walls: Floats, start: Floats, points: Floats) -> Floats:
    """(N,) how near the straight ways from a place (2,) to points (N, 2) pass by the ends of walls (K, 4), m."""
    ways = np.hstack([np.broadcast_to(start, points.shape), points])
    ends, found = walls.reshape(-1, 2), np.full(len(points), math.inf)
    moving = (ways[:, :2] != ways[:, 2:]).any(axis=1)
    if not len(ends) or not moving.any():
        return found
    step, nearest = max(1, _AT_A_TIME // len(points)), np.full(int(moving.sum()), math.inf)
    for first in range(0, len(ends), step):
        nearest = np.minimum(nearest, _apart(ways[moving], ends[first : first + step])[0].min(axis=0))
    found[moving] = nearest
    return found


@lru_cache(maxsize=8)
def _regions(walls: bytes, radius: float) -> list[shapely.Polygon]:
    """What walls (K, 4) enclose, from small to large; what is in none of them is the open plane."""
    lines = shapely.linestrings(np.frombuffer(walls).reshape(-1, 2, 2))
    if radius > 0.0:
        blocked = shapely.union_all(shapely.buffer(lines, radius * (1.0 - 1e-6)))
        parts = shapely.get_parts(blocked)
        rings = [shapely.Polygon(ring) for part in parts for ring in part.interiors]
    else:
        rings = list(shapely.get_parts(shapely.polygonize([shapely.union_all(lines)])))
        rings = [shapely.Polygon(ring.exterior) for ring in rings]
    return sorted(rings, key=lambda ring: float(ring.area))


def _region_of(regions: list[shapely.Polygon], points: Floats) -> Ints:
    """(N,) number of the smallest region that each point is in; −1 = none."""
    found = np.full(len(points), -1, dtype=np.int64)
    spots = shapely.points(points)
    for number, region in enumerate(regions):
        left = found < 0
        if left.any():
            found[left & shapely.contains(region, spots)] = number
    return found
