"""A surface that a beam has met, by its number: its slope, its ends, a point's distance from it. Compiled."""

from __future__ import annotations

import math

from flocking.compilation import borrowing
from flocking.types import Floats
from sensing.laser.planar import Pose, Shapes, face, in_laser_frame


@borrowing
def slope(surface: int, laser: Pose, poses: Floats, shapes: Shapes) -> tuple[bool, float, float]:
    """What `cosine_of_incidence` needs of a surface, in the laser's frame.

    Whether it is a disc, and two coordinates: of a disc's centre divided by its radius, or of a face's normal.
    """
    p = surface // 4
    cx, cy, ux, uy = in_laser_frame(shapes, p, poses, laser)
    if p >= shapes.rectangles:
        radius = shapes.outlines[p, 4]
        return True, cx / radius, cy / radius
    nx, ny, _, _ = face(surface % 4, ux, uy, shapes.outlines[p, 4], shapes.outlines[p, 5])
    return False, nx, ny


@borrowing
def cosine_of_incidence(is_disc: bool, x: float, y: float, ex: float, ey: float) -> float:
    """Cosine of the angle between a beam with direction (ex, ey) and the normal of the surface where it meets it."""
    if is_disc:
        off = x * ey - y * ex
        return math.sqrt(max(1.0 - off * off, 0.0))
    return abs(x * ex + y * ey)


@borrowing
def turn_to_end(
    surface: int,
    left: bool,
    ex: float,
    ey: float,
    laser: Pose,
    poses: Floats,
    shapes: Shapes,
) -> float:
    """Angle (rad, counter-clockwise) from a beam with direction (ex, ey) to the left or right end of a surface."""
    p = surface // 4
    cx, cy, ux, uy = in_laser_frame(shapes, p, poses, laser)
    a, b = shapes.outlines[p, 4], shapes.outlines[p, 5]
    hand = 1.0 if left else -1.0
    if p >= shapes.rectangles:
        half = math.asin(min(a / math.sqrt(cx * cx + cy * cy), 1.0))
        return math.atan2(ex * cy - ey * cx, ex * cx + ey * cy) + hand * half
    nx, ny, out, length = face(surface % 4, ux, uy, a, b)
    x, y = cx + out * nx + hand * length * ny, cy + out * ny - hand * length * nx
    return math.atan2(ex * y - ey * x, ex * x + ey * y)


@borrowing
def away(
    surface: int,
    x: float,
    y: float,
    laser: Pose,
    poses: Floats,
    shapes: Shapes,
) -> float:
    """Distance (m) of the point (x, y), in the laser's frame, from a surface."""
    p = surface // 4
    cx, cy, ux, uy = in_laser_frame(shapes, p, poses, laser)
    a, b = shapes.outlines[p, 4], shapes.outlines[p, 5]
    if p >= shapes.rectangles:
        return abs(math.hypot(x - cx, y - cy) - a)
    nx, ny, out, length = face(surface % 4, ux, uy, a, b)
    x, y = x - cx - out * nx, y - cy - out * ny
    return math.hypot(x * nx + y * ny, max(abs(y * nx - x * ny) - length, 0.0))
