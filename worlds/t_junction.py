"""Three corridors that meet, closed at their ends, with a wall at the junction if wanted.

Source: Fine 2015, figure 7.9 and algorithm 6: the workspace of the schema `dirt`, and its wall. The herd starts in the
stem, along y, and faces the bar.
"""

from __future__ import annotations

import dataclasses
from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from generation.environment import Environment
from generation.workspaces import anchor, built, t_junction, wall

SECTION = "Fine 2015, section 7.4"


class Parameters(NamedTuple):
    """Of the junction and of its wall. By default the wall is in the middle of the region that figure 7.11 shows."""

    width_m: Annotated[float, Parameter("m", "a choice: of the corridors", low=0.5, high=100.0)] = 2.0
    wall: Annotated[bool, Parameter("", "whether there is one", plausible=())] = False
    angle_deg: Annotated[float, Parameter("deg", f"{SECTION}: of the wall", low=0.0, high=360.0)] = 225.0
    length_m: Annotated[float, Parameter("m", f"{SECTION}: of the wall", low=0.01, high=100.0)] = 2.5
    anchor: Annotated[int, Parameter("", f"{SECTION}, figure 7.10: that it is fixed to", low=1, high=4)] = 4
    reflectance: Annotated[float, Parameter("", "white paint, diffuse; a choice", low=0.01, high=1.0)] = 0.8


def environment(parameters: Parameters) -> Environment:
    """The junction, with its wall as the construct."""
    made = dataclasses.replace(t_junction(parameters.width_m), reflectance=parameters.reflectance)
    if not parameters.wall:
        return made
    return built(made, wall(anchor(made, parameters.anchor), parameters.angle_deg, parameters.length_m))
