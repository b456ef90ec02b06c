"""The database of members: how one looks to an ideal laser, from every distance and side, computed from its model.

The member's own model is scanned with MuJoCo's rays at the laser's height, at a grid of distances and headings, and
each scan is resampled as the segments of a real one are. A segment is held against the shapes seen from about its
own distance only. Shapes that do not differ are kept once: a round silhouette looks the same from every side, so that
one shape remains for each distance.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import mujoco
import numpy as np

from flocking.compilation import borrowing
from flocking.errors import InputError
from flocking.types import Floats, Ints
from sensing.laser.slice import slice_at
from sensing.shapes.segments import beam_directions, shape_of
from sensing.shapes.warping import nearest_shape, warp_rows

DISTANCES = 8
"""How many, evenly in the logarithm, from where the outlines of two members touch to the laser's range; choice."""
FARTHEST_M = 5.6
"""m; P: URG-04LX-UG01 data sheet."""
HEADINGS = 24
"""Sides from which a member is seen, 15 degrees apart; choice."""
SAME_M = 0.003
"""A shape is left out whose warping cost to one already kept from the same distance is at most this: a tenth of the
data sheet's 30 mm; choice."""
ROOT = 1
"""Body of the one robot in its model: the first after the world."""


class Templates(NamedTuple):
    """K shapes in groups by distance, the nearest first."""

    shapes: Floats
    """(K, S, 2) m, as `shape_of` makes them."""
    starts: Ints
    """(D + 1,): group g is `shapes[starts[g]:starts[g + 1]]`."""
    limits_m: Floats
    """(D − 1,) distance between laser and mean of the shape at which one group follows the other."""


@borrowing
def group_at(distance_m: float, limits_m: Floats) -> int:
    """The group of templates seen from about `distance_m`, from the laser to the mean of the segment."""
    group = 0
    while group < len(limits_m) and distance_m > limits_m[group]:
        group += 1
    return group


@lru_cache(maxsize=16)
def make_templates(
    member_model: mujoco.MjModel, height_m: float, step_rad: float, samples: int, band: int
) -> Templates:
    """Shapes of the one robot in `member_model` cut `height_m` above the floor; not to be written to.

    `step_rad` is the angle between the laser's beams; `samples` is S, `band` that of the warping. Raises InputError
    if the plane at that height meets nothing of the robot.
    """
    radius = float(slice_at(member_model, height_m, [ROOT]).silhouette_radii([ROOT], member_model)[0])
    if not radius > 0.0:
        raise InputError(f"member model: nothing {height_m:g} m above the floor, so it cannot be recognised")
    data = mujoco.MjData(member_model)
    mujoco.mj_kinematics(member_model, data)
    rows = warp_rows(samples)
    groups, ranges = [], []
    for distance in np.geomspace(2.0 * radius, max(FARTHEST_M, 3.0 * radius), DISTANCES):
        kept, means = np.empty((0, samples, 2)), []
        for side in np.arange(HEADINGS) * (2.0 * math.pi / HEADINGS):
            shape, mean = _seen(member_model, data, height_m, radius, float(distance), side, step_rad, samples)
            means.append(mean)
            if mean < math.inf and nearest_shape(shape, kept, band, SAME_M, SAME_M, rows) > SAME_M:
                kept = np.concatenate((kept, shape[None]))
        if len(kept):
            groups.append(kept)
            ranges.append(float(np.min(means)))
    starts = np.cumsum([0] + [len(kept) for kept in groups])
    limits = np.sqrt(np.array(ranges[1:]) * np.array(ranges[:-1]))
    return Templates(np.concatenate(groups), starts.astype(np.int64), limits)


def cast_rays(model: mujoco.MjModel, data: mujoco.MjData, origin: Floats, directions: Floats) -> Floats:
    """Distances (B,), m, from `origin` (3,) along unit vectors (B, 3) to the nearest visible geom; inf = none."""
    count = len(directions)
    geoms, distances = np.empty(count, np.int32), np.empty(count)
    mujoco.mj_multiRay(
        model, data, np.asarray(origin, dtype=np.float64), np.ascontiguousarray(directions).reshape(-1), None, 1, -1,
        geoms, distances, None, count, mujoco.mjMAXVAL,
    )  # fmt: skip
    return np.where(geoms < 0, np.inf, distances)


def _seen(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    height_m: float,
    radius: float,
    distance: float,
    side: float,
    step_rad: float,
    samples: int,
) -> tuple[Floats, float]:
    """The member seen from `distance` (m, to its origin) by a laser in direction `side` of it (rad).

    Returns its shape and the distance (m) of its mean; inf where no beam meets it.
    """
    beams = math.ceil(math.asin(radius / distance) / step_rad)
    directions = beam_directions(step_rad * np.arange(-beams, beams + 1.0), side + math.pi)
    laser = np.array([*data.xpos[ROOT][:2], height_m])
    laser[:2] += distance * math.cos(side), distance * math.sin(side)
    ranges = cast_rays(model, data, laser, np.column_stack((directions, np.zeros(len(directions)))))
    readings = np.flatnonzero(np.isfinite(ranges))
    shape = np.zeros((samples, 2))
    if not len(readings):
        return shape, math.inf
    points = np.where(np.isfinite(ranges), ranges, 0.0)[:, None] * directions
    return shape, shape_of(points, readings, 0, len(readings), 0.0, 0.0, shape)
