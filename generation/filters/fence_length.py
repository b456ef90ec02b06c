"""Environments whose construct needs at most so much fence.

Source: Fine 2015, section 6.2, which gives 100 metres as an example.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from generation.environment import Environment


class Parameters(NamedTuple):
    """How much there is."""

    most_m: Annotated[float, Parameter("m", "Fine 2015, section 6.2", published=True, low=0.0)] = 100.0


def passes(environment: Environment, parameters: Parameters) -> bool:
    """Whether the pieces of its construct are that long together at the most; 1e-9 of it is rounding."""
    return environment.fence_length() <= parameters.most_m * (1.0 + 1e-9)
