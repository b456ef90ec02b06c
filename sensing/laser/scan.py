"""One whole scan in one compiled call: where bodies stand, what the beams meet, what the laser reports."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from flocking.compilation import borrowing
from flocking.types import Floats, Ints
from sensing.laser import planar, readings, sweep
from sensing.laser.draws import Draws16
from sensing.laser.planar import BEAMS, LEVEL, Frames, Mounting, Places, Shapes
from sensing.laser.readings import FARTHEST_M, Hits, Mixing


class Fixed(NamedTuple):
    """What is the same for all scans of one laser, and the arrays that each of its scans writes over.

    `cast` and `scan` take it as a plain tuple (`tuple(fixed)`) and name its fields again: from Python, Numba takes 19
    arguments and a plain tuple of them in the same time (2.2 and 2.4 µs with the others), a named tuple in 2.3 µs more.
    """

    settings_row: Floats
    """(7,) `readings.Settings`."""
    own: int
    mount_frame: int
    mount: Floats
    """(4,) these three as in `planar.Mounting`."""
    addresses: Ints
    levels_m: Floats
    height_m: float
    """These three as in `planar.Frames`."""
    outlines: Floats
    rectangles: int
    frames: Ints
    owners: Ints
    materials: Floats
    """These five as in `planar.Shapes`."""
    poses: Floats
    lasers: Floats
    """Written over: as in `planar.Places`, with T = B for a laser that sweeps."""
    nearness: Floats
    """(B,) written over: 1/distance along each beam, 1/m."""
    surfaces: Ints
    """(B,) written over: as in `readings.Hits`."""
    partners: Ints
    shares: Floats
    """(B,) written over: as in `readings.Mixing`."""
    returns: Floats
    """(B,) written over: the light that comes back, as `readings.light` gives it."""
    first_beam: int
    last_beam: int
    """Those between them, both included, are in view."""


@borrowing
def _shapes(laser: Fixed) -> Shapes:
    return Shapes(laser.outlines, laser.rectangles, laser.frames, laser.owners, laser.materials)


@borrowing
def _cast(laser: Fixed, source: Floats) -> int:
    """Fill what beams meet, and `Places` on the way. Returns the frame that leans or is lifted, LEVEL if none.

    Beams out of view meet nothing.
    """
    shapes, places = _shapes(laser), Places(laser.poses, laser.lasers)
    mounting = Mounting(laser.own, laser.mount_frame, laser.mount)
    if len(laser.poses) > 1:
        sweep.cast_sweep(mounting, FARTHEST_M, places, shapes, laser.nearness, laser.surfaces)
        _blind(laser)
        return LEVEL
    frames = Frames(laser.addresses, laser.levels_m, laser.height_m)
    fallen = planar.place(source, frames, places.poses[0])
    if fallen == LEVEL:
        pose = planar.laser_pose(places.poses[0], mounting)
        row = places.lasers[0]
        row[0], row[1], row[2], row[3] = pose.x, pose.y, pose.cosine, pose.sine
        planar.cast(pose, laser.own, FARTHEST_M, places.poses[0], shapes, laser.nearness, laser.surfaces)
        _blind(laser)
    return fallen


@borrowing
def _blind(laser: Fixed) -> None:
    """Nothing is met by the beams out of view."""
    nearness, surfaces = laser.nearness, laser.surfaces
    nearness[: laser.first_beam] = nearness[laser.last_beam + 1 :] = 1.0 / FARTHEST_M
    surfaces[: laser.first_beam] = surfaces[laser.last_beam + 1 :] = -1


@borrowing
def cast(fixed: tuple[Any, ...], source: Floats) -> int:
    """The rays of `scan` alone."""
    return _cast(Fixed(*fixed), source)


@borrowing
def scan(
    fixed: tuple[Any, ...],
    source: Floats,
    shines: bool,
    draws: Draws16,
    light_draws: Draws16,
    ranges: Floats,
    intensities: Floats,
    distances: Floats,
    reading_owners: Ints,
    lit: Ints,
) -> int:
    """One scan: poses, rays, mixed readings, noise, and where it `shines` intensity. Returns as `planar.place`.

    `fixed`: the laser's `Fixed`. `source`: positions and quaternions of the moving frames; a laser that sweeps has
    their `poses` filled in before. `draws`, `light_draws`: random numbers as `readings.report` and
    `readings.report_light` take them. Filled: `ranges` (B,) and `intensities` (B,) as in `Scan`, exact `distances`
    (B,), `reading_owners` (B,) and `lit` (N,) as in `ScanTruth`.
    """
    laser = Fixed(*fixed)
    fallen = _cast(laser, source)
    if fallen != LEVEL:
        return fallen
    settings, shapes = readings.settings_of(laser.settings_row), _shapes(laser)
    places, mixing = Places(laser.poses, laser.lasers), Mixing(laser.partners, laser.shares)
    hits = Hits(distances, laser.surfaces)
    for i in range(BEAMS):
        distances[i] = 1.0 / laser.nearness[i] if laser.surfaces[i] >= 0 else math.inf
    readings.find_edges(settings.half_footprint, hits, places, shapes, mixing)
    readings.report(settings, hits, places, shapes, mixing, draws, ranges, reading_owners, lit)
    if shines:
        readings.light(hits, places, shapes, laser.returns)
        readings.report_light(settings, laser.returns, mixing, light_draws, ranges, intensities)
    return LEVEL
