"""The herd stays together near the marker `origin`.

Source: Fine 2015, section 6.3.2 and table 6.1. Robots are allowed two thirds of the herd (section 7.3): there the
centroid is that of the group that holds together, in our reading. The start is no iteration.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from flocking.measures.fragments import gathers
from flocking.parameters import Parameter
from flocking.types import Floats
from generation.environment import Environment
from generation.markers import marker
from generation.primitives import Point

TABLE = "Fine 2015, table 6.1"
ITERATIONS = 500
SUCCESS = 1.0
ROBOTS_CONNECTIVITY = 2.0 / 3.0
"""Of robots: Fine 2015, section 7.3."""


class Parameters(NamedTuple):
    """What counts as corralled."""

    threshold_m: Annotated[float, Parameter("m", TABLE, published=True, low=1e-6)] = 25.0
    """Fragmentation threshold: longest link within a group; one unit is one metre."""
    radius_m: Annotated[float, Parameter("m", TABLE, published=True, low=0.0)] = 25.0
    """Farthest that the group's centroid is from `origin`."""
    consecutive: Annotated[int, Parameter("iterations", TABLE, published=True, low=1)] = 50
    connectivity: Annotated[
        float, Parameter("", f"{TABLE}; two thirds for robots (section 7.3)", published=True, low=0.0, high=1.0)
    ] = 1.0
    """Least share of the members in one group."""
    within: Annotated[int, Parameter("iterations", TABLE, published=True, low=1)] = ITERATIONS
    """Iterations that are looked at."""


def fitness(positions: Floats, environment: Environment, parameters: Parameters) -> float:
    """1 where the members (T, N, 2) stayed together near `origin` for so many consecutive iterations, else 0.

    Without that marker it is the origin of the frame, as in table 6.1.
    """
    at = marker(environment, "origin", "behaviour corralling", Point) if "origin" in environment.markers else Point()
    held = gathers(
        positions[1 : parameters.within + 1],
        parameters.threshold_m,
        (at.x_m, at.y_m),
        parameters.radius_m,
        parameters.connectivity,
        parameters.consecutive,
    )
    return float(held)
