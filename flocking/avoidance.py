"""Obstacles: their selection (stage 7), virtual members, and avoidance added to a law that has none.

Source: Fine 2015, section 3.6.1 with figure 3.3 (obstacle selection; the connection that makes virtual members);
Olfati-Saber 2006 for the virtual members. Metres, body frame.

The document leaves open how a law that avoids nothing is to avoid obstacles. The reading here, the same for every law:
an obstacle is the nearest point of a surface, and the half-plane beyond that point counts as blocked (right for a
wall, on the safe side for a convex body). A motion whose straight path would come within the margin of such a
half-plane inside the look-ahead distance is turned by the least angle that keeps it out; a motion that stands, turns
on the spot or leads away is left alone.

Two turns of equal size, one to each side, are not decided by a fixed side, so that mirrored worlds give mirrored
motions: the motion is then reversed, and a way-point drawn back to the margin.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from flocking.angles import wrap
from flocking.compilation import borrowing, compiled
from flocking.lanes import over
from flocking.parameters import Parameter
from flocking.types import ANONYMOUS, Bools, Floats, Kind, Members, Obstacles

ROUNDING = 1e-9
"""Differences of direction cosines below this are not differences."""
STEEPEST = 0.5
"""Sine of the angle at which a motion inside a margin is turned away from its wall, at most."""
LOOKS = 6
"""Look-ahead distances tried, each half the last: in a narrow place nothing is free for long."""
NOTHING, TURNED, NO_SIDE, NO_WAY = range(4)
DISTANCE, LIMIT = range(2)
"""Rows of what is known of each obstacle."""
STOP, WAY_POINT, VELOCITY, HEADING = (int(k) for k in (Kind.STOP, Kind.WAY_POINT, Kind.VELOCITY, Kind.HEADING))


class Parameters(NamedTuple):
    """Of the avoidance that all laws share."""

    look_ahead_m: Annotated[
        float, Parameter("m", "our choice: the Create's way in 3 s at a cruising speed of 0.25 m/s", low=0.0)
    ] = 0.75
    margin_m: Annotated[
        float, Parameter("m", "our choice: the Create's radius of 0.165 m and 0.115 m to spare", low=0.0)
    ] = 0.28
    virtual_range_m: Annotated[
        float, Parameter("m", "our choice: obstacles nearer than this become virtual members", low=0.0)
    ] = 1.0


def within(obstacles: Obstacles, range_m: float) -> Bools:
    """Mask (K,) of the obstacles nearer than `range_m`."""
    return np.hypot(obstacles.points[:, 0], obstacles.points[:, 1]) < range_m


def nearest(obstacles: Obstacles) -> Bools:
    """Mask (K,) of the nearest obstacle; of equally near ones the one with the smaller x, then y."""
    points = obstacles.points
    mask = np.zeros(len(points), dtype=np.bool_)
    mask[np.lexsort((points[:, 1], points[:, 0], np.hypot(points[:, 0], points[:, 1])))[:1]] = True
    return mask


def ahead(obstacles: Obstacles, width_rad: float = math.pi) -> Bools:
    """Mask (K,) of the obstacles in the sector of that width about straight ahead, its edges excluded."""
    return np.abs(np.arctan2(obstacles.points[:, 1], obstacles.points[:, 0])) < width_rad / 2.0


@compiled
def virtual_members(
    points: Floats,
    own_vx: float,
    own_vy: float,
    range_m: float,
    positions_out: Floats,
    velocities_out: Floats,
) -> int:
    """Writes a virtual member for each obstacle nearer than `range_m` and returns how many there are.

    Its position is the obstacle's nearest point, its velocity the own one projected on the surface's tangent there
    (the beta-agent of Olfati-Saber 2006 at a wall). An obstacle at distance 0 has no tangent and makes none; nor do
    obstacles for which `positions_out` and `velocities_out` (capacity, 2) have no room.
    """
    count = 0
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        distance = math.hypot(x, y)
        if count < len(positions_out) and 0.0 < distance < range_m:
            tangent_x, tangent_y = -y / distance, x / distance
            along = own_vx * tangent_x + own_vy * tangent_y
            positions_out[count, 0], positions_out[count, 1] = x, y
            velocities_out[count, 0], velocities_out[count, 1] = along * tangent_x, along * tangent_y
            count += 1
    return count


def with_virtual_members(members: Members, obstacles: Obstacles, own_velocity: Floats, range_m: float) -> Members:
    """`members` and after them the virtual ones: anonymous, each heading where it moves (nan if it stands)."""
    room = len(obstacles.points)
    positions, velocities = np.empty((room, 2)), np.empty((room, 2))
    count = virtual_members(
        obstacles.points, float(own_velocity[0]), float(own_velocity[1]), range_m, positions, velocities
    )
    positions, velocities = positions[:count], velocities[:count]
    headings = np.arctan2(velocities[:, 1], velocities[:, 0])
    headings[(velocities == 0.0).all(axis=1)] = np.nan
    return Members(
        np.concatenate((members.positions, positions)),
        np.concatenate((members.bearings, np.arctan2(positions[:, 1], positions[:, 0]))),
        np.concatenate((members.headings, headings)),
        np.concatenate((members.velocities, velocities)),
        np.concatenate((members.ids, np.full(count, ANONYMOUS, dtype=np.int64))),
    )


@compiled
def avoid(
    kind: int,
    x: float,
    y: float,
    own_vx: float,
    own_vy: float,
    dt: float,
    points: Floats,
    look_ahead_m: float,
    margin_m: float,
) -> tuple[int, float, float, bool]:
    """A motion (its kind and two numbers), turned where `points` (K, 2) stand in its way; whether it was.

    HOLD is judged by the own velocity and ACCELERATION by the velocity that it makes within `dt`; turned, both become
    a VELOCITY. VELOCITY and HEADING keep their speed. A WAY_POINT nearer than the look-ahead distance is looked ahead
    to only as far as it is; turned, its distance is that of its projection on the new direction. A motion faster than
    the look-ahead distance in `dt` is looked ahead for `dt`. Trapped on all sides: STOP.
    """
    room = np.empty((2, len(points)))
    return avoid_in(kind, x, y, own_vx, own_vy, dt, points, look_ahead_m, margin_m, room)


@borrowing
def avoid_in(
    kind: int,
    x: float,
    y: float,
    own_vx: float,
    own_vy: float,
    dt: float,
    points: Floats,
    look_ahead_m: float,
    margin_m: float,
    room: Floats,
) -> tuple[int, float, float, bool]:
    """What `avoid` does, which makes no arrays: it writes into `room` (2, K or more)."""
    if len(points) == 0 or kind == STOP:
        return kind, x, y, False
    vx, vy = x, y
    if kind == Kind.HOLD:
        vx, vy = own_vx, own_vy
    elif kind == Kind.ACCELERATION:
        vx, vy = own_vx + x * dt, own_vy + y * dt
    elif kind == HEADING:
        vx, vy = y * math.cos(x), y * math.sin(x)
    length = math.hypot(vx, vy)
    if not length > 0.0:
        return kind, x, y, False
    ex, ey = over(vx, vy, length)
    look = min(look_ahead_m, length) if kind == WAY_POINT else max(look_ahead_m, length * dt)
    for k in range(len(points)):
        room[DISTANCE, k] = math.hypot(points[k, 0], points[k, 1])
    outcome, tx, ty = turned(ex, ey, points, look, margin_m, room)
    if outcome == NOTHING:
        return kind, x, y, False
    if kind == WAY_POINT:
        kept = length * (ex * tx + ey * ty)
        if outcome != TURNED or kept <= 0.0:
            tx, ty = ex, ey
            kept = min(length, _free_way(ex, ey, points, margin_m))
        if kept <= 0.0:
            return STOP, math.nan, math.nan, True
        return WAY_POINT, kept * tx, kept * ty, True
    if outcome == NO_SIDE:
        tx, ty = -ex, -ey
        _set_limits(look, margin_m, False, len(points), room)
        if _direction_free(tx, ty, points, room):
            outcome = TURNED
    if outcome != TURNED:
        return STOP, math.nan, math.nan, True
    if kind == HEADING:
        backwards = math.pi if y < 0.0 else 0.0
        return HEADING, wrap(math.atan2(ty, tx) + backwards), y, True
    return VELOCITY, length * tx, length * ty, True


@borrowing
def turned(ex: float, ey: float, points: Floats, look: float, margin: float, room: Floats) -> tuple[int, float, float]:
    """The free direction nearest to the unit vector (ex, ey), and what was found.

    NOTHING in the way; TURNED; NO_SIDE: the nearest free directions to the left and to the right are equally near;
    NO_WAY: no direction is free at any look-ahead distance tried. `room` (2, K or more) has the distances of `points`
    (K, 2).
    """
    for trial in range(LOOKS):
        # leading away or along is open even inside a margin
        _set_limits(look, margin, False, len(points), room)
        if _direction_free(ex, ey, points, room):
            return NOTHING, ex, ey
        if trial == 0:
            _set_limits(look, margin, True, len(points), room)
        left_cos, left_x, left_y = -2.0, 0.0, 0.0
        right_cos, right_x, right_y = -2.0, 0.0, 0.0
        for k in range(len(points)):
            distance, limit = room[DISTANCE, k], room[LIMIT, k]
            if limit == math.inf:
                continue
            nx, ny = over(points[k, 0], points[k, 1], distance)
            across = math.sqrt(1.0 - limit * limit)
            for side in (1.0, -1.0):
                tx = limit * nx - side * across * ny
                ty = limit * ny + side * across * nx
                if not _direction_free(tx, ty, points, room):
                    continue
                cos = ex * tx + ey * ty
                if ex * ty - ey * tx >= 0.0:
                    if cos > left_cos:
                        left_cos, left_x, left_y = cos, tx, ty
                elif cos > right_cos:
                    right_cos, right_x, right_y = cos, tx, ty
        if left_cos > -2.0 or right_cos > -2.0:
            if abs(left_cos - right_cos) <= ROUNDING:
                return NO_SIDE, ex, ey
            if left_cos > right_cos:
                return TURNED, left_x, left_y
            return TURNED, right_x, right_y
        look *= 0.5
    return NO_WAY, ex, ey


@borrowing
def _set_limits(look: float, margin: float, steer_away: bool, count: int, room: Floats) -> None:
    """Writes the largest cosine between a free direction and the direction to each of the first `count` obstacles.

    It is inf, for no limit, of one that is too far away to count, and of one that has no direction.
    """
    for k in range(count):
        distance, limit = room[DISTANCE, k], math.inf
        if 0.0 < distance < look + margin:
            limit = min((distance - margin) / look, 1.0)
            if distance < margin:
                limit = max((distance - margin) / look, -STEEPEST) if steer_away else 0.0
        room[LIMIT, k] = limit


@borrowing
def _direction_free(tx: float, ty: float, points: Floats, room: Floats) -> bool:
    """Whether no obstacle's limit forbids the unit vector (tx, ty)."""
    for k in range(len(points)):
        cos = (tx * points[k, 0] + ty * points[k, 1]) / room[DISTANCE, k]
        if cos > room[LIMIT, k] + ROUNDING:
            return False
    return True


@compiled
def _free_way(ex: float, ey: float, points: Floats, margin: float) -> float:
    """How far one can go along (ex, ey) before a margin begins, m."""
    way = math.inf
    for k in range(len(points)):
        distance = math.hypot(points[k, 0], points[k, 1])
        if distance > 0.0:
            cos = (ex * points[k, 0] + ey * points[k, 1]) / distance
            if cos > ROUNDING:
                way = min(way, max(distance - margin, 0.0) / cos)
    return way
