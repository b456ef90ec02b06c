"""Stochastic Influence Right Turn: a wall that grows step by step, by rules with probabilities.

Source: Fine 2015, section 8.1.2, algorithm 7: rule 1 goes along x, rule 2 along y, rule 3 along both. Two readings: the
loop as printed makes k - 1 steps where k is said to be the number of iterations, here it is k; and the wall begins at
its anchor, which the algorithm leaves out of the list of places.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from flocking.errors import InputError
from flocking.parameters import Parameter
from generation.environment import Environment
from generation.primitives import Polyline
from generation.workspaces import anchor, built, t_junction

SECTION = "Fine 2015, algorithm 7; the value is a choice"
FILTER = ""
BEHAVIOUR = "turn-right"


class Parameters(NamedTuple):
    """By default as long and as steep on average as the wall of dirt: 2.5 m towards the near left."""

    iterations: Annotated[int, Parameter("", SECTION, low=1, high=1000)] = 12
    x_m: Annotated[float, Parameter("m", SECTION, low=-1.0, high=1.0)] = -0.2
    """Step of rules 1 and 3 along x."""
    y_m: Annotated[float, Parameter("m", SECTION, low=-1.0, high=1.0)] = -0.2
    """Step of rules 2 and 3 along y."""
    rule_1: Annotated[float, Parameter("", SECTION, low=0.0, high=1.0)] = 0.2
    """Probability of rule 1."""
    rule_2: Annotated[float, Parameter("", SECTION, low=0.0, high=1.0)] = 0.2
    """Probability of rule 2. What is left to one is that of rule 3."""
    anchor: Annotated[int, Parameter("", SECTION, low=1, high=4)] = 4
    """Number of the anchor that the wall is fixed to."""


def workspace() -> Environment:
    """The T-junction of dirt."""
    return t_junction()


def generate(parameters: Parameters, workspace: Environment, rng: np.random.Generator) -> Environment:
    """The workspace with the wall: one number is drawn for each step.

    Raises `InputError` for an anchor that the workspace lacks, and for probabilities that add up to more than one.
    """
    first, second = parameters.rule_1, parameters.rule_2
    if first + second > 1.0 + 1e-9:
        raise InputError(f"rule_1 + rule_2 = {first + second:g}: expected at most 1, as rule 3 has what is left")
    drawn = rng.random(parameters.iterations)
    along_x = (drawn < first) | (drawn >= first + second)
    along_y = drawn >= first
    steps = np.column_stack([along_x * parameters.x_m, along_y * parameters.y_m])
    places = np.vstack([np.zeros(2), np.cumsum(steps, axis=0)]) + anchor(workspace, parameters.anchor)
    moved = np.concatenate([[True], np.any(np.diff(places, axis=0) != 0.0, axis=1)])
    if moved.sum() < 2:
        return workspace
    return built(workspace, Polyline(tuple((float(x), float(y)) for x, y in places[moved])))
