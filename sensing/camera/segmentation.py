"""Segmentation by colour: an image to labels (Kirchner 2006, section 3.6.4), several colours in one pass.

The equations, with the misprints mended: the third case of 3.12 is MAX = B; a negative hue has 360 added; the hue of a
grey (MAX = MIN) is undefined, and so is black's saturation.

    3.9   mono = 0.2989 R + 0.5870 G + 0.1140 B
    3.10  (R − mono, G − mono, B − mono)
    3.12  H = 60 (G − B) / (MAX − MIN) if MAX = R; 60 (B − R) / (MAX − MIN) + 120 if MAX = G;
              60 (R − G) / (MAX − MIN) + 240 if MAX = B
    3.13  S = (MAX − MIN) / MAX
    3.14  V = MAX, of R, G, B divided by 255 (3.11)

`rgb` and `hsv` look a pixel up in tables of bits, one a colour, as Bruce et al. do on whose work the thesis's code
rests; a hue is worked out only where saturation and value are some colour's.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flocking.compilation import borrowing
from flocking.errors import InputError
from flocking.types import Floats
from sensing.camera.colours import HSV, MONOCHROME, RGB, TURN_DEG, Colour, Segmentation, checked, hue_within
from sensing.camera.images import Picture

MONO_RED, MONO_GREEN, MONO_BLUE = 0.2989, 0.5870, 0.1140
"""Published: equation 3.9. They add up to 0.9999."""
Labels = NDArray[np.uint8]
"""(H, W): 0 = none of the colours, k + 1 = colour k of the segmentation."""


def segmented(image: Picture, segmentation: Segmentation) -> Labels:
    """Labels (H, W) of an image (H, W, 3)."""
    labels = np.empty(np.shape(image)[:2], np.uint8)
    segment_into(image, segmentation, labels)
    return labels


def segment_into(image: Picture, segmentation: Segmentation, labels: Labels) -> None:
    """The same into an array that is there: no new memory an image."""
    if image.ndim != 3 or image.shape[2] != 3 or image.dtype != np.uint8:
        raise InputError(f"image of shape {image.shape}, {image.dtype}: expected (H, W, 3), uint8")
    run, tables = _prepared(segmentation)
    run(np.ascontiguousarray(image), *tables, labels)


@lru_cache(maxsize=32)
def _prepared(segmentation: Segmentation) -> tuple[Callable[..., None], tuple[Any, ...]]:
    """The compiled function and the tables that it takes."""
    kind, colours = checked(segmentation)
    lows = np.array([c.low for c in colours], dtype=np.float64)
    highs = np.array([c.high for c in colours], dtype=np.float64)
    if kind == MONOCHROME:
        return _segment_monochrome, (lows, highs, lows.min(axis=0), highs.max(axis=0))
    bits = np.uint32(1) << np.arange(len(colours), dtype=np.uint32)
    steps = np.arange(256.0)
    if kind == RGB:
        within = (lows[:, :, None] <= steps) & (steps <= highs[:, :, None])
        return _segment_rgb, (np.bitwise_or.reduce(np.where(within, bits[:, None, None], np.uint32(0))),)
    most, least = np.meshgrid(steps, steps, indexing="ij")
    with np.errstate(invalid="ignore", divide="ignore"):
        saturation = (most - least) / most
    table = np.zeros((256, 256), np.uint32)
    for colour, bit in zip(colours, bits, strict=True):
        (_, s_low, v_low), (_, s_high, v_high) = colour.low, colour.high
        any_saturation = np.isnan(saturation) & (s_low == 0.0) & (s_high == 1.0)
        fits = ((s_low <= saturation) & (saturation <= s_high)) | any_saturation
        table[fits & (v_low <= most / 255.0) & (most / 255.0 <= v_high)] |= bit
    return _segment_hsv, (table, lows[:, 0].copy(), highs[:, 0].copy())


@borrowing
def _last(bits: int) -> int:
    """1 + the place of the highest bit that is set; 0 = none is: the last colour that matches."""
    label = 0
    while bits != 0:
        label += 1
        bits >>= 1
    return label


@borrowing
def _segment_rgb(image: Picture, table: NDArray[np.uint32], labels: Labels) -> None:
    height, width, _ = image.shape
    for i in range(height):
        for j in range(width):
            bits = table[0, image[i, j, 0]] & table[1, image[i, j, 1]] & table[2, image[i, j, 2]]
            labels[i, j] = _last(bits) if bits != 0 else 0


@borrowing
def _segment_monochrome(
    image: Picture, lows: Floats, highs: Floats, lowest: Floats, highest: Floats, labels: Labels
) -> None:
    height, width, _ = image.shape
    for i in range(height):
        for j in range(width):
            red, green, blue = float(image[i, j, 0]), float(image[i, j, 1]), float(image[i, j, 2])
            mono = MONO_RED * red + MONO_GREEN * green + MONO_BLUE * blue
            red, green, blue = red - mono, green - mono, blue - mono
            labels[i, j] = 0
            if red < lowest[0] or red > highest[0] or blue < lowest[2] or blue > highest[2]:
                continue
            for k in range(len(lows) - 1, -1, -1):
                if (
                    lows[k, 0] <= red <= highs[k, 0]
                    and lows[k, 1] <= green <= highs[k, 1]
                    and lows[k, 2] <= blue <= highs[k, 2]
                ):
                    labels[i, j] = k + 1
                    break


@borrowing
def _segment_hsv(
    image: Picture, table: NDArray[np.uint32], hue_lows: Floats, hue_highs: Floats, labels: Labels
) -> None:
    height, width, _ = image.shape
    for i in range(height):
        for j in range(width):
            red, green, blue = image[i, j, 0], image[i, j, 1], image[i, j, 2]
            most, least = max(red, max(green, blue)), min(red, min(green, blue))
            bits = table[most, least]
            label = 0
            if bits != 0:
                hue = _hue(float(red), float(green), float(blue), float(most), float(least))
                for k in range(len(hue_lows)):
                    if (bits >> k) & 1 and _hue_fits(hue, hue_lows[k], hue_highs[k]):
                        label = k + 1
            labels[i, j] = label


@borrowing
def _hue(red: float, green: float, blue: float, most: float, least: float) -> float:
    """Equation 3.12, degrees from 0 to below 360; nan for greys."""
    if most == least:
        return np.nan
    if most == red:
        hue = 60.0 * (green - blue) / (most - least)
        return hue + 360.0 if hue < 0.0 else hue
    if most == green:
        return 60.0 * (blue - red) / (most - least) + 120.0
    return 60.0 * (red - green) / (most - least) + 240.0


@borrowing
def _hue_fits(hue: float, low: float, high: float) -> bool:
    return low <= hue <= high or low <= hue - 360.0 <= high or high - low >= 360.0


def monochrome(image: Picture) -> Floats:
    """(H, W, 3) by equations 3.9 and 3.10, float64."""
    values = image.astype(np.float64)
    mono = values @ np.array([MONO_RED, MONO_GREEN, MONO_BLUE])
    return values - mono[..., None]


def hsv(image: Picture) -> Floats:
    """(H, W, 3) hue (degrees, 0 to below 360; nan for greys), saturation (nan for black) and value (0 to 1)."""
    red, green, blue = np.moveaxis(image.astype(np.float64), -1, 0)
    most, least = image.max(axis=-1).astype(np.float64), image.min(axis=-1).astype(np.float64)
    with np.errstate(invalid="ignore", divide="ignore"):
        hue = np.select(
            [most == least, most == red, most == green],
            [
                np.nan,
                60.0 * (green - blue) / (most - least) % TURN_DEG,
                60.0 * (blue - red) / (most - least) + 120.0,
            ],
            60.0 * (red - green) / (most - least) + 240.0,
        )
        saturation = (most - least) / most
    return np.stack([hue, saturation, most / 255.0], axis=-1)


def channels(image: Picture, kind: str) -> Floats:
    """(H, W, 3) what a segmentation of this kind compares with its ranges."""
    return {RGB: lambda i: np.asarray(i).astype(np.float64), MONOCHROME: monochrome, HSV: hsv}[kind](image)


def matches(image: Picture, kind: str, colour: Colour) -> NDArray[np.bool_]:
    """(H, W) whether each pixel is in the range of one colour: in NumPy, for looking into a segmentation."""
    values = channels(image, kind)
    with np.errstate(invalid="ignore"):
        within = (np.array(colour.low) <= values) & (values <= np.array(colour.high))
    if kind == HSV:
        within[..., 0] = hue_within(values[..., 0], colour.low[0], colour.high[0])
        within[..., 1] |= np.isnan(values[..., 1]) & (colour.low[1] == 0.0) & (colour.high[1] == 1.0)
    return np.asarray(within.all(axis=-1))


def agreement(labels: Sequence[Labels], masks: Sequence[Labels]) -> tuple[float, float]:
    """Of the labelled pixels of all images, the share that was found; of those found, the share that is right."""
    right = sum(int(np.sum((a == b) & (b > 0))) for a, b in zip(labels, masks, strict=True))
    there, found = sum(int(np.sum(m > 0)) for m in masks), sum(int(np.sum(m > 0)) for m in labels)
    return (right / there if there else np.nan), (right / found if found else np.nan)
