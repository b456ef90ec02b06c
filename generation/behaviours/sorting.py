"""Two classes of members part: one crosses the goal line, the other does not.

Source: Fine 2015, section 6.1.3, sorts cattle by sex and does not say how that is judged. The fitness is ours: the
difference between the shares of the two classes that crossed the marker `goal`; 0 where both crossed alike, 1 where one
crossed whole and the other not at all, whichever. Random turns of few members differ too: the control says by how much.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from flocking.errors import InputError
from flocking.measures.fragments import crossed, entered
from flocking.parameters import Parameter
from flocking.types import Floats
from generation.environment import Environment
from generation.markers import marker
from generation.primitives import Polygon, Segment

ITERATIONS = 400
"""A choice: at 0.1 m an iteration, twice the way from the start of the cattle schema to its goal line."""
SUCCESS = 0.8
"""A choice: nine in ten of either class on their side."""


class Parameters(NamedTuple):
    """Who is of which class."""

    first: Annotated[float, Parameter("", "a choice", low=0.0, high=1.0)] = 0.5
    """Share of the members that are of the first class: they come first."""
    within: Annotated[int, Parameter("iterations", "a choice, as of ITERATIONS", low=1)] = ITERATIONS
    """Iterations that are looked at."""


def fitness(positions: Floats, environment: Environment, parameters: Parameters) -> float:
    """How differently the classes of the members (T, N, 2) crossed the marker `goal`, a segment or a polygon.

    Raises `InputError` where one class has no member.
    """
    goal = marker(environment, "goal", "behaviour sorting", Segment, Polygon)
    looked_at = positions[: parameters.within + 1]
    count = round(parameters.first * positions.shape[1])
    if not 0 < count < positions.shape[1]:
        raise InputError(f"behaviour sorting: {count} of {positions.shape[1]} members are of the first class")
    there = crossed(looked_at, goal) if isinstance(goal, Segment) else entered(looked_at, np.array(goal.corners_m))
    return abs(float(there[:count].mean()) - float(there[count:].mean()))
