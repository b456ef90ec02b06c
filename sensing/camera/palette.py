"""The colours of cones: the orange one, and one a robot, with the ranges by which each segmentation finds them.

Hues of one cone a robot are 30 degrees apart, of full saturation, the first one orange (the thesis's figure 3.17 tells
green, red, salmon and yellow apart).
"""

from __future__ import annotations

import colorsys
from functools import cache

import numpy as np

from sensing.camera.calibration import NARROW, calibrated
from sensing.camera.colours import HSV, MONOCHROME, RGB, Colour, Segmentation

MOST_ROBOTS = 12
"""Choice: hues 30 degrees apart."""
ORANGE = (1.0, 0.25, 0.0)
"""Red, green, blue of the cone, 0 to 1: hue 15, inside the published 5 to 20. Choice: prototypes."""
FIRST_HUE_DEG = 15.0
DARKEST = 0.55
"""Choice: one cone a robot is looked for in light from this to 1: just above the published least value of 0.5."""

CALIBRATED = {
    RGB: Segmentation(RGB, (Colour("orange", (165.0, 37.0, 0.0), (215.0, 57.0, 20.0)),)),
    MONOCHROME: Segmentation(MONOCHROME, (Colour("orange", (81.1, -50.1, -106.6), (130.2, -24.6, -62.1)),)),
    HSV: Segmentation(HSV, (Colour("orange", (7.3, 0.8, 0.495), (22.4, 1.0, 1.0)),)),
}
"""Ranges by kind, from renderings of the orange cone at nominal light: python -m scripts.calibrate_cones."""


def rgb(robot: int) -> tuple[float, float, float]:
    """Red, green, blue (0 to 1) of this robot's cone, where each has a colour of its own: robot 0's is orange."""
    hue = (FIRST_HUE_DEG + 360.0 / MOST_ROBOTS * (robot % MOST_ROBOTS)) / 360.0
    return colorsys.hsv_to_rgb(hue, 1.0, 1.0)


@cache
def one_each(kind: str, robots: int) -> Segmentation:
    """A colour a robot: label k + 1 is robot k's. The ranges are those of its colour in light from `DARKEST` to 1."""
    light = np.linspace(DARKEST, 1.0, 200)
    names = tuple(f"robot {k}" for k in range(robots))
    blank = Segmentation(kind, tuple(Colour(name, (0.0,) * 3, (1.0,) * 3) for name in names))
    images = [np.round(255.0 * light[None, :, None] * np.array(rgb(k))).astype(np.uint8) for k in range(robots)]
    masks = [np.full((1, len(light)), k + 1) for k in range(robots)]
    return calibrated(blank, images, masks, margins=NARROW[kind])
