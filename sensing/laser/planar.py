"""Rays of a laser against rectangles and discs in one plane, compiled.

For each shape that can be seen, the beams between its two ends are known at once, and only they are compared with it.
Distances are kept as their inverse: along a straight face it is linear in the beam's direction, so that the inner loop
has no division, and the nearest surface is the one with the greatest inverse.

A surface is numbered 4 p + side: side 0, 1, 2, 3 of rectangle p faces its +x, −x, +y, −y; a disc has side 0 only.
A laser inside a shape is covered by it: distance 0 along every beam.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from flocking.compilation import borrowing
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
"""What `place` returns where no frame leans or is lifted."""
_SLACK_BEAMS = 1e-9
"""Beams within this distance of the end of a face count as on it: round-off must not lose one that meets it exactly."""


_BEARINGS = (np.arange(BEAMS) + FIRST_STEP) * STEP_RAD
COSINES: Floats = np.cos(_BEARINGS)
SINES: Floats = np.sin(_BEARINGS)
"""(B,) direction of each beam in the laser's frame, in the order in which they are read. Compiled in as constants."""


class Pose(NamedTuple):
    """Of a laser: m, and cosine and sine of its heading."""

    x: float
    y: float
    cosine: float
    sine: float


class Shapes(NamedTuple):
    """What stands at the laser's height, P shapes, as compiled code takes it from a `Slice`; rectangles come first."""

    outlines: Floats
    """(P, 6) in the shape's frame, as `Slice.shapes`."""
    rectangles: int
    """How many of them are rectangles; the rest are discs."""
    frames: Ints
    """(P,) row of the moving frame that carries the shape; −1 = fixed in the world."""
    owners: Ints
    """(P,) the robot that the shape belongs to; −1 = none."""
    materials: Floats
    """(P, 2) diffuse albedo and retroreflective gain."""


class Places(NamedTuple):
    """Where all is while a scan is made: T = 1 where all beams are read at once, T = B where each has its instant."""

    poses: Floats
    """(T, F, 4) of the moving frames in the world: x, y (m), cosine and sine of the heading."""
    lasers: Floats
    """(T, 4) the same of the laser."""


class Mounting(NamedTuple):
    """Where a laser is mounted."""

    own: int
    """The robot that carries it, and is not seen by it."""
    frame: int
    """The moving frame that carries it; −1 = fixed in the world."""
    pose: Floats
    """(4,) x, y (m), cosine and sine of its heading in that frame."""


class Frames(NamedTuple):
    """Where the poses of the moving frames are found, and the plane that cuts them."""

    addresses: Ints
    """(F,) where in the source of poses a frame's seven numbers begin: position (m) and quaternion."""
    levels_m: Floats
    """(F,) height of the plane above the frame's origin in the model's reference pose."""
    height_m: float
    """Of the plane."""


@borrowing
def at_beam(places: Places, beam: int) -> tuple[Pose, Floats]:
    """The laser's pose and those of the frames (F, 4) when a beam was read."""
    t = beam if len(places.lasers) > 1 else 0
    laser = places.lasers[t]
    return Pose(laser[0], laser[1], laser[2], laser[3]), places.poses[t]


@borrowing
def place(source: Floats, frames: Frames, poses: Floats) -> int:
    """Where each frame stands, from positions and quaternions in `source`.

    Fills `poses` (F, 4): x, y of the frame's axis where it meets the plane, cosine and sine of its heading.
    Returns the first frame that leans or is lifted beyond the bounds, −1 if none.
    """
    addresses, levels_m, height_m = frames
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


@borrowing
def laser_pose(poses: Floats, mounting: Mounting) -> Pose:
    """A laser's pose in the world, where the frames stand at `poses` (F, 4)."""
    mount = mounting.pose
    if mounting.frame < 0:
        return Pose(mount[0], mount[1], mount[2], mount[3])
    frame = poses[mounting.frame]
    x, y, c, s = frame[0], frame[1], frame[2], frame[3]
    return Pose(
        x + c * mount[0] - s * mount[1],
        y + s * mount[0] + c * mount[1],
        c * mount[2] - s * mount[3],
        s * mount[2] + c * mount[3],
    )


@borrowing
def in_laser_frame(shapes: Shapes, p: int, poses: Floats, laser: Pose) -> tuple[float, float, float, float]:
    """Centre x, y and direction of the x axis of shape p in the laser's frame."""
    shape, frame = shapes.outlines[p], shapes.frames[p]
    x, y, ux, uy = shape[0], shape[1], shape[2], shape[3]
    if frame >= 0:
        fx, fy, fc, fs = poses[frame, 0], poses[frame, 1], poses[frame, 2], poses[frame, 3]
        x, y = fx + fc * x - fs * y, fy + fs * x + fc * y
        ux, uy = fc * ux - fs * uy, fs * ux + fc * uy
    lx, ly, lc, ls = laser
    x, y = x - lx, y - ly
    return lc * x + ls * y, lc * y - ls * x, lc * ux + ls * uy, lc * uy - ls * ux


@borrowing
def out_of_range(shapes: Shapes, p: int, laser: Pose, max_range_m: float) -> bool:
    """Whether shape p is fixed in the world and no part of it is in range; most of a large plan's walls are not."""
    if shapes.frames[p] >= 0:
        return False
    shape = shapes.outlines[p]
    dx, dy = shape[0] - laser[0], shape[1] - laser[1]
    reach = max_range_m + shape[4] + shape[5]  # the half sizes' sum is more than half a diagonal, or a radius
    return bool(dx * dx + dy * dy > reach * reach)


@borrowing
def face(side: int, ux: float, uy: float, a: float, b: float) -> tuple[float, float, float, float]:
    """Outward normal of one side of a rectangle, its distance from the centre, and half its length."""
    if side == 0:
        return ux, uy, a, b
    if side == 1:
        return -ux, -uy, a, b
    if side == 2:
        return -uy, ux, b, a
    return uy, -ux, b, a


@borrowing
def _interval(first: float, last: float, turn: int) -> tuple[int, int]:
    """Beams between two bearings (in beams from beam 0), `turn` turns on; empty if the second is below the first."""
    low = math.ceil(first - turn * STEPS_A_TURN - _SLACK_BEAMS)
    high = math.floor(last - turn * STEPS_A_TURN + _SLACK_BEAMS)
    return max(low, 0), min(high, BEAMS - 1)


@borrowing
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
    """Of the beams that meet a disc, mark those for which it is the nearest so far.

    `scale` is 1 / (distance² − radius²) of its centre.
    """
    for i in range(len(cosines)):
        off = cx * sines[i] - cy * cosines[i]
        inside = radius * radius - off * off
        near = (cx * cosines[i] + cy * sines[i] + math.sqrt(inside if inside > 0.0 else 0.0)) * scale
        nearer = near > nearness[i]
        nearness[i] = near if nearer else nearness[i]
        surfaces[i] = surface if nearer else surfaces[i]


@borrowing
def _see_face(
    kx: float, ky: float, surface: int, cosines: Floats, sines: Floats, nearness: Floats, surfaces: Ints
) -> None:
    """Of the beams that meet a face, mark those for which it is the nearest so far: its 1/distance is k · beam."""
    for i in range(len(cosines)):
        near = kx * cosines[i] + ky * sines[i]
        nearer = near > nearness[i]
        # written either way: without a branch the compiler computes several beams at a time
        nearness[i] = near if nearer else nearness[i]
        surfaces[i] = surface if nearer else surfaces[i]


@borrowing
def cast(
    laser: Pose, own: int, max_range_m: float, poses: Floats, shapes: Shapes, nearness: Floats, surfaces: Ints
) -> None:
    """Fill `nearness` (B,), 1/distance to the nearest surface (1/m), and `surfaces` (B,), its number; −1 = none.

    Shapes whose owner is `own` are not seen. Nothing beyond `max_range_m` is seen.
    """
    nearness[:] = 1.0 / max_range_m
    surfaces[:] = -1
    for p in range(len(shapes.outlines)):
        if (shapes.owners[p] == own and own >= 0) or out_of_range(shapes, p, laser, max_range_m):
            continue
        cx, cy, ux, uy = in_laser_frame(shapes, p, poses, laser)
        a, b = shapes.outlines[p, 4], shapes.outlines[p, 5]
        if p >= shapes.rectangles:
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
                        cx, cy, a, scale, 4 * p, COSINES[low : high + 1], SINES[low : high + 1],
                        nearness[low : high + 1], surfaces[low : high + 1],
                    )  # fmt: skip
            continue
        # the laser's place in the axes of the rectangle
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
                        kx, ky, 4 * p + side, COSINES[low : high + 1], SINES[low : high + 1],
                        nearness[low : high + 1], surfaces[low : high + 1],
                    )  # fmt: skip


@borrowing
def cast_one(i: int, laser: Pose, own: int, max_range_m: float, poses: Floats, shapes: Shapes) -> tuple[float, int]:
    """Beam i alone against every shape: 1/distance (1/m) and number of the nearest surface, −1 = none."""
    ex, ey = COSINES[i], SINES[i]
    nearest, surface = 1.0 / max_range_m, -1
    for p in range(len(shapes.outlines)):
        if (shapes.owners[p] == own and own >= 0) or out_of_range(shapes, p, laser, max_range_m):
            continue
        cx, cy, ux, uy = in_laser_frame(shapes, p, poses, laser)
        a, b = shapes.outlines[p, 4], shapes.outlines[p, 5]
        if p >= shapes.rectangles:
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
