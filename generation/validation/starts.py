"""Where the members of a herd start in an environment: drawn about its marker, in the free space around it.

Fine 2015 gives no starting square and no headings; both decide a great deal of what is then measured, so both are
parameters. Metres and radians, world frame.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from flocking.angles import wrapped
from flocking.errors import InputError
from flocking.parameters import Parameter
from flocking.types import Floats
from generation.environment import START, Environment
from generation.free_space import crossed, distance
from generation.primitives import Point

ORIGIN = "origin"
TRIES = 200
"""Draws of a whole herd's places, of which each member takes a free one, before a start is refused."""


class Starts(NamedTuple):
    """How starts are drawn: places in a square, turned with the marker, and headings about the marker's."""

    side_m: Annotated[float, Parameter("m", "our choice: side of the square", low=0.0)] = 30.0
    spread_rad: Annotated[
        float, Parameter("rad", "our choice: headings differ by up to so much from the marker's", low=0.0, high=math.pi)
    ] = math.pi
    apart_m: Annotated[float, Parameter("m", "our choice: least distance between members", low=0.0)] = 0.0
    clear_m: Annotated[float, Parameter("m", "our choice: least distance from walls", low=0.0)] = 0.0


def axis(environment: Environment) -> Point:
    """The place where a herd starts, with the direction of its axis.

    The marker `start`; where there is none the marker `origin`, and without that the origin of the frame, along x.
    """
    for name in (START, ORIGIN):
        mark = environment.markers.get(name)
        if isinstance(mark, Point):
            return mark
    return Point()


def poses(environment: Environment, count: int, starts: Starts, rng: np.random.Generator) -> Floats:
    """(count, 3) starting poses: each where the straight way from the marker crosses no wall, and clear of the others.

    Raises `InputError` where the free space about the marker is too small for them.
    """
    mark = axis(environment)
    centre = np.array([mark.x_m, mark.y_m])
    c, s = math.cos(mark.heading_rad), math.sin(mark.heading_rad)
    walls = environment.walls()
    found = np.empty((0, 2))
    for _ in range(TRIES):
        square = rng.uniform(-0.5, 0.5, (count, 2)) * starts.side_m
        places = centre + square @ np.array([[c, s], [-s, c]])
        if len(walls):
            free = ~crossed(walls, centre, places)
            if starts.clear_m > 0.0:
                free &= distance(walls, places) >= starts.clear_m
            places = places[free]
        if starts.apart_m > 0.0:
            for place in places:
                if len(found) == 0 or np.hypot(*(found - place).T).min() >= starts.apart_m:
                    found = np.vstack([found, place])
        else:
            found = np.vstack([found, places])
        if len(found) >= count:
            headings = mark.heading_rad + starts.spread_rad * rng.uniform(-1.0, 1.0, count)
            return np.column_stack([found[:count], wrapped(headings)])
    raise InputError(
        f"only {len(found)} of {count} members fit a square of side {starts.side_m:g} m about ({mark.x_m:g}, "
        f"{mark.y_m:g}) with no wall between; expected fewer, a smaller square, or a start in the open"
    )


def mirrored(poses_w: Floats, mark: Point) -> Floats:
    """Poses (N, 3) as a mirror on the axis through `mark` along its heading shows them."""
    c, s = math.cos(2.0 * mark.heading_rad), math.sin(2.0 * mark.heading_rad)
    x, y = poses_w[:, 0] - mark.x_m, poses_w[:, 1] - mark.y_m
    headings = wrapped(2.0 * mark.heading_rad - poses_w[:, 2])
    return np.column_stack([mark.x_m + c * x + s * y, mark.y_m + s * x - c * y, headings])
