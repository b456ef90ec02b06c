"""Environments in which the herd has room where it starts, and a free way to its goal or out.

The way leads from the marker `start` to the marker `goal` where there is one, else out of the hull of all walls.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
import shapely

from flocking.parameters import Parameter
from generation.environment import START, Environment
from generation.free_paths import hull, is_within, reached
from generation.markers import marker
from generation.primitives import Point, Polygon, Segment, places


class Parameters(NamedTuple):
    """Room for a Create (0.33 m wide) among others by default."""

    start_m: Annotated[float, Parameter("m", "a choice", low=0.0, high=1e4)] = 0.5
    """Radius of a disc at the start in which no wall stands."""
    width_m: Annotated[float, Parameter("m", "a choice", low=0.0, high=1e4)] = 0.4
    """Of the free way; 0: a point's."""


def passes(environment: Environment, parameters: Parameters) -> bool:
    """Whether there is such room and such a way. Raises `InputError` without a start, or for a goal that is a point."""
    at = marker(environment, START, "filter passage", Point)
    walls = environment.walls()
    if len(walls) == 0:
        return True
    pieces = shapely.linestrings(walls.reshape(-1, 2, 2))
    if shapely.distance(pieces, shapely.Point(at.x_m, at.y_m)).min() < parameters.start_m:
        return False
    region = reached(walls, (at.x_m, at.y_m), parameters.width_m)
    if region is None:
        return False
    if "goal" not in environment.markers:
        return not is_within(region, hull(walls))
    goal = marker(environment, "goal", "filter passage", Segment, Polygon)
    along = np.asarray(places(goal))
    shape = shapely.LineString(along) if isinstance(goal, Segment) else shapely.Polygon(along)
    return bool(region.intersects(shape))
