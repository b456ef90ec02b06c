"""The herd draws itself into a line along y: its standard deviation along x falls.

Source: Fine 2015, section 7.4.2 and figure 7.14, which plots the deviation itself. The fitness is ours: the share of
the deviation at the start that is gone at the end, so 1 on a line, 0.5 where it was halved, and 0 where it did not fall
or where there was none (a member alone).
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from flocking.types import Floats
from generation.environment import Environment

ITERATIONS = 200
"""A choice: as of the turn right."""
SUCCESS = 0.5
"""A choice: half as wide as at the start."""


class Parameters(NamedTuple):
    """How long members have."""

    within: Annotated[int, Parameter("iterations", "a choice, as of ITERATIONS", low=1)] = ITERATIONS
    """The iteration at which the deviation is taken; the last one of a shorter simulation."""


def x_deviation(positions: Floats) -> Floats:
    """(T,) standard deviation of the members (T, N, 2) along x, m: of all members, hence over N."""
    found: Floats = positions[..., 0].std(axis=-1)
    return found


def fitness(positions: Floats, environment: Environment, parameters: Parameters) -> float:
    """Share of the deviation of the members (T, N, 2) along x that is gone at the end, from 0 to 1."""
    start, end = x_deviation(positions[: parameters.within + 1][[0, -1]])
    return float(max(1.0 - end / start, 0.0)) if start > 0.0 else 0.0
