"""Environments with at least so many terminal shapes.

Source: Fine 2015, table 7.1 (splitting). Each primitive of the construct is one terminal shape.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from generation.environment import Environment


class Parameters(NamedTuple):
    """How many."""

    least: Annotated[int, Parameter("", "Fine 2015, table 7.1", published=True, low=0)] = 3


def passes(environment: Environment, parameters: Parameters) -> bool:
    """Whether its construct has so many primitives."""
    return len(environment.construct) >= parameters.least
