"""The herd falls apart into groups of about the same size.

Source: Fine 2015, section 6.3.2 and table 6.1: the entropy of the groups' shares is at least 30 % of its maximum. Of
what that is the maximum, the document does not say: ln(number of groups) is our reading. Groups as in simple-split.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from flocking.measures.fragments import splits
from flocking.parameters import Parameter
from flocking.types import Floats
from generation.environment import Environment

TABLE = "Fine 2015, table 6.1"
ITERATIONS = 200
SUCCESS = 1.0


class Parameters(NamedTuple):
    """What counts as a balanced split."""

    threshold_m: Annotated[float, Parameter("m", TABLE, published=True, low=1e-6)] = 25.0
    """Fragmentation threshold: longest link within a group; one unit is one metre."""
    groups: Annotated[int, Parameter("", TABLE, published=True, low=2)] = 2
    """Fewest groups."""
    consecutive: Annotated[int, Parameter("iterations", TABLE, published=True, low=1)] = 5
    entropy: Annotated[float, Parameter("", TABLE, published=True, low=0.0, high=1.0)] = 0.3
    """Least entropy of the groups' shares, relative to ln(number of groups)."""
    within: Annotated[int, Parameter("iterations", TABLE, published=True, low=1)] = ITERATIONS
    """Iterations that are looked at."""


def fitness(positions: Floats, environment: Environment, parameters: Parameters) -> float:
    """1 where the members (T, N, 2) were in balanced groups for so many consecutive iterations, else 0."""
    at = positions[1 : parameters.within + 1]
    return float(splits(at, parameters.threshold_m, parameters.groups, parameters.entropy, parameters.consecutive))
