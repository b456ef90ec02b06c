"""An environment whose construct is not built exactly as drawn. Metres, world frame."""

from __future__ import annotations

import dataclasses

import numpy as np

from flocking.types import Floats
from generation.environment import Environment
from generation.primitives import Arc, Circle, Polygon, Polyline, Primitive, Segment


def perturbed(environment: Environment, ends_m: float, rng: np.random.Generator) -> Environment:
    """Each end and corner of the construct moved by up to `ends_m`, uniformly over a disc; the workspace stays.

    A primitive that begins where the one before it ended is moved there with it, so that no gap opens. Round ones are
    moved as a whole.
    """
    if ends_m == 0.0 or not environment.construct:
        return environment
    moved: list[Primitive] = []
    last: tuple[Floats, Floats] | None = None
    for primitive in environment.construct:
        match primitive:
            case Segment(x0, y0, x1, y1):
                ends, last = _shaken(np.array([[x0, y0], [x1, y1]]), ends_m, rng, last)
                moved.append(Segment(*ends.ravel().tolist()))
            case Polyline(points):
                ends, last = _shaken(np.array(points, dtype=np.float64), ends_m, rng, last)
                moved.append(Polyline(tuple((x, y) for x, y in ends.tolist())))
            case Polygon(corners, free):
                ends, last = np.array(corners) + _discs(len(corners), ends_m, rng), None
                moved.append(Polygon(tuple((x, y) for x, y in ends.tolist()), free))
            case Circle() | Arc():
                (dx, dy), last = _discs(1, ends_m, rng)[0].tolist(), None
                moved.append(primitive._replace(x_m=primitive.x_m + dx, y_m=primitive.y_m + dy))
    return dataclasses.replace(environment, construct=tuple(moved))


def _shaken(
    ends: Floats, radius_m: float, rng: np.random.Generator, last: tuple[Floats, Floats] | None
) -> tuple[Floats, tuple[Floats, Floats]]:
    """Places (K, 2) moved; and where the last of them was and is."""
    found = ends + _discs(len(ends), radius_m, rng)
    if last is not None and np.allclose(last[0], ends[0], rtol=0.0, atol=1e-9):
        found[0] = last[1]
    return found, (ends[-1], found[-1])


def _discs(count: int, radius_m: float, rng: np.random.Generator) -> Floats:
    """(count, 2) uniformly over a disc."""
    radii, angles = radius_m * np.sqrt(rng.random(count)), 2.0 * np.pi * rng.random(count)
    return np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])
