"""Primitives: the geometric shapes that an environment is made of, with bounded attributes.

Source: Fine 2015, section 5.4, definition 1: a primitive is a finite set of continuous or discrete attributes that
define a shape. Metres and radians, world frame; angles counter-clockwise from the x axis.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from flocking.parameters import Parameter
from flocking.types import Floats

MOST_M = 1e6
"""Largest coordinate, m. A choice: far beyond any world, and far below where metres lose their millimetres."""
MOST_CORNERS = 100_000
"""Most corners of one polyline or polygon. A choice."""
SAGITTA_M = 0.001
"""How far the pieces of a straightened arc or circle lie from it at the most, m. A choice: the laser's resolution."""
COARSEST, FINEST = 8, 360
"""Fewest and most pieces of a full circle. A choice."""

_AT = Parameter("m", "Fine 2015, section 5.4, definition 1; the bounds are a choice", low=-MOST_M, high=MOST_M)
_LENGTH = Parameter("m", "likewise", low=1e-6, high=MOST_M)
_ANGLE = Parameter("rad", "likewise", low=-4.0 * math.pi, high=4.0 * math.pi)

INSIDE, OUTSIDE, BOTH = SIDES = ("inside", "outside", "both")
"""Where the free space of a closed primitive lies: inside of a room, outside of a solid, on both sides of a fence."""


class Point(NamedTuple):
    """A place, with a direction where that matters: for markers only, as no robot can meet it."""

    x_m: Annotated[float, _AT] = 0.0
    y_m: Annotated[float, _AT] = 0.0
    heading_rad: Annotated[float, _ANGLE] = 0.0


class Segment(NamedTuple):
    """A straight fence between two places."""

    x0_m: Annotated[float, _AT] = 0.0
    y0_m: Annotated[float, _AT] = 0.0
    x1_m: Annotated[float, _AT] = 1.0
    y1_m: Annotated[float, _AT] = 0.0


class Polyline(NamedTuple):
    """A fence through at least two places, open."""

    points_m: tuple[tuple[float, float], ...] = ((0.0, 0.0), (1.0, 0.0))


class Polygon(NamedTuple):
    """A closed shape with at least three corners, in either sense of rotation."""

    corners_m: tuple[tuple[float, float], ...] = ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))
    free: Annotated[
        str, Parameter("", "a choice: free space lies inside a room, outside a solid, on both sides of a fence",
                       choices=SIDES)
    ] = OUTSIDE  # fmt: skip


class Circle(NamedTuple):
    """A circle."""

    x_m: Annotated[float, _AT] = 0.0
    y_m: Annotated[float, _AT] = 0.0
    radius_m: Annotated[float, _LENGTH] = 1.0
    free: Annotated[str, Parameter("", "as of a polygon", choices=SIDES)] = OUTSIDE


class Arc(NamedTuple):
    """A fence along a part of a circle, counter-clockwise from its first angle through `turn_rad`."""

    x_m: Annotated[float, _AT] = 0.0
    y_m: Annotated[float, _AT] = 0.0
    radius_m: Annotated[float, _LENGTH] = 1.0
    start_rad: Annotated[float, _ANGLE] = 0.0
    turn_rad: Annotated[float, Parameter("rad", "likewise", low=1e-6, high=2.0 * math.pi)] = math.pi


Primitive = Segment | Polyline | Polygon | Circle | Arc
KINDS: dict[str, Any] = {
    "segment": Segment, "polyline": Polyline, "polygon": Polygon, "circle": Circle, "arc": Arc,
}  # fmt: skip
"""The primitives by the names that they have in a file."""


def kind_of(primitive: Primitive | Point) -> str:
    """The name that a primitive has in a file; `point` of a marker's point."""
    return type(primitive).__name__.lower()


def places(primitive: Primitive) -> Floats:
    """(K + 1, 2) places along a primitive, straightened where it is round; the first again at the end of a closed one.

    A polygon or circle with free space inside runs counter-clockwise, any other clockwise: free space lies on the left.
    """
    if isinstance(primitive, Segment):
        return np.array([[primitive.x0_m, primitive.y0_m], [primitive.x1_m, primitive.y1_m]])
    if isinstance(primitive, Polyline):
        return np.array(primitive.points_m, dtype=np.float64).reshape(-1, 2)
    if isinstance(primitive, Arc):
        return _round(primitive.x_m, primitive.y_m, primitive.radius_m, primitive.start_rad, primitive.turn_rad)
    if isinstance(primitive, Circle):
        corners = _round(primitive.x_m, primitive.y_m, primitive.radius_m, 0.0, 2.0 * math.pi)[:-1]
    else:
        corners = np.array(primitive.corners_m, dtype=np.float64).reshape(-1, 2)
    x, y = corners.T
    counter_clockwise = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)) > 0.0
    if counter_clockwise != (primitive.free == INSIDE):
        corners = corners[::-1]
    return np.vstack([corners, corners[:1]])


def segments(primitive: Primitive) -> Floats:
    """(K, 4) straight pieces x0, y0, x1, y1 of a primitive."""
    along = places(primitive)
    return np.ascontiguousarray(np.hstack([along[:-1], along[1:]]))


def is_fence(primitive: Primitive) -> bool:
    """Whether free space lies on both sides of a primitive."""
    return not isinstance(primitive, Polygon | Circle) or primitive.free == BOTH


def _round(x: float, y: float, radius: float, start: float, turn: float) -> Floats:
    """(K + 1, 2) places on a part of a circle, so many that no piece lies farther than `SAGITTA_M` from it."""
    widest = 2.0 * math.acos(max(1.0 - SAGITTA_M / radius, 0.0))
    whole = min(max(math.ceil(2.0 * math.pi / widest), COARSEST), FINEST)
    angles = start + np.linspace(0.0, turn, max(1, math.ceil(whole * turn / (2.0 * math.pi))) + 1)
    return np.column_stack([x + radius * np.cos(angles), y + radius * np.sin(angles)])
