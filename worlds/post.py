"""An open floor on which one round post stands.

Not published: an obstacle other than flockmates, which Kirchner 2006, section 5.1, names as an extension.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from generation.environment import Environment
from generation.primitives import OUTSIDE, Circle


class Parameters(NamedTuple):
    """Of the post."""

    x_m: Annotated[float, Parameter("m", "a choice: of its middle", low=-1000.0, high=1000.0, plausible=())] = 4.0
    y_m: Annotated[float, Parameter("m", "likewise", low=-1000.0, high=1000.0, plausible=())] = 0.0
    radius_m: Annotated[
        float,
        Parameter(
            "m", "a choice: eight feet and more from side to side round it", low=0.05, high=100.0, plausible=(0.5, 1.5)
        ),
    ] = 1.0
    reflectance: Annotated[float, Parameter("", "white paint, diffuse; a choice", low=0.01, high=1.0)] = 0.8


def environment(parameters: Parameters) -> Environment:
    """The post alone."""
    post = Circle(parameters.x_m, parameters.y_m, parameters.radius_m, OUTSIDE)
    return Environment((post,), reflectance=parameters.reflectance)
