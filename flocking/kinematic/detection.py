"""Stage 2 of the kinematic herd: what each detection makes of the members in view, without noise. Compiled.

Source: Fine 2015, section 2.2. Members are discs seen by a laser that looks all around with the Hokuyo's steps; nearer
ones hide what is behind them.

- perfect: the centre of every member within range, hidden or not (global knowledge);
- member-based: the mean of a recognised member's readings; recognised = at least `FEWEST_BEAMS` readings, and at least
  `LEAST_SHOWN` of the beams that its disc would take unhidden;
- member-extrapolated: every reading of the recognised members;
- sensor-based: every reading that falls on a member.

A reading carries its member's heading, velocity and id, where the law reads them. Where only bearings are known, an
input stands at an assumed distance.
"""

from __future__ import annotations

import math
from enum import IntEnum

import numpy as np

from flocking.compilation import compiled
from flocking.types import Floats, Ints

BEAM_RAD = 2.0 * math.pi / 1024.0
"""Step from beam to beam (data sheet of the URG-04LX-UG01)."""
BEAMS = 1024
BEAM_X, BEAM_Y = np.cos(BEAM_RAD * np.arange(BEAMS)), np.sin(BEAM_RAD * np.arange(BEAMS))
FEWEST_BEAMS = 5
"""Fewer readings have no shape. (choice)"""
LEAST_SHOWN = 0.5
"""A member of which less than half is in view is not recognised by its shape. (choice)"""


class Detection(IntEnum):
    """The detections of section 2.2, and the perfect one."""

    PERFECT = 0
    MEMBER_BASED = 1
    MEMBER_EXTRAPOLATED = 2
    SENSOR_BASED = 3


@compiled
def beams_of(x: float, y: float, radius: float) -> tuple[int, int]:
    """First and last of the beams that an unhidden disc at (x, y) takes, counted on below 0 and beyond BEAMS."""
    bearing = math.atan2(y, x)
    half = math.asin(radius / math.hypot(x, y))
    return math.ceil((bearing - half) / BEAM_RAD), math.floor((bearing + half) / BEAM_RAD)


@compiled
def readings(positions: Floats, count: int, radius: float, sight: float, ranges: Floats, owners: Ints) -> None:
    """Fills `ranges` and `owners` (BEAMS,) with what beam k at bearing k·BEAM_RAD hits; owner −1 = nothing.

    `positions[:count]` are the centres of the discs, body frame. A disc that holds the focal member is not seen.
    """
    for b in range(BEAMS):
        ranges[b] = math.inf
        owners[b] = -1
    for j in range(count):
        x, y = positions[j, 0], positions[j, 1]
        d = math.hypot(x, y)
        if d <= radius or d - radius > sight:
            continue
        first, last = beams_of(x, y, radius)
        for k in range(first, last + 1):
            b = k % BEAMS
            along = x * BEAM_X[b] + y * BEAM_Y[b]
            across = y * BEAM_X[b] - x * BEAM_Y[b]
            reading = along - math.sqrt(max(0.0, radius * radius - across * across))
            if reading < ranges[b] and reading <= sight:
                ranges[b] = reading
                owners[b] = j


@compiled
def inputs(
    detection: int,
    positions: Floats,
    count: int,
    radius: float,
    sight: float,
    ranges: Floats,
    owners: Ints,
    points: Floats,
    sources: Ints,
) -> int:
    """Writes the inputs of a detection that is not perfect and returns their number.

    `points` (≥ BEAMS, 2) positions of the inputs; `sources` (≥ BEAMS,) the row of `positions` that each is of.
    """
    readings(positions, count, radius, sight, ranges, owners)
    if detection == Detection.SENSOR_BASED:
        found = 0
        for b in range(BEAMS):
            if owners[b] >= 0:
                points[found, 0], points[found, 1] = ranges[b] * BEAM_X[b], ranges[b] * BEAM_Y[b]
                sources[found] = owners[b]
                found += 1
        return found
    found = 0
    for j in range(count):
        if math.hypot(positions[j, 0], positions[j, 1]) <= radius:
            continue
        first = found
        lit, x, y = 0, 0.0, 0.0
        from_, to = beams_of(positions[j, 0], positions[j, 1], radius)
        for k in range(from_, to + 1):
            b = k % BEAMS
            if owners[b] == j:
                px, py = ranges[b] * BEAM_X[b], ranges[b] * BEAM_Y[b]
                points[found, 0], points[found, 1] = px, py
                sources[found] = j
                found += 1
                lit += 1
                x += px
                y += py
        if lit < FEWEST_BEAMS or lit < LEAST_SHOWN * (to - from_ + 1):
            found = first
        elif detection == Detection.MEMBER_BASED:
            points[first, 0], points[first, 1] = x / lit, y / lit
            found = first + 1
    return found
