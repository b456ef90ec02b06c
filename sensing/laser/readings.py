"""From exact distances to what the laser reports: mixed readings, noise, whole millimetres, codes. Compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

from flocking.compilation import compiled
from flocking.types import Floats, Ints
from sensing.laser.intensity import NEAREST_M, returned
from sensing.laser.planar import BEAMS, STEP_RAD, away, cosine_of_incidence, slope, turn_to_end
from sensing.types import NOBODY

FARTHEST_M = 5.6
"""P: 5600 mm (data sheet, white paper)."""
CODE_NO_RETURN = 0
CODE_OTHER_FAR = 6
"""C: hokuyo_node takes 0 and 6 for no return."""
CODE_STRONG_REFLECTOR = 18
CODE_FAILED = 16
"""C: 16 to 19 are errors to hokuyo_node; which of them a lost reading gives is a choice."""
FIRST_RANGE_MM = 20
"""P: lower numbers in place of a range are codes."""
IDEAL, HALF_RESOLUTION, STRONG_CODE = 0, 1, 2
"""How the laser tells of intensity."""
MIXING_JUMP_M = 0.02
"""Surfaces nearer to one another along neighbouring beams blend without a reading of their own. (choice)"""
SURFACE_TOLERANCE_M = 0.05
"""Ground truth: a reading farther than this, and than three standard deviations, from a member's surface belongs to
nobody."""


class Settings(NamedTuple):
    """One laser's parameters as the compiled code takes them."""

    noise_m: float
    resolution_mm: float
    """0 = not rounded."""
    half_footprint: float
    """Half the footprint's width, in beams."""
    dropout: float
    intensity_noise: float
    mode: int
    strong_return: float


@compiled
def settings_of(row: Floats) -> Settings:
    """The settings that `np.array(settings)` holds."""
    return Settings(row[0], row[1], row[2], row[3], row[4], int(row[5]), row[6])


@compiled
def decoded(code: float) -> float:
    """The range (m) that a raw number of the laser (mm, or a code below 20) stands for, as in REP 117."""
    if code >= FIRST_RANGE_MM:
        return code / 1000.0
    if code in (CODE_NO_RETURN, CODE_OTHER_FAR):
        return math.inf
    return math.nan


@compiled
def deviation(noise_m: float, distance_m: float) -> float:
    """Standard deviation of a range, m: constant up to 1 m, in proportion to the range beyond (data sheet)."""
    return noise_m * max(distance_m, 1.0)


@compiled
def find_edges(
    half_footprint: float,
    distances: Floats,
    surfaces: Ints,
    lasers: Floats,
    poses: Floats,
    shapes: Floats,
    rectangles: int,
    frames: Ints,
    beams: Floats,
    partners: Ints,
    shares: Floats,
) -> None:
    """Which beams have part of their footprint on the surface that a neighbouring beam hits.

    Fills `partners` (B,), the neighbouring beam or −1, and `shares` (B,), the part of the footprint there. The
    footprint counts as a strip of even brightness; an edge is where the nearer surface ends between two beams.
    """
    partners[:] = -1
    shares[:] = 0.0
    for i in range(BEAMS - 1):
        j = i + 1
        if surfaces[i] == surfaces[j] or abs(distances[i] - distances[j]) < MIXING_JUMP_M:
            continue
        left_ends = distances[i] < distances[j]
        k = i if left_ends else j
        row = k if len(lasers) > 1 else 0
        laser = (lasers[row, 0], lasers[row, 1], lasers[row, 2], lasers[row, 3])
        turn = turn_to_end(
            surfaces[k], left_ends, beams[0, k], beams[1, k], laser, poses[row], shapes, rectangles, frames
        )
        past = turn / STEP_RAD + (0.0 if left_ends else 1.0)
        if not -1e-6 <= past <= 1.0 + 1e-6:
            continue
        share = (half_footprint - past) / (2.0 * half_footprint)
        if share > shares[i]:
            partners[i], shares[i] = j, share
        share = (half_footprint - 1.0 + past) / (2.0 * half_footprint)
        if share > shares[j]:
            partners[j], shares[j] = i, share


@compiled
def light(
    distances: Floats,
    surfaces: Ints,
    lasers: Floats,
    poses: Floats,
    shapes: Floats,
    rectangles: int,
    frames: Ints,
    materials: Floats,
    beams: Floats,
    returns: Floats,
) -> None:
    """Fill `returns` (B,) with what comes back along the middle of each beam; 0 where nothing is in range."""
    known = -1
    is_disc, x, y = False, 0.0, 0.0
    for i in range(BEAMS):
        surface = surfaces[i]
        if surface < 0:
            returns[i] = 0.0
            continue
        if surface != known or len(lasers) > 1:
            row = i if len(lasers) > 1 else 0
            laser = (lasers[row, 0], lasers[row, 1], lasers[row, 2], lasers[row, 3])
            is_disc, x, y = slope(surface, laser, poses[row], shapes, rectangles, frames)
            known = surface
        cosine = cosine_of_incidence(is_disc, x, y, beams[0, i], beams[1, i])
        p = surface // 4
        returns[i] = returned(materials[p, 0], materials[p, 1], cosine, distances[i])


@compiled
def report(
    settings: Settings,
    distances: Floats,
    surfaces: Ints,
    lasers: Floats,
    poses: Floats,
    shapes: Floats,
    rectangles: int,
    frames: Ints,
    owners: Ints,
    beams: Floats,
    partners: Ints,
    shares: Floats,
    normals: Floats,
    draws: Ints,
    ranges: Floats,
    reading_owners: Ints,
    lit: Ints,
) -> None:
    """Fill `ranges` (B,) as in `Scan`, and the ground truth `reading_owners` (B,) and `lit` (N,).

    `draws` (2 B,) are whole numbers below 65536: one for the noise and one for the drop-out of each beam;
    the first twelve bits
    of the former choose one of the `normals` (4096,). A mixed reading belongs to the nearer of its two surfaces
    where it is close enough to it, else to nobody.
    """
    dropout = settings.dropout * 65536.0
    for i in range(BEAMS):
        own = owners[surfaces[i] // 4] if surfaces[i] >= 0 else NOBODY
        if own >= 0:
            lit[own] += 1
        reading_owners[i] = NOBODY
        true = distances[i]
        if draws[2 * i + 1] < dropout:
            ranges[i] = decoded(float(CODE_FAILED))
            continue
        if true == math.inf:
            ranges[i] = decoded(float(CODE_NO_RETURN))
            continue
        j = partners[i]
        middle = true
        if j >= 0 and distances[j] < math.inf:
            middle = true + shares[i] * (distances[j] - true)
        sigma = deviation(settings.noise_m, middle)
        reading = middle + sigma * normals[draws[2 * i] >> 4]
        if true < NEAREST_M or reading < NEAREST_M:
            ranges[i] = -math.inf
            continue
        if reading > FARTHEST_M:
            ranges[i] = decoded(float(CODE_NO_RETURN))
            continue
        if settings.resolution_mm > 0.0:
            steps = math.floor(1000.0 * reading / settings.resolution_mm + 0.5)
            reading = decoded(max(steps * settings.resolution_mm, float(FIRST_RANGE_MM)))
        ranges[i] = reading
        near = max(3.0 * sigma, SURFACE_TOLERANCE_M)
        if middle == true:
            if abs(reading - true) <= near:
                reading_owners[i] = own
            continue
        row = i if len(lasers) > 1 else 0
        laser = (lasers[row, 0], lasers[row, 1], lasers[row, 2], lasers[row, 3])
        x, y = reading * beams[0, i], reading * beams[1, i]
        here = away(surfaces[i], x, y, laser, poses[row], shapes, rectangles, frames)
        there = away(surfaces[j], x, y, laser, poses[row], shapes, rectangles, frames)
        if min(here, there) <= near:
            reading_owners[i] = own if here <= there else owners[surfaces[j] // 4]


@compiled
def report_light(
    settings: Settings,
    returns: Floats,
    partners: Ints,
    shares: Floats,
    normals: Floats,
    draws: Ints,
    ranges: Floats,
    intensities: Floats,
) -> None:
    """Fill `intensities` (B,) as in `Scan` and, where the mode costs ranges, take them from `ranges` (B,).

    - ideal: every beam has both;
    - half resolution: beams 0, 2, 4 … measure range, the beam to the left of each its intensity, and the driver
      reports the pair as one reading of the even beam; odd beams are nan;
    - strong code: a return of at least `strong_return` gives code 18 in place of a range (nan) and reads as that
      intensity, a lower bound; all other intensities are not given (nan).
    """
    for i in range(BEAMS):
        j = partners[i]
        middle = returns[i] + (shares[i] * (returns[j] - returns[i]) if j >= 0 else 0.0)
        intensities[i] = middle * max(1.0 + settings.intensity_noise * normals[draws[i] >> 4], 0.0)
    if settings.mode == HALF_RESOLUTION:
        for i in range(0, BEAMS, 2):
            intensities[i] = intensities[i + 1]
            ranges[i + 1] = math.nan
            intensities[i + 1] = math.nan
    for i in range(BEAMS):
        if settings.mode == STRONG_CODE:
            strong = intensities[i] >= settings.strong_return and not math.isnan(ranges[i])
            intensities[i] = settings.strong_return if strong else math.nan
            if strong:
                ranges[i] = decoded(float(CODE_STRONG_REFLECTOR))
        elif math.isnan(ranges[i]):
            intensities[i] = math.nan
