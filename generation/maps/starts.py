"""Starts of a herd in pairs: one and its mirror image about the axis of the marker `start`.

In a workspace that is its own mirror image about that axis, whatever members do by chance they do as often the other
way round: what is left is the construct's. Metres and radians, world frame.
"""

from __future__ import annotations

import math

import numpy as np

from flocking.errors import InputError
from flocking.types import Floats
from generation.environment import START, Environment
from generation.free_space import clearance
from generation.primitives import Point


def pair(count: int, size_m: float, spread_rad: float, start: Point, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Two starts (count, 3): uniformly in a square about a marker, headings within ± the spread; and its mirror image."""
    places = size_m * rng.uniform(-0.5, 0.5, (count, 2))
    headings = rng.uniform(-spread_rad, spread_rad, count)
    c, s = math.cos(start.heading_rad), math.sin(start.heading_rad)
    found = []
    for side in (1.0, -1.0):
        x, y = places[:, 0], side * places[:, 1]
        found.append(
            np.column_stack([start.x_m + c * x - s * y, start.y_m + s * x + c * y, start.heading_rad + side * headings])
        )
    return found[0], found[1]


def start_of(workspace: Environment, size_m: float) -> Point:
    """The marker where a herd starts. Raises `InputError` where there is none, or where its square meets walls."""
    start = workspace.markers.get(START, Point())
    if not isinstance(start, Point):
        raise InputError(f"marker {START!r} is no point: expected a point with a direction")
    half = size_m / 2.0
    ticks = np.linspace(-half, half, 9)
    x, y = (axis.ravel() for axis in np.meshgrid(ticks, ticks))
    c, s = math.cos(start.heading_rad), math.sin(start.heading_rad)
    places = np.column_stack([start.x_m + c * x - s * y, start.y_m + s * x + c * y])
    walls = workspace.walls()
    if len(walls) and (clearance(workspace.faces(), places) <= 0.0).any():
        raise InputError(
            f"a start in a square of {size_m:g} m about ({start.x_m:g}, {start.y_m:g}) m meets a wall: expected a smaller one"
        )
    return start
