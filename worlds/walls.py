"""Walls: segments compiled into MJCF boxes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import mujoco
import numpy as np
from scipy.spatial import cKDTree

from flocking.errors import InputError
from flocking.types import Floats
from generation.environment import Environment
from robots import physics

HEIGHT = 0.5
"""m; above the laser's plane. A choice."""
THICKNESS = 0.1
"""m; a wall's box lies to the right of its segment, seen from start to end. A choice."""
FENCE = 0.02
"""m; of a fence, whose box lies about its line. A choice: a board."""
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
    fences: Floats = np.empty((0, 4))
    """(F, 4) middle lines x0, y0, x1, y1 of what has free space on both sides, m."""

    @property
    def all(self) -> Floats:
        """(K + F, 4) faces, then fences."""
        return np.concatenate([self.segments, self.fences]) if len(self.fences) else self.segments


def walls_of(environment: Environment) -> Walls:
    """What an environment is as boxes."""
    return Walls(environment.faces(), environment.reflectance, environment.fences())


def closed(corners: Sequence[tuple[float, float]]) -> Floats:
    """Segments (K, 4) of the closed polygon with these corners; free space lies on their left.

    Counter-clockwise corners enclose free space, as a room's; clockwise ones a solid, as a pillar's.
    """
    points = np.asarray(corners, dtype=np.float64)
    return np.ascontiguousarray(np.hstack([points, np.roll(points, -1, axis=0)]))


def add_walls(spec: mujoco.MjSpec, walls: Walls) -> None:
    """Adds one box for each segment, whose face lies on the segment; nothing of it stands in front of any segment.

    Where a wall turns to the left, as in a room's corners, its box reaches one thickness past the end of the segment,
    so that the corner is tight. A box is thinner where something lies behind its segment within a thickness, such as
    the other side of a thin partition. A fence is a thin box about its line; where it goes on in another piece, the
    boxes overlap. Raises `InputError` where no box has room.
    """
    for number, (x0, y0, x1, y1) in enumerate(walls.segments):
        before, past, depth = _room_behind(walls.segments, number)
        direction = math.atan2(y1 - y0, x1 - x0)
        c, s, half, shift = math.cos(direction), math.sin(direction), depth / 2, (past - before) / 2
        spec.worldbody.add_geom(
            name=f"wall-{number + 1}",
            size=[math.hypot(x1 - x0, y1 - y0) / 2 + (before + past) / 2, half, HEIGHT / 2],
            pos=[(x0 + x1) / 2 + shift * c + half * s, (y0 + y1) / 2 + shift * s - half * c, HEIGHT / 2],
            **box_like(direction, walls.reflectance),
        )
    for number, ((x0, y0, x1, y1), (before, past)) in enumerate(
        zip(walls.fences, fence_overlaps(walls.fences), strict=True)
    ):
        direction, length = math.atan2(y1 - y0, x1 - x0), math.hypot(x1 - x0, y1 - y0)
        if length < _SAME:
            raise InputError(f"fence {number + 1} at ({x0:g}, {y0:g}) m has no length: expected two places")
        c, s, shift = math.cos(direction), math.sin(direction), (past - before) / 2
        spec.worldbody.add_geom(
            name=f"fence-{number + 1}",
            size=[length / 2 + (before + past) / 2, FENCE / 2, HEIGHT / 2],
            pos=[(x0 + x1) / 2 + shift * c, (y0 + y1) / 2 + shift * s, HEIGHT / 2],
            **box_like(direction, walls.reflectance),
        )


def box_like(direction: float, reflectance: float) -> dict[str, Any]:
    """What the boxes of walls and fences have in common; `direction`: of their length, rad."""
    return {
        "type": mujoco.mjtGeom.mjGEOM_BOX,
        "quat": [math.cos(direction / 2), 0.0, 0.0, math.sin(direction / 2)],
        "contype": physics.HULL_MASK,
        "conaffinity": physics.HULL_MASK,
        "userdata": [reflectance, 0.0],
        "rgba": [0.75, 0.75, 0.72, 1.0],
    }


def fence_overlaps(fences: Floats) -> Floats:
    """(F, 2) how far the box of each fence (F, 4) reaches before its start and past its end, m.

    Where two meet, each reaches so far that the outer sides of the corner meet, at most half a thickness; a free end
    stays where it is.
    """
    if len(fences) == 0:
        return np.zeros((0, 2))
    ends, out = fences.reshape(-1, 2), np.repeat(fences[:, 2:] - fences[:, :2], 2, axis=0)
    out[::2] *= -1.0  # the direction in which each end leaves its fence
    out /= np.maximum(np.hypot(out[:, 0], out[:, 1]), _SAME)[:, None]
    found = np.zeros(len(ends))
    for a, b in cKDTree(ends).query_pairs(_SAME, output_type="ndarray"):
        if a // 2 != b // 2:
            straight = -float(out[a] @ out[b])  # cosine of the turn
            needed = math.sqrt(max(1.0 - straight, 0.0) / max(1.0 + straight, 1e-12))  # tangent of half of it
            found[[a, b]] = np.maximum(found[[a, b]], FENCE / 2 * min(needed, 1.0))
    return found.reshape(-1, 2)


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
    depth = _depth(along, behind, -before, length + past)
    if depth < _THINNEST:  # at a corner of thin walls a box that reaches as far would come out of the next one
        alone = _depth(along, behind, 0.0, length)
        for reach in (alone, 0.0):
            before, past = min(before, reach), min(past, reach)
            depth = _depth(along, behind, -before, length + past)
            if depth >= _THINNEST:
                break
    if depth < _THINNEST:
        raise InputError(
            f"wall {k + 1} from ({x0:g}, {y0:g}) to ({x1:g}, {y1:g}) m has no room behind its face: expected walls "
            "that do not cross, and solids without corners sharper than 68 degrees"
        )
    return before, past, depth


def _depth(along: Floats, behind: Floats, start: float, end: float) -> float:
    """How deep the box of a segment may be that reaches from `start` to `end`, m, with the others (K, 2) beside it."""
    depth = THICKNESS
    # the part of each other segment between these ends, as shares of its length
    (a0, a1), (b0, b1) = along.T, behind.T
    span = a1 - a0
    low, high = start + _SAME, end - _SAME
    across = np.abs(span) < _SAME
    over = np.where(across, 1.0, span)
    one, other = (low - a0) / over, (high - a0) / over
    between = (low < a0) & (a0 < high)
    first = np.where(across, np.where(between, 0.0, 1.0), np.maximum(0.0, np.minimum(one, other)))
    last = np.where(across, np.where(between, 1.0, 0.0), np.minimum(1.0, np.maximum(one, other)))
    at_first, at_last = b0 + first * (b1 - b0), b0 + last * (b1 - b0)
    behind_it = (first < last) & (np.maximum(at_first, at_last) > _SAME)
    if behind_it.any():
        depth = min(depth, max(float(np.minimum(at_first, at_last)[behind_it].min()), 0.0))
    return depth
