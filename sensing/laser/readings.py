"""From exact distances to what the laser reports: mixed readings, noise, whole millimetres, codes. Compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from flocking.compilation import borrowing
from flocking.types import Floats, Ints
from sensing.laser.draws import Draws16
from sensing.laser.intensity import NEAREST_M, returned
from sensing.laser.planar import (
    BEAMS,
    COSINES,
    SINES,
    STEP_RAD,
    Places,
    Shapes,
    at_beam,
)
from sensing.laser.surfaces import away, cosine_of_incidence, slope, turn_to_end
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
"""How the laser reports intensity, in the order of `hokuyo.MODES`."""
MIXING_JUMP_M = 0.02
"""Between neighbouring beams whose surfaces' distances differ by less, no mixed reading is made. ?"""
SURFACE_TOLERANCE_M = 0.05
"""Ground truth: a reading belongs to nobody if it is farther from a member's surface than both this and three standard
deviations."""
NORMALS: NDArray[np.float32] = ndtri((np.arange(4096) + 0.5) / 4096).astype(np.float32)
"""(4096,) equally likely normal deviates, the middles of as many quantiles: the greatest is 3.7, their standard
deviation 0.9997. A deviate costs 12 random bits and no arithmetic, and the table fits the nearest cache."""


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


@borrowing
def settings_of(row: Floats) -> Settings:
    """The settings that `np.array(settings)` holds."""
    return Settings(row[0], row[1], row[2], row[3], row[4], int(row[5]), row[6])


@borrowing
def decoded(code: float) -> float:
    """The range (m) that a raw number of the laser (mm, or a code below 20) stands for, as in REP 117."""
    if code >= FIRST_RANGE_MM:
        return code / 1000.0
    if code in (CODE_NO_RETURN, CODE_OTHER_FAR):
        return math.inf
    return math.nan


@borrowing
def deviation(noise_m: float, distance_m: float) -> float:
    """Standard deviation of a range, m: constant up to 1 m, in proportion to the range beyond (data sheet)."""
    return noise_m * max(distance_m, 1.0)


class Hits(NamedTuple):
    """What the middle of each beam meets."""

    distances: Floats
    """(B,) exact, m; inf = nothing in range."""
    surfaces: Ints
    """(B,) number of the surface (`planar`); −1 = none."""


class Mixing(NamedTuple):
    """Which beams have part of their footprint on the surface that a neighbouring beam hits."""

    partners: Ints
    """(B,) the neighbouring beam; −1 = none."""
    shares: Floats
    """(B,) the part of the footprint there."""


@borrowing
def find_edges(half_footprint: float, hits: Hits, places: Places, shapes: Shapes, mixing: Mixing) -> None:
    """Fill `mixing`; half the footprint is given in beams, 0 = none.

    The footprint counts as a strip of even brightness; an edge is where the nearer surface ends between two beams.
    """
    partners, shares = mixing
    distances, surfaces = hits
    partners[:] = -1
    shares[:] = 0.0
    if not half_footprint > 0.0:
        return
    for i in range(BEAMS - 1):
        j = i + 1
        if surfaces[i] == surfaces[j] or abs(distances[i] - distances[j]) < MIXING_JUMP_M:
            continue
        left_ends = distances[i] < distances[j]
        k = i if left_ends else j
        laser, poses = at_beam(places, k)
        turn = turn_to_end(surfaces[k], left_ends, COSINES[k], SINES[k], laser, poses, shapes)
        past = turn / STEP_RAD + (0.0 if left_ends else 1.0)
        if not -1e-6 <= past <= 1.0 + 1e-6:
            continue
        share = (half_footprint - past) / (2.0 * half_footprint)
        if share > shares[i]:
            partners[i], shares[i] = j, share
        share = (half_footprint - 1.0 + past) / (2.0 * half_footprint)
        if share > shares[j]:
            partners[j], shares[j] = i, share


@borrowing
def light(hits: Hits, places: Places, shapes: Shapes, returns: Floats) -> None:
    """Fill `returns` (B,) with what comes back along the middle of each beam; 0 where nothing is in range."""
    known = -1
    is_disc, x, y = False, 0.0, 0.0
    for i in range(BEAMS):
        surface = hits.surfaces[i]
        if surface < 0:
            returns[i] = 0.0
            continue
        if surface != known or len(places.lasers) > 1:
            laser, poses = at_beam(places, i)
            is_disc, x, y = slope(surface, laser, poses, shapes)
            known = surface
        cosine = cosine_of_incidence(is_disc, x, y, COSINES[i], SINES[i])
        p = surface // 4
        returns[i] = returned(shapes.materials[p, 0], shapes.materials[p, 1], cosine, hits.distances[i])


@borrowing
def reported(settings: Settings, true: float, middle: float, noise: int, chance: int) -> float:
    """What the laser reports of a surface `true` m away where its footprint is `middle` m away in the mean.

    `noise` and `chance` are the beam's two draws. The branches that are not taken are computed as well, so that this
    runs for several beams at a time.
    """
    reading = middle + deviation(settings.noise_m, middle) * NORMALS[noise >> 4]
    value = reading
    if settings.resolution_mm > 0.0:
        steps = np.floor(1000.0 * reading / settings.resolution_mm + 0.5)
        value = max(steps * settings.resolution_mm, float(FIRST_RANGE_MM)) / 1000.0
    value = math.inf if reading > FARTHEST_M else value  # code 0
    value = -math.inf if true < NEAREST_M or reading < NEAREST_M else value
    value = math.inf if true == math.inf else value  # code 0
    return math.nan if chance < settings.dropout * 65536.0 else value  # code 16


@borrowing
def report(
    settings: Settings,
    hits: Hits,
    places: Places,
    shapes: Shapes,
    mixing: Mixing,
    draws: Draws16,
    ranges: Floats,
    reading_owners: Ints,
    lit: Ints,
) -> None:
    """Fill `ranges` (B,) as in `Scan`, and the ground truth `reading_owners` (B,) and `lit` (N,).

    `draws` (2 B,) are whole numbers below 65536: one for the noise and one for the drop-out of each beam; the first
    twelve bits of the former choose one of the `NORMALS`. A reading of a robot that lies too far off its surface
    belongs to nobody.
    """
    distances, surfaces = hits
    for i in range(BEAMS):
        ranges[i] = reported(settings, distances[i], distances[i], draws[2 * i], draws[2 * i + 1])
    lit[:] = 0
    start = 0
    while start < BEAMS:
        surface, end = surfaces[start], start + 1
        while end < BEAMS and surfaces[end] == surface:
            end += 1
        own = shapes.owners[surface // 4] if surface >= 0 else NOBODY
        reading_owners[start:end] = own
        if own >= 0:
            lit[own] += end - start
            for i in range(start, end):
                near = max(3.0 * deviation(settings.noise_m, distances[i]), SURFACE_TOLERANCE_M)
                if not abs(ranges[i] - distances[i]) <= near:
                    reading_owners[i] = NOBODY
        start = end
    for i in range(BEAMS):
        if mixing.partners[i] >= 0:
            _mix(i, settings, hits, places, shapes, mixing, draws, ranges, reading_owners)


@borrowing
def _mix(
    i: int,
    settings: Settings,
    hits: Hits,
    places: Places,
    shapes: Shapes,
    mixing: Mixing,
    draws: Draws16,
    ranges: Floats,
    reading_owners: Ints,
) -> None:
    """Report beam i, of which part falls on its partner's surface: a mixed reading.

    It belongs to the nearer of the two surfaces where it is close enough to it, else to nobody.
    """
    distances, surfaces = hits
    j, true = mixing.partners[i], distances[i]
    if true == math.inf or distances[j] == math.inf:
        return
    middle = true + mixing.shares[i] * (distances[j] - true)
    if middle == true:
        return
    reading_owners[i] = NOBODY
    ranges[i] = reported(settings, true, middle, draws[2 * i], draws[2 * i + 1])
    if not math.isfinite(ranges[i]):
        return
    laser, poses = at_beam(places, i)
    x, y = ranges[i] * COSINES[i], ranges[i] * SINES[i]
    here = away(surfaces[i], x, y, laser, poses, shapes)
    there = away(surfaces[j], x, y, laser, poses, shapes)
    near = max(3.0 * deviation(settings.noise_m, middle), SURFACE_TOLERANCE_M)
    if min(here, there) <= near:
        reading_owners[i] = shapes.owners[(surfaces[i] if here <= there else surfaces[j]) // 4]


@borrowing
def report_light(
    settings: Settings,
    returns: Floats,
    mixing: Mixing,
    draws: Draws16,
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
        j = mixing.partners[i]
        middle = returns[i] + (mixing.shares[i] * (returns[j] - returns[i]) if j >= 0 else 0.0)
        intensities[i] = middle * max(1.0 + settings.intensity_noise * NORMALS[draws[i] >> 4], 0.0)
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
