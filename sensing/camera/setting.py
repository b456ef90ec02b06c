"""The cameras of a group of robots: what their numbers can be set to."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from sensing.camera import imperfections
from sensing.camera.lens import EQUAL_ANGLE, PROJECTIONS, Lens

_KIRCHNER = "Kirchner 2006"
ORANGE, ONE_EACH = COLOURS = ("orange", "one-each")


class Parameters(NamedTuple):
    """A pair of cameras and what they are to show."""

    projection: Annotated[
        str,
        Parameter("", f"{_KIRCHNER}, section 3.6.6: 5.12 pixels a degree over the whole image", choices=PROJECTIONS),
    ] = EQUAL_ANGLE
    width_px: Annotated[int, Parameter("px", f"{_KIRCHNER}, section 3.1", published=True, low=16, high=2048)] = 640
    height_px: Annotated[int, Parameter("px", f"{_KIRCHNER}, section 3.1", published=True, low=12, high=2048)] = 480
    field_of_view_deg: Annotated[
        float, Parameter("deg", f"{_KIRCHNER}, section 3.1: of its width", published=True, low=10.0, high=150.0)
    ] = 125.0
    colours: Annotated[
        str,
        Parameter("", "of the robots' cones: all orange, or one each (section 5.1)", choices=COLOURS),
    ] = ORANGE
    setting: Annotated[
        str, Parameter("", "a choice: what is imperfect about them", choices=tuple(imperfections.SETTINGS))
    ] = "none"
    judged: Annotated[
        bool,
        Parameter("", "a choice: whether detections are held against what the images show, which is rendered again"),
    ] = True


def lens_of(parameters: Parameters) -> Lens:
    """The lens of these numbers."""
    return Lens(
        width_px=parameters.width_px,
        height_px=parameters.height_px,
        field_of_view_rad=math.radians(parameters.field_of_view_deg),
        projection=parameters.projection,
    )
