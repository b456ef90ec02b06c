"""How far a member of the kinematic herd can go before it touches a wall or another member. Compiled.

Members are discs; points are discs of a tiny radius (`Place.clearance`), so that no rounding carries them through a
wall or between two that share a corner. Metres, world frame.
"""

from __future__ import annotations

import math

from flocking.compilation import borrowing
from flocking.kinematic.arrays import Limits
from flocking.types import Floats

NO_CONTACT = 2.0
"""Stands for a step that touches nothing: contacts come at parts from 0 to 1 of a step."""


@borrowing
def shortest(offset: float, period: float) -> float:
    """An offset in periodic space by the shorter way; as it is where `period` is 0."""
    if abs(offset) > 0.5 * period and period > 0.0:
        return offset - period * math.floor(offset / period + 0.5)
    return offset


@borrowing
def nearest_point(x: float, y: float, wall: Floats) -> tuple[float, float]:
    """The point of the wall (4,) that is nearest to (x, y)."""
    ex, ey = wall[2] - wall[0], wall[3] - wall[1]
    squared = ex * ex + ey * ey
    if squared == 0.0:
        return wall[0], wall[1]
    part = ((x - wall[0]) * ex + (y - wall[1]) * ey) / squared
    part = min(max(part, 0.0), 1.0)
    return wall[0] + part * ex, wall[1] + part * ey


@borrowing
def apart(x: float, y: float, wall: Floats) -> tuple[float, float, float]:
    """Distance of (x, y) from the wall, and the unit vector from it; beside the wall it is exactly its normal."""
    ex, ey = wall[2] - wall[0], wall[3] - wall[1]
    length = math.hypot(ex, ey)
    if 0.0 < (x - wall[0]) * ex + (y - wall[1]) * ey < length * length:
        away = ((y - wall[1]) * ex - (x - wall[0]) * ey) / length
        side = math.copysign(1.0, away)
        return abs(away), -side * ey / length, side * ex / length
    qx, qy = nearest_point(x, y, wall)
    d = math.hypot(x - qx, y - qy)
    if d == 0.0:
        return 0.0, 0.0, 0.0
    return d, (x - qx) / d, (y - qy) / d


@borrowing
def until_near(ox: float, oy: float, dx: float, dy: float, reach: float) -> float:
    """Part of the step (dx, dy) after which (ox, oy) is `reach` away; 0 if it is nearer already and comes nearer."""
    ahead = ox * dx + oy * dy
    if ahead <= 0.0:
        return NO_CONTACT
    step = math.hypot(dx, dy)
    across = (ox * dy - oy * dx) / step
    if abs(across) >= reach:
        return NO_CONTACT
    return max(0.0, (ahead / step - math.sqrt((reach - across) * (reach + across))) / step)


@borrowing
def until_side(x: float, y: float, dx: float, dy: float, reach: float, wall: Floats) -> float:
    """Part of a step that begins at least `reach` from the wall after which its side is `reach` away."""
    ex, ey = wall[2] - wall[0], wall[3] - wall[1]
    length = math.hypot(ex, ey)
    if length == 0.0:
        return NO_CONTACT
    ex, ey = ex / length, ey / length
    away = (y - wall[1]) * ex - (x - wall[0]) * ey
    speed = dy * ex - dx * ey
    if away < 0.0:
        away, speed = -away, -speed
    if speed >= 0.0:
        return NO_CONTACT
    part = max(0.0, (reach - away) / speed)
    along = (x + part * dx - wall[0]) * ex + (y + part * dy - wall[1]) * ey
    return part if 0.0 <= along <= length else NO_CONTACT


@borrowing
def passes_by(start: float, step: float, reach: float, one: float, other: float) -> bool:
    """Whether a step along one axis stays farther than `reach` from the stretch between two coordinates."""
    low, high = min(one, other), max(one, other)
    return max(start, start + step) + reach < low or min(start, start + step) - reach > high


@borrowing
def until_wall(
    x: float, y: float, dx: float, dy: float, reach: float, walls: Floats
) -> tuple[float, float, float, float]:
    """Part of a step after which the first wall is `reach` away, the unit vector from it, and how much too near it is.

    A step that begins nearer than `reach` may lead away from the wall. A wall on which the step begins is left out: it
    has no side from which to keep away. `NO_CONTACT` if no wall is touched.
    """
    best, away_x, away_y, depth = NO_CONTACT, 0.0, 0.0, 0.0
    for w in range(len(walls)):
        wall = walls[w]
        if passes_by(x, dx, reach, wall[0], wall[2]) or passes_by(y, dy, reach, wall[1], wall[3]):
            continue
        d, nx, ny = apart(x, y, wall)
        if d == 0.0:
            continue
        part, limit = 0.0, reach
        if d < reach:
            limit = 0.5 * d  # a step along the wall may come a little nearer by rounding, but not through it
        if d >= reach or nx * dx + ny * dy >= 0.0:
            part = min(
                until_side(x, y, dx, dy, limit, wall),
                until_near(wall[0] - x, wall[1] - y, dx, dy, limit),
                until_near(wall[2] - x, wall[3] - y, dx, dy, limit),
            )
        if part > 1.0 or part > best or (part == best and reach - d <= depth):
            continue
        if part > 0.0:
            d, nx, ny = apart(x + part * dx, y + part * dy, wall)
        best, away_x, away_y, depth = part, nx, ny, max(0.0, reach - d)
    return best, away_x, away_y, depth


@borrowing
def until_touch(
    i: int, x: float, y: float, dx: float, dy: float, positions: Floats, limits: Limits, period: float
) -> tuple[float, float, float]:
    """Part of a step from (x, y) after which member i touches another, and the unit vector towards that one."""
    best, which = NO_CONTACT, -1
    for j in range(len(positions)):
        if j == i or limits.radii[j] == 0.0:
            continue
        ox = shortest(positions[j, 0] - x, period)
        oy = shortest(positions[j, 1] - y, period)
        part = until_near(ox, oy, dx, dy, limits.radii[i] + limits.radii[j])
        if part < best:
            best, which = part, j
    if best > 1.0:
        return NO_CONTACT, 0.0, 0.0
    ox = shortest(positions[which, 0] - x, period) - best * dx
    oy = shortest(positions[which, 1] - y, period) - best * dy
    d = math.hypot(ox, oy)
    if d == 0.0:
        d = math.hypot(dx, dy)
        ox, oy = dx, dy
    return best, ox / d, oy / d
