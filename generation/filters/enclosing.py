"""Environments that enclose the marker `origin`, but not wholly.

Source: Fine 2015, table 7.1 (corralling): the marker is within the convex hull of the terminal shapes, and a free path
leads from it to a place outside of the hull. Walls of the workspace stand in the way as well; the hull is that of the
construct.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import shapely

from flocking.parameters import Parameter
from generation.environment import Environment
from generation.free_paths import hull, is_within, reached
from generation.markers import marker
from generation.primitives import Point


class Parameters(NamedTuple):
    """Of the path."""

    width_m: Annotated[float, Parameter("m", "a choice: Fine 2015, table 7.1, has no width", low=0.0, high=1e4)] = 0.0
    """How wide it is; 0: a point's."""


def passes(environment: Environment, parameters: Parameters) -> bool:
    """Whether it encloses the marker and lets it out. Raises `InputError` without such a point."""
    at = marker(environment, "origin", "filter enclosing", Point)
    around = hull(environment.construct_walls())
    if not shapely.contains_xy(around, at.x_m, at.y_m):
        return False
    region = reached(environment.walls(), (at.x_m, at.y_m), parameters.width_m)
    return region is not None and not is_within(region, around)
