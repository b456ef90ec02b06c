"""An environment: a workspace, the construct that was generated for it, and markers.

Source: Fine 2015, section 5.4: a construct is the geometry that a schema generates, and an environment is what comes of
it in a given workspace. Only terminal shapes are in it: whatever a grammar needed besides is not built (section 6.3.1).
Markers are no walls; behaviours read them. Metres and radians, world frame.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from flocking.types import Floats
from generation.primitives import (
    Arc,
    Circle,
    Point,
    Polygon,
    Polyline,
    Primitive,
    Segment,
    is_fence,
    segments,
)

Mark = Point | Primitive
REFLECTANCE = 0.8
"""Diffuse albedo of walls: white paint. A choice."""
START = "start"
"""The marker at which a herd starts, by convention: a point with a direction."""


@dataclass(frozen=True)
class Environment:
    """Walls that steer a herd. Checked by `generation.checking.checked` where they come from outside."""

    workspace: tuple[Primitive, ...] = ()
    """What stands there already."""
    construct: tuple[Primitive, ...] = ()
    """What was generated, and has to be built."""
    markers: Mapping[str, Mark] = field(default_factory=dict)
    """Places, lines and areas by name, as `start` (a point), `goal` or `origin`."""
    reflectance: float = REFLECTANCE
    """Diffuse albedo of all walls, 0 to 1."""
    origin: Mapping[str, Any] = field(default_factory=dict)
    """Where it comes from: schema, parameters, seed, or the file that was imported. Told, never read."""

    @property
    def primitives(self) -> tuple[Primitive, ...]:
        """Workspace and construct."""
        return (*self.workspace, *self.construct)

    def walls(self) -> Floats:
        """(W, 4) all straight pieces x0, y0, x1, y1, those of the workspace first."""
        return _joined(self.primitives)

    def faces(self) -> Floats:
        """(K, 4) the pieces that have free space on one side alone: on the left, seen from their start."""
        return _joined(primitive for primitive in self.primitives if not is_fence(primitive))

    def fences(self) -> Floats:
        """(F, 4) the pieces that have free space on both sides."""
        return _joined(primitive for primitive in self.primitives if is_fence(primitive))

    def construct_walls(self) -> Floats:
        """(C, 4) the straight pieces of the construct."""
        return _joined(self.construct)

    def fence_length(self) -> float:
        """Length of fence that the construct needs, m: the sum of all its pieces."""
        walls = self.construct_walls()
        return float(np.hypot(walls[:, 2] - walls[:, 0], walls[:, 3] - walls[:, 1]).sum())

    def in_workspace(self, workspace: Iterable[Primitive], markers: Mapping[str, Mark] | None = None) -> Environment:
        """Itself with these primitives as its workspace, and with these markers beside its own."""
        return dataclasses.replace(self, workspace=tuple(workspace), markers={**(markers or {}), **self.markers})

    def moved(self, scale: float = 1.0, turn_rad: float = 0.0, x_m: float = 0.0, y_m: float = 0.0) -> Environment:
        """Itself scaled about the origin, then turned about it, then shifted."""

        def move(mark: Any) -> Any:
            return moved(mark, scale, turn_rad, x_m, y_m)

        return dataclasses.replace(
            self,
            workspace=tuple(move(primitive) for primitive in self.workspace),
            construct=tuple(move(primitive) for primitive in self.construct),
            markers={name: move(mark) for name, mark in self.markers.items()},
        )


def moved(mark: Mark, scale: float, turn_rad: float, x_m: float, y_m: float) -> Mark:
    """A primitive or point scaled about the origin, turned about it, and shifted."""
    c, s = math.cos(turn_rad), math.sin(turn_rad)

    def at(x: float, y: float) -> tuple[float, float]:
        return scale * (c * x - s * y) + x_m, scale * (s * x + c * y) + y_m

    match mark:
        case Point(x, y, heading):
            return Point(*at(x, y), heading + turn_rad)
        case Segment(x0, y0, x1, y1):
            return Segment(*at(x0, y0), *at(x1, y1))
        case Polyline(points):
            return Polyline(tuple(at(*point) for point in points))
        case Polygon(corners, free):
            return Polygon(tuple(at(*corner) for corner in corners), free)
        case Circle(x, y, radius, free):
            return Circle(*at(x, y), scale * radius, free)
        case Arc(x, y, radius, start, turn):
            return Arc(*at(x, y), scale * radius, start + turn_rad, turn)
    raise TypeError(f"{mark!r} is no primitive")


def _joined(primitives: Iterable[Primitive]) -> Floats:
    primitives = tuple(primitives)
    if all(type(primitive) is Segment for primitive in primitives):  # what most constructs are, in one go
        return np.array(primitives, dtype=np.float64).reshape(-1, 4)
    return np.ascontiguousarray(np.concatenate([np.empty((0, 4)), *map(segments, primitives)]))
