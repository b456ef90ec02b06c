"""Members cross the goal line, as the line behind the right turn of a junction.

Source: Fine 2015, section 7.4.2 and figure 7.9: 90 % of the herd. A member that has crossed the line counts, whatever
it does next; the fitness is the share of those. Any other goal does as well: the marker says where it is.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from flocking.measures.fragments import crossed, entered
from flocking.parameters import Parameter
from flocking.types import Floats
from generation.environment import Environment
from generation.markers import marker
from generation.primitives import Polygon, Segment

ITERATIONS = 200
"""A choice: at 0.1 m an iteration, two and a half times the way from the start of a T-junction to its goal line."""
SUCCESS = 0.9


class Parameters(NamedTuple):
    """How long members have."""

    within: Annotated[int, Parameter("iterations", "a choice, as of ITERATIONS", low=1)] = ITERATIONS
    """Iterations that are looked at."""


def fitness(positions: Floats, environment: Environment, parameters: Parameters) -> float:
    """Share of the members (T, N, 2) that crossed the marker `goal`, a segment, or were inside of it, a polygon."""
    goal = marker(environment, "goal", "behaviour turn-right", Segment, Polygon)
    looked_at = positions[: parameters.within + 1]
    if isinstance(goal, Segment):
        return float(crossed(looked_at, goal).mean())
    return float(entered(looked_at, np.array(goal.corners_m)).mean())
