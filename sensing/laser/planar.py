"""Rays of a laser against rectangles and discs in one plane, compiled.

Each shape that can be seen touches only its own interval of beams. Distances are kept as their inverse: along a
straight face that is linear in the beam's direction, so the inner loop has no division and the nearest surface is
the greatest inverse.

A surface is numbered 4 p + side: side 0, 1, 2, 3 of rectangle p faces its +x, −x, +y, −y; a disc has side 0 only.
A laser inside a shape is covered by it: distance 0 along every beam.
"""

from __future__ import annotations

import math

import numpy as np

from flocking.compilation import compiled
from flocking.types import Floats, Ints

STEP_RAD = 2.0 * math.pi / 1024
"""Angle between beams. P: URG-04LX-UG01 specification, 1024 steps a turn."""
STEPS_A_TURN = 1024
BEAMS = 682
"""S: steps 44 to 725, read from the firmware."""
FIRST_STEP = -340.0
"""Beam 0 is step 44, 340 steps before the front (step 384)."""
TILT_BOUND_RAD = math.radians(3.0)
"""A body or laser that leans more is an error; Creates that ram walls and one another stay within 1.2 degrees (D, found
by simulation). Up to here the level plane misstates a range by at most 1 − cos 3° = 0.14 % and a bearing by at most
0.08 degrees (D); where bodies stand at the plane's height is exact. That a leaning beam passes over what is low, or
meets the floor, is not modelled: at 3 degrees it is 5 cm off the plane after 1 m."""
LIFT_BOUND_M = 0.03
"""A body that stands higher or lower than in the model's reference pose by more is an error."""
LEVEL = -1
"""What `place` returns when all is well."""
_SLACK_BEAMS = 1e-9
"""Keeps a beam that meets the end of a face exactly."""


def beam_directions() -> Floats:
    """(2, B) cosine and sine of each beam's bearing in the laser's frame, in the order they are read."""
    angles = (np.arange(BEAMS) + FIRST_STEP) * STEP_RAD
    return np.stack([np.cos(angles), np.sin(angles)])


@compiled
def place(source: Floats, addresses: Ints, levels_m: Floats, height_m: float, poses: Floats) -> int:
    """Where each frame stands, from positions and quaternions in `source` (7 numbers from each address).

    Fills `poses` (F, 4): x, y of the frame's axis where it meets the plane, cosine and sine of its heading.
    Returns the first frame that leans or is lifted beyond the bounds, −1 if none.
    """
    for f in range(len(addresses)):
        a = addresses[f]
        w, x, y, z = source[a + 3], source[a + 4], source[a + 5], source[a + 6]
        scale = w * w + x * x + y * y + z * z
        upright = (w * w - x * x - y * y + z * z) / scale
        lifted = source[a + 2] + levels_m[f] * upright - height_m
        # written so that nan fails as well
        if not (upright >= math.cos(TILT_BOUND_RAD) and abs(lifted) <= LIFT_BOUND_M):
            return f
        along = levels_m[f] / scale
        poses[f, 0] = source[a] + along * 2.0 * (x * z + w * y)
        poses[f, 1] = source[a + 1] + along * 2.0 * (y * z - w * x)
        c, s = w * w + x * x - y * y - z * z, 2.0 * (x * y + w * z)
        length = math.sqrt(c * c + s * s)
        poses[f, 2] = c / length
        poses[f, 3] = s / length
    return LEVEL


@compiled
def laser_pose(poses: Floats, frame: int, mount: Floats) -> tuple[float, float, float, float]:
    """x, y, cosine and sine of a laser's heading in the world; `mount` is the same in its frame."""
    if frame < 0:
        return mount[0], mount[1], mount[2], mount[3]
    x, y, c, s = poses[frame, 0], poses[frame, 1], poses[frame, 2], poses[frame, 3]
    return (
        x + c * mount[0] - s * mount[1],
        y + s * mount[0] + c * mount[1],
        c * mount[2] - s * mount[3],
        s * mount[2] + c * mount[3],
    )


@compiled
def in_laser_frame(
    shape: Floats, frame: int, poses: Floats, laser: tuple[float, float, float, float]
) -> tuple[float, float, float, float]:
    """Centre x, y and direction of the x axis of a shape in the laser's frame."""
    x, y, ux, uy = shape[0], shape[1], shape[2], shape[3]
    if frame >= 0:
        fx, fy, fc, fs = poses[frame, 0], poses[frame, 1], poses[frame, 2], poses[frame, 3]
        x, y = fx + fc * x - fs * y, fy + fs * x + fc * y
        ux, uy = fc * ux - fs * uy, fs * ux + fc * uy
    lx, ly, lc, ls = laser
    x, y = x - lx, y - ly
    return lc * x + ls * y, lc * y - ls * x, lc * ux + ls * uy, lc * uy - ls * ux


@compiled
def face(side: int, ux: float, uy: float, a: float, b: float) -> tuple[float, float, float, float]:
    """Outward normal of one side of a rectangle, its distance from the centre, and half its length."""
    if side == 0:
        return ux, uy, a, b
    if side == 1:
        return -ux, -uy, a, b
    if side == 2:
        return -uy, ux, b, a
    return uy, -ux, b, a


@compiled
def _interval(first: float, last: float, turn: int) -> tuple[int, int]:
    """Beams between two bearings (in beams from beam 0), `turn` turns on; empty if the second is below the first."""
    low = math.ceil(first - turn * STEPS_A_TURN - _SLACK_BEAMS)
    high = math.floor(last - turn * STEPS_A_TURN + _SLACK_BEAMS)
    return max(low, 0), min(high, BEAMS - 1)


@compiled
def _see_disc(
    cx: float,
    cy: float,
    radius: float,
    scale: float,
    surface: int,
    cosines: Floats,
    sines: Floats,
    nearness: Floats,
    surfaces: Ints,
) -> None:
    """Let beams that meet a disc see it where it is the nearest so far; `scale` is 1 / (distance² − radius²)."""
    for i in range(len(cosines)):
        off = cx * sines[i] - cy * cosines[i]
        inside = radius * radius - off * off
        near = (cx * cosines[i] + cy * sines[i] + math.sqrt(inside if inside > 0.0 else 0.0)) * scale
        nearer = near > nearness[i]
        nearness[i] = near if nearer else nearness[i]
        surfaces[i] = surface if nearer else surfaces[i]


@compiled
def _see_face(
    kx: float, ky: float, surface: int, cosines: Floats, sines: Floats, nearness: Floats, surfaces: Ints
) -> None:
    """Let beams that meet a face see it where it is the nearest so far: along a beam its 1/distance is k · beam."""
    for i in range(len(cosines)):
        near = kx * cosines[i] + ky * sines[i]
        nearer = near > nearness[i]
        # both arms write: this loop then runs several beams at a time
        nearness[i] = near if nearer else nearness[i]
        surfaces[i] = surface if nearer else surfaces[i]


@compiled
def cast(
    laser: tuple[float, float, float, float],
    own: int,
    max_range_m: float,
    poses: Floats,
    shapes: Floats,
    rectangles: int,
    frames: Ints,
    owners: Ints,
    beams: Floats,
    nearness: Floats,
    surfaces: Ints,
) -> None:
    """Fill `nearness` (B,), 1/distance to the nearest surface (1/m), and `surfaces` (B,), its number; −1 = none.

    Shapes whose owner is `own` are not seen. Nothing beyond `max_range_m` is seen.
    """
    cosines, sines = beams[0], beams[1]
    nearness[:] = 1.0 / max_range_m
    surfaces[:] = -1
    for p in range(len(shapes)):
        if owners[p] == own and own >= 0:
            continue
        cx, cy, ux, uy = in_laser_frame(shapes[p], frames[p], poses, laser)
        a, b = shapes[p, 4], shapes[p, 5]
        if p >= rectangles:
            squared = cx * cx + cy * cy
            if squared <= a * a:
                nearness[:] = math.inf
                surfaces[:] = 4 * p
                return
            distance = math.sqrt(squared)
            if distance - a > max_range_m:
                continue
            half = math.asin(a / distance) / STEP_RAD
            middle = math.atan2(cy, cx) / STEP_RAD - FIRST_STEP
            scale = 1.0 / (squared - a * a)
            for turn in range(-1, 2):
                low, high = _interval(middle - half, middle + half, turn)
                if low <= high:
                    _see_disc(
                        cx, cy, a, scale, 4 * p, cosines[low : high + 1], sines[low : high + 1],
                        nearness[low : high + 1], surfaces[low : high + 1],
                    )  # fmt: skip
            continue
        # where the laser stands, seen from the rectangle
        px, py = -(cx * ux + cy * uy), cx * uy - cy * ux
        if abs(px) <= a and abs(py) <= b:
            nearness[:] = math.inf
            surfaces[:] = 4 * p
            return
        for pair in range(2):
            seen, extent = (px, a) if pair == 0 else (py, b)
            distance = abs(seen) - extent
            aside = abs(py) - b if pair == 0 else abs(px) - a
            if distance <= 0.0 or distance > max_range_m or aside > max_range_m:
                continue
            side = 2 * pair + (1 if seen < 0.0 else 0)
            nx, ny, out, length = face(side, ux, uy, a, b)
            mx, my = cx + out * nx, cy + out * ny
            rx, ry, lx, ly = mx - length * ny, my + length * nx, mx + length * ny, my - length * nx
            first = math.atan2(ry, rx) / STEP_RAD - FIRST_STEP
            last = first + math.atan2(rx * ly - ry * lx, rx * lx + ry * ly) / STEP_RAD
            kx, ky = -nx / distance, -ny / distance
            for turn in range(2):
                low, high = _interval(first, last, turn)
                if low <= high:
                    _see_face(
                        kx, ky, 4 * p + side, cosines[low : high + 1], sines[low : high + 1],
                        nearness[low : high + 1], surfaces[low : high + 1],
                    )  # fmt: skip


@compiled
def cast_one(
    i: int,
    laser: tuple[float, float, float, float],
    own: int,
    max_range_m: float,
    poses: Floats,
    shapes: Floats,
    rectangles: int,
    frames: Ints,
    owners: Ints,
    beams: Floats,
) -> tuple[float, int]:
    """Beam i alone against every shape: 1/distance (1/m) and number of the nearest surface, −1 = none."""
    ex, ey = beams[0, i], beams[1, i]
    nearest, surface = 1.0 / max_range_m, -1
    for p in range(len(shapes)):
        if owners[p] == own and own >= 0:
            continue
        cx, cy, ux, uy = in_laser_frame(shapes[p], frames[p], poses, laser)
        a, b = shapes[p, 4], shapes[p, 5]
        if p >= rectangles:
            squared = cx * cx + cy * cy
            if squared <= a * a:
                return math.inf, 4 * p
            off, along = cx * ey - cy * ex, cx * ex + cy * ey
            if along > 0.0 and abs(off) <= a:
                near = (along + math.sqrt(a * a - off * off)) / (squared - a * a)
                if near > nearest:
                    nearest, surface = near, 4 * p
            continue
        px, py = -(cx * ux + cy * uy), cx * uy - cy * ux
        if abs(px) <= a and abs(py) <= b:
            return math.inf, 4 * p
        for pair in range(2):
            seen, extent = (px, a) if pair == 0 else (py, b)
            distance = abs(seen) - extent
            if distance <= 0.0:
                continue
            side = 2 * pair + (1 if seen < 0.0 else 0)
            nx, ny, out, length = face(side, ux, uy, a, b)
            near = -(nx * ex + ny * ey) / distance
            if near <= nearest:
                continue
            mx, my = cx + out * nx, cy + out * ny
            across = (ex / near - mx) * -ny + (ey / near - my) * nx
            if abs(across) <= length * (1.0 + 1e-12):
                nearest, surface = near, 4 * p + side
    return nearest, surface


@compiled
def slope(
    surface: int,
    laser: tuple[float, float, float, float],
    poses: Floats,
    shapes: Floats,
    rectangles: int,
    frames: Ints,
) -> tuple[bool, float, float]:
    """What `cosine_of_incidence` needs of a surface, in the laser's frame: is it a disc; then the centre divided by
    the radius, else the normal."""
    p = surface // 4
    cx, cy, ux, uy = in_laser_frame(shapes[p], frames[p], poses, laser)
    if p >= rectangles:
        return True, cx / shapes[p, 4], cy / shapes[p, 4]
    nx, ny, _, _ = face(surface % 4, ux, uy, shapes[p, 4], shapes[p, 5])
    return False, nx, ny


@compiled
def cosine_of_incidence(is_disc: bool, x: float, y: float, ex: float, ey: float) -> float:
    """Cosine of the angle between a beam with direction (ex, ey) and the normal of the surface where it meets it."""
    if is_disc:
        off = x * ey - y * ex
        return math.sqrt(max(1.0 - off * off, 0.0))
    return abs(x * ex + y * ey)


@compiled
def turn_to_end(
    surface: int,
    left: bool,
    ex: float,
    ey: float,
    laser: tuple[float, float, float, float],
    poses: Floats,
    shapes: Floats,
    rectangles: int,
    frames: Ints,
) -> float:
    """Angle (rad, counter-clockwise) from a beam with direction (ex, ey) to the left or right end of a surface."""
    p = surface // 4
    cx, cy, ux, uy = in_laser_frame(shapes[p], frames[p], poses, laser)
    a, b = shapes[p, 4], shapes[p, 5]
    hand = 1.0 if left else -1.0
    if p >= rectangles:
        half = math.asin(min(a / math.sqrt(cx * cx + cy * cy), 1.0))
        return math.atan2(ex * cy - ey * cx, ex * cx + ey * cy) + hand * half
    nx, ny, out, length = face(surface % 4, ux, uy, a, b)
    x, y = cx + out * nx + hand * length * ny, cy + out * ny - hand * length * nx
    return math.atan2(ex * y - ey * x, ex * x + ey * y)


@compiled
def away(
    surface: int,
    x: float,
    y: float,
    laser: tuple[float, float, float, float],
    poses: Floats,
    shapes: Floats,
    rectangles: int,
    frames: Ints,
) -> float:
    """Distance of the point (x, y) in the laser's frame from a surface, m."""
    p = surface // 4
    cx, cy, ux, uy = in_laser_frame(shapes[p], frames[p], poses, laser)
    a, b = shapes[p, 4], shapes[p, 5]
    if p >= rectangles:
        return abs(math.hypot(x - cx, y - cy) - a)
    nx, ny, out, length = face(surface % 4, ux, uy, a, b)
    x, y = x - cx - out * nx, y - cy - out * ny
    return math.hypot(x * nx + y * ny, max(abs(y * nx - x * ny) - length, 0.0))
