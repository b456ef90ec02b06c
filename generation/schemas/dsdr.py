"""Deterministic Standard Deviation Reduction: two straight walls that face each other in a corridor.

Source: Fine 2015, section 7.4.1 and figure 7.8b; as algorithm 6, with two angles and two lengths. Which walls the
figure has is not said in words: one from each long wall of the corridor is our reading. Angles as in dirt.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from flocking.parameters import Parameter
from generation.environment import Environment
from generation.workspaces import anchor, built, corridor, wall

SECTION = "Fine 2015, section 7.4.1 and figure 7.8b; the value is a choice"
FILTER = ""
BEHAVIOUR = "reduce-x-deviation"


class Parameters(NamedTuple):
    """Both walls: by default a funnel. The bounds let each turn through the half of the plane where the corridor is."""

    left_deg: Annotated[float, Parameter("deg", SECTION, low=-90.0, high=90.0)] = 45.0
    left_m: Annotated[float, Parameter("m", SECTION, low=0.0, high=8.0)] = 6.0
    right_deg: Annotated[float, Parameter("deg", SECTION, low=90.0, high=270.0)] = 135.0
    right_m: Annotated[float, Parameter("m", SECTION, low=0.0, high=8.0)] = 6.0


def workspace() -> Environment:
    """A corridor with an anchor on either side."""
    return corridor()


def generate(parameters: Parameters, workspace: Environment, rng: np.random.Generator) -> Environment:
    """The workspace with both walls, the left one at anchor 1; nothing is drawn. A wall without length is none.

    Raises `InputError` for an anchor that the workspace lacks.
    """
    sides = ((1, parameters.left_deg, parameters.left_m), (2, parameters.right_deg, parameters.right_m))
    walls = [(anchor(workspace, number), angle, length) for number, angle, length in sides]
    return built(workspace, *(wall(*given) for given in walls if given[2] > 0.0))
