"""Calibration: ranges of colour from labelled pixels, as the thesis had them from GIMP on images of its own.

Of each channel, the range between two quantiles of the pixels that show the colour, and a margin on either side. A
rendered cone has one colour where a real one has many, so the margins are half the widths of the thesis's own ranges:
what is calibrated is where the ranges lie.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from flocking.errors import InputError
from flocking.types import Floats
from sensing.camera.colours import HSV, MONOCHROME, RGB, TURN_DEG, Colour, Segmentation, checked
from sensing.camera.images import Picture
from sensing.camera.segmentation import channels

QUANTILE = 0.005
"""Choice: of each channel, one pixel in two hundred is left out at either end: blends at edges."""
MARGINS = {RGB: (25.0, 10.0, 20.0), MONOCHROME: (24.5, 12.7, 22.2), HSV: (7.5, 0.2, 0.25)}
"""Half the widths of the published ranges (levels, levels, degrees and shares); the whole of those that end where the
channel does: blue, which begins at 0, and saturation, which ends at 1; of values, down to the least one published."""
NARROW = {RGB: (5.0, 5.0, 5.0), MONOCHROME: (3.0, 3.0, 3.0), HSV: (2.0, 0.02, 0.02)}
"""Choice: for pixels that already show all light that is to be expected."""


def calibrated(
    segmentation: Segmentation,
    images: Sequence[Picture],
    masks: Sequence[NDArray[np.integer]],
    quantile: float = QUANTILE,
    margins: tuple[float, float, float] | None = None,
) -> Segmentation:
    """The segmentation with ranges of its own for each colour.

    `masks` are (H, W): 0 = none of the colours, k + 1 = colour k, as the segmentation should label it. Raises
    InputError for a colour of which no pixel is labelled.
    """
    kind, colours = segmentation
    margin = np.array(MARGINS[kind] if margins is None else margins)
    if len(images) != len(masks) or any(i.shape[:2] != m.shape for i, m in zip(images, masks, strict=True)):
        raise InputError(f"{len(images)} images and {len(masks)} masks: expected a mask of its size for each image")
    made = []
    for k, colour in enumerate(colours):
        shown = [channels(i[m == k + 1][None], kind)[0] for i, m in zip(images, masks, strict=True)]
        pixels = np.concatenate(shown) if shown else np.empty((0, 3))
        pixels = pixels[np.isfinite(pixels).all(axis=1)]
        if not len(pixels):
            raise InputError(f"no pixel of {colour.name!r} in {len(masks)} masks: expected some with label {k + 1}")
        made.append(_range_of(colour.name, kind, pixels, quantile, margin))
    return checked(Segmentation(kind, tuple(made)))


def _range_of(name: str, kind: str, pixels: Floats, quantile: float, margin: Floats) -> Colour:
    """The range of (P, 3) pixels."""
    pixels = pixels.copy()
    if kind == HSV:  # hues about their mean direction, so that red is in one piece
        turns = np.exp(1j * np.radians(pixels[:, 0]))
        middle = float(np.degrees(np.angle(turns.mean())))
        pixels[:, 0] = middle + np.degrees(np.angle(turns * np.exp(-1j * np.radians(middle))))
    low = np.quantile(pixels, quantile, axis=0) - margin
    high = np.quantile(pixels, 1.0 - quantile, axis=0) + margin
    if kind == HSV:
        high[1:] = 1.0  # as published: saturation and value have least values alone
        if low[0] < -TURN_DEG / 2.0 or (low[0] < 0.0 and high[0] < 0.0):
            low[0], high[0] = low[0] + TURN_DEG, high[0] + TURN_DEG
        if high[0] > TURN_DEG:
            low[0], high[0] = low[0] - TURN_DEG, high[0] - TURN_DEG
        least, most = np.array([-TURN_DEG, 0.0, 0.0]), np.array([TURN_DEG, 1.0, 1.0])
    else:
        least, most = np.full(3, 0.0 if kind == RGB else -255.0), np.full(3, 255.0)
    low, high = np.clip(low, least, most), np.clip(high, least, most)
    return Colour(name, (float(low[0]), float(low[1]), float(low[2])), (float(high[0]), float(high[1]), float(high[2])))
