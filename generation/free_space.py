"""Where the free space of an environment is: how far places are from walls, and which of them walls keep apart."""

from __future__ import annotations

import math

import numpy as np

from flocking.types import Floats

_AT_A_TIME = 1_000_000
"""Distances of points from pieces that are held at a time."""


def clearance(faces: Floats, points: Floats) -> Floats:
    """(N,) distance (m) of points (N, 2) from the nearest of the faces (K, 4): negative behind it, inf without any.

    Behind is on the right of a face, seen from its start to its end. Where two are equally near, as at a corner, a
    point is behind only if it is behind both.
    """
    found = np.full(len(points), math.inf)
    if len(faces) == 0:
        return found
    step = max(1, _AT_A_TIME // len(faces))
    for first in range(0, len(points), step):
        distances, sides = _apart(faces, points[first : first + step])
        nearest = distances.min(axis=1, keepdims=True)
        tied = distances - nearest <= 1e-9 * np.maximum(distances, 1.0)
        signed = np.where(sides >= 0.0, distances, -distances)
        found[first : first + step] = np.where(tied, signed, -math.inf).max(axis=1)
    return found


def distance(walls: Floats, points: Floats) -> Floats:
    """(N,) distance (m) of points (N, 2) from the nearest of the walls (K, 4), on whichever side; inf without any."""
    found = np.full(len(points), math.inf)
    step = max(1, _AT_A_TIME // max(1, len(walls)))
    for first in range(0, len(points) if len(walls) else 0, step):
        found[first : first + step] = _apart(walls, points[first : first + step])[0].min(axis=1)
    return found


def _apart(walls: Floats, points: Floats) -> tuple[Floats, Floats]:
    """(N, K) distances of points from walls, and on which side of each they are: positive on its left."""
    along = walls[:, 2:] - walls[:, :2]
    offsets = points[:, None] - walls[:, :2]
    share = np.clip((offsets * along).sum(axis=2) / (along * along).sum(axis=1), 0.0, 1.0)
    to_points = offsets - share[..., None] * along
    sides = along[:, 0] * offsets[..., 1] - along[:, 1] * offsets[..., 0]
    return np.hypot(to_points[..., 0], to_points[..., 1]), sides
