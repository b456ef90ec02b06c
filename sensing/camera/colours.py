"""Ranges of colour: what a segmentation looks for, checked, and the thesis's own (Kirchner 2006, section 3.6.4).

Three kinds, by what is compared with the ranges:

- `rgb`: red, green, blue, 0 to 255 (section 3.6.4.1).
- `monochrome`: the same less the pixel's monochrome value (equations 3.9, 3.10), −255 to 255.
- `hsv`: hue in degrees, saturation and value 0 to 1 (equations 3.11 to 3.14). A hue's range may begin below 0, as in
  −10 to 10 for red; one of 360 degrees takes greys as well, whose hue is undefined.

Ranges are inclusive at both ends. The thesis prints an RGB mask and an HSV range which exclude one another: its mask
ends at a red of 110, its values begin at half of 255. For monochrome subtraction it prints none: `PUBLISHED` has the
smallest range that holds its RGB mask.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from flocking.errors import InputError, unknown_name

RGB, MONOCHROME, HSV = KINDS = ("rgb", "monochrome", "hsv")
MOST_COLOURS = 32
"""One bit each."""
TURN_DEG = 360.0

_CHANNELS = {
    RGB: ("red", "green", "blue"),
    MONOCHROME: ("red less monochrome", "green less monochrome", "blue less monochrome"),
    HSV: ("hue", "saturation", "value"),
}
_LOWEST = {RGB: (0.0, 0.0, 0.0), MONOCHROME: (-255.0,) * 3, HSV: (-TURN_DEG, 0.0, 0.0)}
_HIGHEST = {RGB: (255.0,) * 3, MONOCHROME: (255.0,) * 3, HSV: (TURN_DEG, 1.0, 1.0)}


class Colour(NamedTuple):
    """A range in each of three channels, both ends included."""

    name: str
    low: tuple[float, float, float]
    high: tuple[float, float, float]


class Segmentation(NamedTuple):
    """The colours that one pass looks for. A pixel in several of them has the last (section 3.6.4.4)."""

    kind: str
    """`rgb`, `monochrome` or `hsv`."""
    colours: tuple[Colour, ...]
    """Label k + 1 is that of `colours[k]`; 0 is none of them."""


PUBLISHED = {
    # Kirchner 2006, section 3.6.4.1
    RGB: Segmentation(RGB, (Colour("orange", (60.0, 0.0, 0.0), (110.0, 20.0, 20.0)),)),
    # derived: equations 3.9 and 3.10 over the corners of that mask, 28.04 to 77.13, −35.16 to −9.67, −44.62 to −0.20
    MONOCHROME: Segmentation(MONOCHROME, (Colour("orange", (28.0, -35.2, -44.7), (77.2, -9.6, -0.2)),)),
    # Kirchner 2006, section 3.6.4.3: hue from 5 to 20, saturation greater than 0.8, value greater than 0.5
    HSV: Segmentation(
        HSV, (Colour("orange", (5.0, math.nextafter(0.8, 1.0), math.nextafter(0.5, 1.0)), (20.0, 1.0, 1.0)),)
    ),
}
"""The thesis's ranges by kind."""


def checked(segmentation: Segmentation) -> Segmentation:
    """The same segmentation. Raises InputError for a range that is upside down or goes beyond its channel's."""
    kind, colours = segmentation
    if kind not in KINDS:
        raise unknown_name("segmentation", kind, KINDS)
    if not 1 <= len(colours) <= MOST_COLOURS:
        raise InputError(f"{len(colours)} colours in one pass: expected 1 to {MOST_COLOURS}")
    for colour in colours:
        for k, channel in enumerate(_CHANNELS[kind]):
            low, high = colour.low[k], colour.high[k]
            given = f"{kind} range of {colour.name!r}, {channel} from {low:g} to {high:g}"
            least, most = _LOWEST[kind][k], _HIGHEST[kind][k]
            if not (least <= low <= most and least <= high <= most):
                raise InputError(f"{given}: expected both from {least:g} to {most:g}")
            if low > high:
                upside_down = f"{given} is upside down: expected {high:g} to {low:g}"
                wraps = kind == HSV and k == 0
                raise InputError(
                    f"{upside_down}, or {low - TURN_DEG:g} to {high:g} through 0" if wraps else upside_down
                )
    return segmentation


def hue_within(hues: np.ndarray, low: float, high: float) -> np.ndarray:
    """Whether hues (…), 0 to 360 degrees, nan = undefined, are in a range that may begin below 0."""
    if high - low >= TURN_DEG:
        return np.ones(np.shape(hues), np.bool_)
    with np.errstate(invalid="ignore"):
        below = hues - TURN_DEG
        return ((low <= hues) & (hues <= high)) | ((low <= below) & (below <= high))
