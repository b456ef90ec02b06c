"""Deterministic Influence Right Turn: one straight wall at a T-junction.

Source: Fine 2015, section 7.4.1, algorithm 6 and figure 7.8a. Angles are mathematical: counter-clockwise from x.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from flocking.parameters import Parameter
from generation.environment import Environment
from generation.workspaces import anchor, built, t_junction, wall

SECTION = "Fine 2015, section 7.4"
FILTER = ""
BEHAVIOUR = "turn-right"


class Parameters(NamedTuple):
    """The wall: algorithm 6. By default the middle of the region that figure 7.11 shows."""

    angle_deg: Annotated[float, Parameter("deg", f"{SECTION}; the bounds are a full turn", low=0.0, high=360.0)] = 225.0
    length_m: Annotated[float, Parameter("m", f"{SECTION}; the bounds are a choice", low=0.0, high=4.0)] = 2.5
    anchor: Annotated[int, Parameter("", f"{SECTION}, figure 7.10", low=1, high=4)] = 4
    """Number of the anchor that the wall is fixed to."""


def workspace() -> Environment:
    """The T-junction of figure 7.9."""
    return t_junction()


def generate(parameters: Parameters, workspace: Environment, rng: np.random.Generator) -> Environment:
    """The workspace with the wall; nothing is drawn. A wall without length is none.

    Raises `InputError` for an anchor that the workspace lacks.
    """
    place = anchor(workspace, parameters.anchor)
    if parameters.length_m == 0.0:
        return workspace
    return built(workspace, wall(place, parameters.angle_deg, parameters.length_m))
