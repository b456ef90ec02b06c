"""Influence Turn Behaviour: one straight wall in an open field.

Source: Fine 2015, section 8.2, algorithm 8. The document's tasks have three to five walls: an environment of this
schema is a workspace for the next wall. Angles as in dirt.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from flocking.parameters import Parameter
from generation.environment import Environment
from generation.workspaces import anchor, built, field, wall

SECTION = "Fine 2015, algorithm 8; the value is a choice"
FILTER = ""
BEHAVIOUR = "turn-right"


class Parameters(NamedTuple):
    """The wall."""

    angle_deg: Annotated[float, Parameter("deg", SECTION, low=0.0, high=360.0)] = 45.0
    length_m: Annotated[float, Parameter("m", SECTION, low=0.05, high=6.0)] = 1.5
    anchor: Annotated[int, Parameter("", SECTION, low=1, high=9)] = 7
    """Number of the anchor that the wall is fixed to."""


def workspace() -> Environment:
    """A field with nine anchors and a goal area."""
    return field()


def generate(parameters: Parameters, workspace: Environment, rng: np.random.Generator) -> Environment:
    """The workspace with the wall; nothing is drawn. Raises `InputError` for an anchor that the workspace lacks."""
    return built(workspace, wall(anchor(workspace, parameters.anchor), parameters.angle_deg, parameters.length_m))
