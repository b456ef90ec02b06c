"""The database of members: how one looks to an ideal laser, from every distance and side (made, not drawn).

The member's own model is scanned with MuJoCo's rays at the laser's height, at a grid of distances and
headings, and each scan is resampled as the segments of a real one are. Shapes that do not differ are kept
once: a round silhouette looks the same from every side, so few remain.
"""

from __future__ import annotations

import math
from functools import lru_cache

import mujoco
import numpy as np

from flocking.errors import InputError
from flocking.types import Floats
from sensing.segments import beam_directions, shape_of
from sensing.slice import slice_at
from sensing.warping import nearest_shape, warp_rows

DISTANCES = 6
"""From two alike that touch, outline to outline, to the laser's range, evenly in the logarithm; choice."""
FARTHEST_M = 5.6
"""m; P: URG-04LX-UG01 data sheet."""
HEADINGS = 24
"""Sides from which a member is seen, 15 degrees apart; choice."""
SAME_M = 0.003
"""A shape that costs at most this much against one already kept adds nothing: a tenth of the data sheet's 30
mm;
choice."""
ROOT = 1
"""Body of the one robot in its model: the first after the world."""


def make_templates(member_model: mujoco.MjModel, height_m: float, step_rad: float, samples: int, band: int) -> Floats:
    """Shapes (K, S, 2), m, of the one robot in `member_model` cut `height_m` above the floor.

    `step_rad` is the angle between the laser's beams; `samples` is S, `band` that of the warping. Raises
    InputError if the plane at that height meets nothing of the robot.
    """
    return _templates(member_model, height_m, step_rad, samples, band).copy()


@lru_cache(maxsize=16)
def _templates(model: mujoco.MjModel, height_m: float, step_rad: float, samples: int, band: int) -> Floats:
    radius = float(slice_at(model, height_m, [ROOT]).silhouette_radii([ROOT], model)[0])
    if not radius > 0.0:
        raise InputError(f"member model: nothing {height_m:g} m above the floor, so it cannot be recognised")
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    kept = np.empty((0, samples, 2))
    rows = warp_rows(samples)
    for distance in np.geomspace(2.0 * radius, max(FARTHEST_M, 3.0 * radius), DISTANCES):
        for side in np.arange(HEADINGS) * (2.0 * math.pi / HEADINGS):
            shape = _shape_seen(model, data, height_m, radius, float(distance), side, step_rad, samples)
            if shape is not None and nearest_shape(shape, kept, band, SAME_M, SAME_M, rows) > SAME_M:
                kept = np.concatenate((kept, shape[None]))
    return kept


def cast_rays(model: mujoco.MjModel, data: mujoco.MjData, origin: Floats, directions: Floats) -> Floats:
    """Distances (B,), m, from `origin` (3,) along unit vectors (B, 3) to the nearest visible geom; inf =
    none."""
    count = len(directions)
    geoms, distances = np.empty(count, np.int32), np.empty(count)
    mujoco.mj_multiRay(
        model, data, np.asarray(origin, dtype=np.float64), np.ascontiguousarray(directions).reshape(-1), None, 1, -1,
        geoms, distances, None, count, mujoco.mjMAXVAL,
    )  # fmt: skip
    return np.where(geoms < 0, np.inf, distances)


def _shape_seen(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    height_m: float,
    radius: float,
    distance: float,
    side: float,
    step_rad: float,
    samples: int,
) -> Floats | None:
    """The member as seen from `distance` (m, to its origin), by a laser in direction `side` of it (rad)."""
    beams = math.ceil(math.asin(radius / distance) / step_rad)
    directions = beam_directions(step_rad * np.arange(-beams, beams + 1.0), side + math.pi)
    laser = np.array([*data.xpos[ROOT][:2], height_m])
    laser[:2] += distance * math.cos(side), distance * math.sin(side)
    ranges = cast_rays(model, data, laser, np.column_stack((directions, np.zeros(len(directions)))))
    readings = np.flatnonzero(np.isfinite(ranges))
    if not len(readings):
        return None
    points = np.where(np.isfinite(ranges), ranges, 0.0)[:, None] * directions
    shape = np.empty((samples, 2))
    shape_of(points, readings, 0, len(readings), 0.0, 0.0, shape)
    return shape
