"""Walls: segments compiled into MJCF boxes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import mujoco
import numpy as np

from flocking.errors import InputError
from flocking.types import Bools, Floats
from robots import physics

HEIGHT = 0.5
"""m; above the laser's plane. A choice."""
THICKNESS = 0.1
"""m; a wall's box lies to the right of its segment, seen from start to end. A choice."""
_SAME = 1e-3
"""m within which two places are one. A choice."""
_THINNEST = 2.5e-3
"""m, of a wall's box at the least: walls at a corner of a solid that is sharper than 68 degrees have less. A choice."""


class Walls(NamedTuple):
    """What a world is fenced by."""

    segments: Floats
    """(K, 4) inner faces x0, y0, x1, y1, m; free space lies on the left of each."""
    reflectance: float
    """Diffuse albedo, 0 to 1."""


def closed(corners: Sequence[tuple[float, float]]) -> Floats:
    """Segments (K, 4) of the closed polygon with these corners; free space lies on their left.

    Counter-clockwise corners enclose free space, as a room's; clockwise ones a solid, as a pillar's.
    """
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


def inside(segments: Floats, points: Floats) -> Bools:
    """(N,) whether points (N, 2) lie inside a solid: a polygon of segments (K, 4) that is given clockwise."""
    found = np.zeros(len(points), dtype=np.bool_)
    for ring in _rings(segments):
        (x0, y0), (x1, y1) = ring[:, :2].T, ring[:, 2:].T
        if np.sum(x0 * y1 - x1 * y0) >= 0.0:
            continue
        for n, (x, y) in enumerate(points):
            crosses = (y0 > y) != (y1 > y)
            at = x0[crosses] + (y - y0[crosses]) / (y1[crosses] - y0[crosses]) * (x1[crosses] - x0[crosses])
            found[n] |= np.count_nonzero(at > x) % 2 == 1
    return found


def add_walls(spec: mujoco.MjSpec, walls: Walls) -> None:
    """Adds one box for each segment, whose face lies on the segment; nothing of it stands in front of any segment.

    Where a wall turns to the left, as in a room's corners, its box reaches one thickness past the end of the segment,
    so that the corner is tight. A box is thinner where something lies behind its segment within a thickness, such as
    the other side of a thin partition. Raises `InputError` where no box has room.
    """
    for number, (x0, y0, x1, y1) in enumerate(walls.segments):
        before, past, depth = _room_behind(walls.segments, number)
        direction = math.atan2(y1 - y0, x1 - x0)
        c, s, half, shift = math.cos(direction), math.sin(direction), depth / 2, (past - before) / 2
        spec.worldbody.add_geom(
            name=f"wall-{number + 1}",
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=[math.hypot(x1 - x0, y1 - y0) / 2 + (before + past) / 2, half, HEIGHT / 2],
            pos=[(x0 + x1) / 2 + shift * c + half * s, (y0 + y1) / 2 + shift * s - half * c, HEIGHT / 2],
            quat=[math.cos(direction / 2), 0.0, 0.0, math.sin(direction / 2)],
            contype=physics.HULL_MASK,
            conaffinity=physics.HULL_MASK,
            userdata=[walls.reflectance, 0.0],
            rgba=[0.75, 0.75, 0.72, 1.0],
        )


def _room_behind(segments: Floats, k: int) -> tuple[float, float, float]:
    """How far the box of segment k reaches before its start and past its end, and how deep it is, m."""
    x0, y0, x1, y1 = segments[k]
    length = math.hypot(x1 - x0, y1 - y0)
    if length < _SAME:
        raise InputError(f"wall {k + 1} at ({x0:g}, {y0:g}) m has no length: expected two places")
    c, s = (x1 - x0) / length, (y1 - y0) / length
    others = np.delete(segments, k, axis=0).reshape(-1, 2, 2) - (x0, y0)
    along, behind = others @ (c, s), others @ (s, -c)
    comes = np.hypot(along[:, 1], behind[:, 1]) < _SAME  # ends where this one starts
    goes = np.hypot(along[:, 0] - length, behind[:, 0]) < _SAME
    before = THICKNESS if np.any(behind[comes, 0] < -_SAME) else 0.0
    past = THICKNESS if np.any(behind[goes, 1] < -_SAME) else 0.0
    depth = THICKNESS
    for (a0, a1), (b0, b1) in zip(along, behind, strict=True):
        # the part of the other segment between this one's ends, as shares of its length
        span = a1 - a0
        low, high = -before + _SAME, length + past - _SAME
        if abs(span) < _SAME:
            first, last = (0.0, 1.0) if low < a0 < high else (1.0, 0.0)
        else:
            ends = sorted(((low - a0) / span, (high - a0) / span))
            first, last = max(0.0, ends[0]), min(1.0, ends[1])
        if first < last:
            depths = b0 + first * (b1 - b0), b0 + last * (b1 - b0)
            if max(depths) > _SAME:
                depth = min(depth, max(min(depths), 0.0))
    if depth < _THINNEST:
        raise InputError(
            f"wall {k + 1} from ({x0:g}, {y0:g}) to ({x1:g}, {y1:g}) m has no room behind its face: expected walls "
            "that do not cross, and solids without corners sharper than 68 degrees"
        )
    return before, past, depth


def _rings(segments: Floats) -> list[Floats]:
    """The closed polygons (C, 4) among segments (K, 4): each begins where the one before it ends."""
    left, rings = list(range(len(segments))), []
    while left:
        ring = [left.pop(0)]
        while True:
            end = segments[ring[-1], 2:]
            if np.hypot(*(end - segments[ring[0], :2])) < _SAME:
                rings.append(segments[ring])
                break
            following = [k for k in left if np.hypot(*(segments[k, :2] - end)) < _SAME]
            if not following:
                break
            ring.append(following[0])
            left.remove(following[0])
    return rings
