"""A room with eight walls about the origin: a square without its corners.

Source: Buckland 2005, the walls of its code for chapter 3, in which Kirchner 2006 (section 3.3) ran his simulation: a
fifth of each side is cut off at either end. Kirchner's window is not published. The least round one that holds the
places that are (up to 664 px, with robots about them) is 800 px wide, less a border of 20 px on each side: 760 px of
8 mm.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from generation.environment import Environment
from generation.primitives import INSIDE, Polygon


class Parameters(NamedTuple):
    """Of the octagon."""

    width_m: Annotated[
        float, Parameter("m", "a choice: 760 px, from wall to opposite wall", low=0.5, high=10000.0, plausible=())
    ] = 6.08
    corner: Annotated[
        float,
        Parameter(
            "", "Buckland 2005: part of a side that is cut off at either end", published=True, low=0.0, high=0.45
        ),
    ] = 0.2
    reflectance: Annotated[float, Parameter("", "white paint, diffuse; a choice", low=0.01, high=1.0)] = 0.8


def environment(parameters: Parameters) -> Environment:
    """Eight walls; four where no corner is cut off."""
    far = 0.5 * parameters.width_m
    near = far - parameters.corner * parameters.width_m
    corners = [
        (far, -near),
        (far, near),
        (near, far),
        (-near, far),
        (-far, near),
        (-far, -near),
        (-near, -far),
        (near, -far),
    ]
    return Environment((Polygon(tuple(dict.fromkeys(corners)), INSIDE),), reflectance=parameters.reflectance)
