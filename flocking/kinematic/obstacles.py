"""Which walls a member of the kinematic herd sees, and where. Compiled.

Walls lie in columns, so that a processor looks at several at a time. Metres, world frame.
"""

from __future__ import annotations

import math

import numpy as np

from flocking.compilation import borrowing
from flocking.kinematic.sight import Focal
from flocking.types import Floats

SLACK = 1e-9
"""Relative: what rounding may take from a distance, many times over."""
X, Y, ALONG_X, ALONG_Y, SQUARED, NEAREST_X, NEAREST_Y, AWAY = range(8)
"""Rows of what is known of walls: beginning, the way to the end, its square; then, for one member, the nearest point
and the square of its distance."""


@borrowing
def lay_out(walls: Floats, columns: Floats) -> None:
    """Writes the first five rows of `columns` (5 or more, W) of all `walls` (W, 4)."""
    for w in range(len(walls)):
        wall = walls[w]
        ex, ey = wall[2] - wall[0], wall[3] - wall[1]
        columns[X, w], columns[Y, w] = wall[0], wall[1]
        columns[ALONG_X, w], columns[ALONG_Y, w] = ex, ey
        columns[SQUARED, w] = ex * ex + ey * ey


@borrowing
def keep_near(positions: Floats, walls: Floats, columns: Floats, sight: float, near: Floats) -> int:
    """Writes the columns of the walls whose bounding box is within sight of that of all `positions` (N, 2), in their
    order, into `near` (8, W); returns their number."""
    x0 = y0 = -math.inf
    x1 = y1 = math.inf
    reach = math.inf
    if sight < math.inf:
        x0 = y0 = math.inf
        x1 = y1 = -math.inf
        for i in range(len(positions)):
            x0, x1 = min(x0, positions[i, 0]), max(x1, positions[i, 0])
            y0, y1 = min(y0, positions[i, 1]), max(y1, positions[i, 1])
        reach = sight * (1.0 + SLACK) + SLACK * (abs(x0) + abs(x1) + abs(y0) + abs(y1))
    count = 0
    for w in range(len(walls)):
        wall = walls[w]
        apart_x = max(min(wall[0], wall[2]) - x1, x0 - max(wall[0], wall[2]))
        apart_y = max(min(wall[1], wall[3]) - y1, y0 - max(wall[1], wall[3]))
        near[X, count], near[Y, count] = columns[X, w], columns[Y, w]
        near[ALONG_X, count], near[ALONG_Y, count] = columns[ALONG_X, w], columns[ALONG_Y, w]
        near[SQUARED, count] = columns[SQUARED, w]
        count += not (apart_x > reach or apart_y > reach)
    return count


@borrowing
def look_at_walls(x: float, y: float, count: int, near: Floats) -> None:
    """Writes the last three rows of the first `count` columns of `near`, for a member at (x, y).

    `flocking.kinematic.walls.nearest_point`, for all of them.
    """
    for k in range(count):
        ex, ey, squared = near[ALONG_X, k], near[ALONG_Y, k], near[SQUARED, k]
        part = ((x - near[X, k]) * ex + (y - near[Y, k]) * ey) / squared
        part = min(max(part, 0.0), 1.0)
        part = 0.0 if squared == 0.0 else part
        nx, ny = near[X, k] + part * ex, near[Y, k] + part * ey
        dx, dy = nx - x, ny - y
        near[NEAREST_X, k], near[NEAREST_Y, k] = nx, ny
        near[AWAY, k] = dx * dx + dy * dy


@borrowing
def in_sight(x: float, y: float, px: float, py: float, columns: Floats) -> bool:
    """Whether no wall lies between (x, y) and the point (px, py): one that the point is on does not."""
    dx, dy = (1.0 - SLACK) * (px - x), (1.0 - SLACK) * (py - y)
    hiding: int | np.int64 = 0
    for w in range(columns.shape[1]):
        ex, ey = columns[ALONG_X, w], columns[ALONG_Y, w]
        ox, oy = columns[X, w] - x, columns[Y, w] - y
        here, there = ox * ey - oy * ex, (ox - dx) * ey - (oy - dy) * ex
        one, other = dx * oy - dy * ox, dx * (oy + ey) - dy * (ox + ex)
        hiding |= np.int64((here > 0.0) != (there > 0.0)) & np.int64((one > 0.0) != (other > 0.0))
    return hiding == 0


@borrowing
def obstacles_seen(
    focal: Focal, columns: Floats, near: Floats, count: int, sight: float, sight_lines: bool, points: Floats
) -> int:
    """Writes the nearest point of each wall within sight, of the first `count` of `near`, body frame; returns their
    number. `columns` are all walls that may hide them."""
    x, y, c, s = focal.x, focal.y, focal.cosine, focal.sine
    look_at_walls(x, y, count, near)
    seen = 0
    for k in range(count):
        if near[AWAY, k] <= sight * sight:
            nx, ny = near[NEAREST_X, k], near[NEAREST_Y, k]
            if not sight_lines or in_sight(x, y, nx, ny, columns):
                dx, dy = nx - x, ny - y
                points[seen, 0], points[seen, 1] = c * dx + s * dy, c * dy - s * dx
                seen += 1
    return seen
