"""A straight corridor along x, centred on the origin, without obstacles and closed at both ends.

Source: Fine 2015, section 2.3.1: "approximately seven robot diameters wide and long enough to be considered
infinite". The length is a choice: a trial that could reach an end is refused.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from generation.environment import Environment
from generation.primitives import INSIDE, Polygon

ROBOT_DIAMETER = 0.33
"""m. Of the publication's robot, an iRobot Create; a test holds the body `create` to it."""


class Parameters(NamedTuple):
    """Of the corridor."""

    width_m: Annotated[
        float,
        Parameter("m", "Fine 2015, section 2.3.1: seven robot diameters", published=True, low=0.5, high=100.0),
    ] = 7 * ROBOT_DIAMETER
    length_m: Annotated[
        float, Parameter("m", "so long that no trial of a minute reaches its end", low=2.0, high=10000.0, plausible=())
    ] = 80.0
    # plausible: from bare wood to fresh white paint
    reflectance: Annotated[
        float,
        Parameter(
            "", "white paint, diffuse; the walls' material was not published", low=0.01, high=1.0, plausible=(0.4, 0.9)
        ),
    ] = 0.8


def environment(parameters: Parameters) -> Environment:
    """Two long walls and two ends."""
    half_length, half_width = parameters.length_m / 2, parameters.width_m / 2
    corners = (
        (-half_length, -half_width),
        (half_length, -half_width),
        (half_length, half_width),
        (-half_length, half_width),
    )
    return Environment((Polygon(corners, INSIDE),), reflectance=parameters.reflectance)


def free_length(parameters: Parameters, radius_m: float) -> float:
    """How far a robot of that radius may go from the origin along x before it could meet an end, m."""
    return parameters.length_m / 2 - radius_m
