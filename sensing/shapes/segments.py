"""From a scan to segments: readings as points, split where consecutive readings are far apart.

Which readings count (codes of REP 117, as in `sensing.types.Scan`):
- a finite range is a reading;
- nan (an error of the sensor) says nothing: it is skipped, and the readings on its two sides are consecutive;
- inf and −inf (no return, too near) say that no surface was measured there: they split.

The distance that splits is the one between the two points, not between the two ranges. Its limit grows with the range
as the laser's noise does: otherwise a member that is whole at 1 m would fall to pieces at 4 m, or two near ones would
be taken for one.
"""

from __future__ import annotations

import math
from functools import lru_cache

import mujoco
import numpy as np

from flocking.compilation import borrowing
from flocking.errors import InputError
from flocking.types import Floats, Ints

EVEN_M = 1.0
"""Up to this range the noise is constant, beyond in proportion to it. S: URG-04LX-UG01 data sheet, ±30 mm up to 1 m,
then ±3 %."""
SITE = "laser"
"""The site of a robot's model that is its laser."""


@lru_cache(maxsize=16)
def laser_mount(model: mujoco.MjModel) -> tuple[float, float, float]:
    """Pose of the laser in the body frame of the robot that is alone in `model`: x, y (m) and yaw (rad).

    Raises InputError if no site is named `laser` (a prefix is allowed), or several are.
    """
    names = [model.site(k).name for k in range(model.nsite)]
    found = [k for k, name in enumerate(names) if name.rpartition("/")[2] == SITE]
    if len(found) != 1:
        raise InputError(f"model with sites {names}: expected exactly one named {SITE!r}")
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    root = model.body_rootid[model.site_bodyid[found[0]]]
    to_root = data.xmat[root].reshape(3, 3).T
    position = to_root @ (data.site_xpos[found[0]] - data.xpos[root])
    forward = to_root @ data.site_xmat[found[0]].reshape(3, 3)[:, 0]
    return float(position[0]), float(position[1]), math.atan2(forward[1], forward[0])


def beam_directions(angles: Floats, yaw: float = 0.0) -> Floats:
    """Unit vectors (B, 2) in the body frame of beams at `angles` (B,) rad in the laser's frame."""
    return np.ascontiguousarray(np.column_stack((np.cos(angles + yaw), np.sin(angles + yaw))))


@borrowing
def split(
    ranges: Floats,
    directions: Floats,
    mount_x: float,
    mount_y: float,
    split_m: float,
    points: Floats,
    readings: Ints,
    starts: Ints,
) -> tuple[int, int]:
    """Points of all readings and where each segment starts; returns (number of segments, number of readings).

    Writes into preallocated arrays: `points` (B, 2) m, body frame, one a beam; `readings` (B,) the beams that hold a
    reading, in order; `starts` (B + 1,): segment s is `readings[starts[s]:starts[s + 1]]`. The limit of the distance
    is `split_m`; beyond `EVEN_M`, `split_m / EVEN_M` times the nearer of the two ranges. It is inclusive.
    """
    segments, kept, silent = 0, 0, False
    last_x, last_y, last_range = 0.0, 0.0, 0.0
    for beam in range(len(ranges)):
        distance = ranges[beam]
        if not math.isfinite(distance):
            silent |= math.isinf(distance)
            continue
        x = mount_x + distance * directions[beam, 0]
        y = mount_y + distance * directions[beam, 1]
        gap = (x - last_x) * (x - last_x) + (y - last_y) * (y - last_y)
        limit = split_m * max(1.0, min(distance, last_range) / EVEN_M)
        if kept == 0 or silent or gap > limit * limit:
            starts[segments] = kept
            segments += 1
        points[beam, 0] = x
        points[beam, 1] = y
        readings[kept] = beam
        kept += 1
        last_x, last_y, last_range, silent = x, y, distance, False
    starts[segments] = kept
    return segments, kept


@borrowing
def shape_of(points: Floats, readings: Ints, start: int, end: int, x0: float, y0: float, shape: Floats) -> float:
    """The shape of the segment `readings[start:end]`, resampled to the rows of `shape` (S, 2), m.

    Time is stretched evenly: each of the S samples is the average of an equal share of the readings (weighted where
    a reading falls into two shares), so that a near member's many readings average their noise out, and the mean of
    the samples is the mean of the readings. Then the shape is moved to its mean and turned so that its first axis
    points away from the laser at (x0, y0): neither bearing nor distance remain, only form and size. Returns the
    distance (m) from the laser to the mean.
    """
    samples, count = len(shape), end - start
    share = count / samples
    mean_x, mean_y = 0.0, 0.0
    for k in range(samples):
        low, high = k * share, (k + 1) * share
        x, y, weights = 0.0, 0.0, 0.0
        i = int(low)
        while i < count and i < high - 1e-9:
            weight = min(high, i + 1.0) - max(low, float(i))
            x += weight * points[readings[start + i], 0]
            y += weight * points[readings[start + i], 1]
            weights += weight
            i += 1
        shape[k, 0] = x / weights
        shape[k, 1] = y / weights
        mean_x += shape[k, 0]
        mean_y += shape[k, 1]
    mean_x /= samples
    mean_y /= samples
    away_x, away_y = mean_x - x0, mean_y - y0
    length = math.hypot(away_x, away_y)
    if length > 0.0:
        away_x /= length
        away_y /= length
    else:
        away_x, away_y = 1.0, 0.0
    for k in range(samples):
        x, y = shape[k, 0] - mean_x, shape[k, 1] - mean_y
        shape[k, 0] = away_x * x + away_y * y
        shape[k, 1] = away_x * y - away_y * x
    return length
