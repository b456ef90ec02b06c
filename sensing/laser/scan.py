"""One whole scan in one compiled call: where bodies stand, what the beams meet, what the laser reports."""

from __future__ import annotations

import math
from typing import NamedTuple

from flocking.compilation import compiled
from flocking.types import Floats, Ints
from sensing.laser import planar, readings, sweep


class Scratch(NamedTuple):
    """Arrays that every scan writes over."""

    nearness: Floats
    surfaces: Ints
    partners: Ints
    shares: Floats
    returns: Floats


@compiled
def cast_now(
    own: int,
    source: Floats,
    addresses: Ints,
    levels_m: Floats,
    height_m: float,
    mount_frame: int,
    mount: Floats,
    poses: Floats,
    lasers: Floats,
    shapes: Floats,
    rectangles: int,
    frames: Ints,
    owners: Ints,
    beams: Floats,
    nearness: Floats,
    surfaces: Ints,
) -> int:
    """All beams at once: fills poses (1, F, 4) and lasers (1, 4) on the way. Returns as `planar.place`."""
    fallen = planar.place(source, addresses, levels_m, height_m, poses[0])
    if fallen == planar.LEVEL:
        laser = planar.laser_pose(poses[0], mount_frame, mount)
        lasers[0, 0], lasers[0, 1], lasers[0, 2], lasers[0, 3] = laser
        planar.cast(
            laser, own, readings.FARTHEST_M, poses[0], shapes, rectangles, frames, owners, beams, nearness, surfaces
        )
    return fallen


@compiled
def scan(
    settings_row: Floats,
    own: int,
    shines: bool,
    source: Floats,
    addresses: Ints,
    levels_m: Floats,
    height_m: float,
    mount_frame: int,
    mount: Floats,
    poses: Floats,
    lasers: Floats,
    shapes: Floats,
    rectangles: int,
    frames: Ints,
    owners: Ints,
    materials: Floats,
    beams: Floats,
    nearness: Floats,
    surfaces: Ints,
    partners: Ints,
    shares: Floats,
    returns: Floats,
    normals: Floats,
    draws: Ints,
    light_draws: Ints,
    ranges: Floats,
    intensities: Floats,
    distances: Floats,
    reading_owners: Ints,
    lit: Ints,
) -> int:
    """One scan: poses, cast, mixed readings, noise, intensity. Returns as `planar.place`.

    Plain arrays instead of named tuples: Numba takes them from Python several times faster.
    """
    settings = readings.settings_of(settings_row)
    if len(poses) > 1:
        sweep.cast_sweep(
            mount_frame, mount, own, readings.FARTHEST_M, poses, shapes, rectangles, frames, owners, beams, lasers,
            nearness, surfaces,
        )  # fmt: skip
    else:
        fallen = cast_now(
            own, source, addresses, levels_m, height_m, mount_frame, mount, poses, lasers, shapes, rectangles, frames,
            owners, beams, nearness, surfaces,
        )  # fmt: skip
        if fallen != planar.LEVEL:
            return fallen
    for i in range(planar.BEAMS):
        distances[i] = 1.0 / nearness[i] if surfaces[i] >= 0 else math.inf
    if settings.half_footprint > 0.0:
        readings.find_edges(
            settings.half_footprint, distances, surfaces, lasers, poses, shapes, rectangles, frames, beams,
            partners, shares,
        )  # fmt: skip
    else:
        partners[:] = -1
        shares[:] = 0.0
    readings.report(
        settings, distances, surfaces, lasers, poses, shapes, rectangles, frames, owners, beams, partners, shares,
        normals, draws, ranges, reading_owners, lit,
    )  # fmt: skip
    if shines:
        readings.light(distances, surfaces, lasers, poses, shapes, rectangles, frames, materials, beams, returns)
        readings.report_light(settings, returns, partners, shares, normals, light_draws, ranges, intensities)
    return planar.LEVEL
