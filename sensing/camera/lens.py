"""Lenses: which bearing each column of an image shows, and how an equal-angle image is made of a rendered one.

Two projections. `pinhole`: what a renderer gives; a column at bearing θ stands f tan θ from the centre. `equal-angle`:
columns are the same angle apart, 5.12 a degree, which is what the equations of Kirchner 2006 assume (section 3.6.6).
In both a column is one bearing, whatever the height (the camera is level), and the horizon is the middle of the rows.

An equal-angle image is made of a pinhole rendering of the same field of view, wider than the image, by moving columns
alone: its rows are those of the rendering. So the whole image is filled, level things at the camera's height stay on
the horizon, and what is upright stays in its columns; heights grow toward the sides by 1/cos θ, as in a pinhole. The
rendering has, at its centre, at least as many pixels an angle as the image (1152 columns for 640 at 125 degrees), so
that a degree there is about as high as it is wide.

Bearings are in the camera's frame: 0 along its axis, left positive, radians.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from flocking.compilation import borrowing
from flocking.errors import InputError, unknown_name
from flocking.types import Floats, Ints
from sensing.camera.images import Picture

EQUAL_ANGLE, PINHOLE = PROJECTIONS = ("equal-angle", "pinhole")
PIXELS_PER_DEGREE = 5.12
"""640 columns over 125 degrees. Published: Kirchner 2006, section 3.6.6."""
MAX_FIELD_RAD = math.radians(170.0)
"""Choice: a pinhole of 170 degrees already needs 7.7 times the columns of the image made of it."""
ROUNDED_TO = 64
"""A rendering's width is a multiple of this."""


class Lens(NamedTuple):
    """One of the two cameras of a robot; the other differs in the sign of its yaw. Kirchner 2006, section 3.1."""

    width_px: int = 640
    height_px: int = 480
    field_of_view_rad: float = math.radians(125.0)
    """Horizontal, from the outer edge of the first column to that of the last."""
    yaw_rad: float = math.radians(47.5)
    """How far the left camera is turned to the left, and the right one to the right."""
    projection: str = EQUAL_ANGLE


class RemapTables(NamedTuple):
    """What to render, and how to make an image of it; `map1` and `map2` are None where the rendering is the image."""

    rendered_width: int
    rendered_height: int
    fovy_rad: float
    """Vertical field of view of the pinhole that renders, as MuJoCo's `fovy` (which is in degrees)."""
    map1: NDArray[np.int16] | None
    """(H, W, 2) and the next (H, W): the fixed-point maps of `cv2.remap`, for blending."""
    map2: NDArray[np.uint16] | None
    columns: Ints
    """(W,) the rendered column nearest to each column of the image."""


def checked(lens: Lens) -> Lens:
    """The same lens. Raises InputError for one that cannot be."""
    if lens.projection not in PROJECTIONS:
        raise unknown_name("projection", lens.projection, PROJECTIONS)
    if lens.width_px < 1 or lens.height_px < 1:
        raise InputError(f"image of {lens.width_px} x {lens.height_px} px: expected at least 1 x 1")
    if not 0.0 < lens.field_of_view_rad <= MAX_FIELD_RAD:
        raise InputError(
            f"field of view of {math.degrees(lens.field_of_view_rad):g} degrees: expected more than 0 and at most "
            f"{math.degrees(MAX_FIELD_RAD):g}, for it is rendered as a pinhole"
        )
    return lens


def pixels_per_degree(lens: Lens) -> float:
    """Columns a degree over the whole image: 5.12 for 640 columns and 125 degrees (section 3.6.6)."""
    return lens.width_px / math.degrees(lens.field_of_view_rad)


def column_angles(lens: Lens) -> Floats:
    """(W,) bearing of the middle of each column, rad, left positive: it falls from column 0 on."""
    return _bearings(lens, np.arange(lens.width_px, dtype=np.float64) + 0.5)


def column_edges(lens: Lens) -> Floats:
    """(W + 1,) bearing of the left edge of each column and, last, of the image's right edge, rad."""
    return _bearings(lens, np.arange(lens.width_px + 1, dtype=np.float64))


def _bearings(lens: Lens, places: Floats) -> Floats:
    """Bearing of each place (px from the image's left edge)."""
    checked(lens)
    off_centre = 0.5 - places / lens.width_px
    if lens.projection == EQUAL_ANGLE:
        return off_centre * lens.field_of_view_rad
    return np.arctan(2.0 * off_centre * math.tan(lens.field_of_view_rad / 2.0))


def places(lens: Lens, bearings: Floats) -> Floats:
    """The inverse: px from the image's left edge of each bearing (…) in the camera's frame, rad, |bearing| < π/2.

    Outside the field of view it is below 0 or above the width.
    """
    bearings = np.asarray(bearings, dtype=np.float64)
    if checked(lens).projection == EQUAL_ANGLE:
        off_centre = bearings / lens.field_of_view_rad
    else:
        off_centre = 0.5 * np.tan(bearings) / math.tan(lens.field_of_view_rad / 2.0)
    return (0.5 - off_centre) * lens.width_px


def remap_tables(lens: Lens) -> RemapTables:
    """How to render for this lens, and how to make its image of the rendering by `remap`."""
    checked(lens)
    half = math.tan(lens.field_of_view_rad / 2.0)
    if lens.projection == PINHOLE:
        fovy = 2.0 * math.atan(half * lens.height_px / lens.width_px)
        return RemapTables(lens.width_px, lens.height_px, fovy, None, None, np.arange(lens.width_px))
    needed = 2.0 * half * lens.width_px / lens.field_of_view_rad
    width = ROUNDED_TO * math.ceil(needed / ROUNDED_TO)
    from_left = places(lens._replace(width_px=width, projection=PINHOLE), column_angles(lens))
    wanted = np.tile((from_left - 0.5).astype(np.float32), (lens.height_px, 1))
    rows = np.repeat(np.arange(lens.height_px, dtype=np.float32)[:, None], lens.width_px, axis=1)
    map1, map2 = cv2.convertMaps(wanted, rows, cv2.CV_16SC2)
    nearest = np.clip(np.floor(from_left), 0, width - 1).astype(np.int64)
    fovy = 2.0 * math.atan(half * lens.height_px / width)
    return RemapTables(width, lens.height_px, fovy, map1, map2, nearest)


def remap(image: Picture, tables: RemapTables, blend: bool = False, bottom_up: bool = False) -> Picture:
    """The lens's image (H, W, 3) of a rendering (rendered_height, rendered_width, 3); raises InputError for others.

    Each column is the nearest one of the rendering: it takes a fifth of the time, and mixes no colours at edges, which
    a segmentation takes for neither. With `blend` it is made of its two neighbours, by `cv2.remap`.
    `bottom_up`: the rendering is given from its lowest row up, as OpenGL gives it; the image never is.
    """
    _expect(image, tables)
    if tables.map1 is None and not bottom_up:
        return image
    if blend and tables.map1 is not None:
        image = image[::-1] if bottom_up else image
        made: Picture = cv2.remap(image, tables.map1, tables.map2, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return made
    made = np.empty((len(image), len(tables.columns), 3), np.uint8)
    _nearest(image, tables.columns, bottom_up, made)
    return made


@borrowing
def _nearest(image: Picture, columns: Ints, bottom_up: bool, made: Picture) -> None:
    rows = made.shape[0]
    for i in range(rows):
        row = rows - 1 - i if bottom_up else i
        for j in range(made.shape[1]):
            column = columns[j]
            made[i, j, 0] = image[row, column, 0]
            made[i, j, 1] = image[row, column, 1]
            made[i, j, 2] = image[row, column, 2]


def remap_labels(labels: NDArray[Any], tables: RemapTables) -> NDArray[Any]:
    """The same for whose pixel it is: (rendered_height, rendered_width, …) to (H, W, …)."""
    _expect(labels, tables)
    return labels if tables.map1 is None else np.ascontiguousarray(labels[:, tables.columns])


def _expect(image: NDArray[Any], tables: RemapTables) -> None:
    expected = (tables.rendered_height, tables.rendered_width)
    if image.ndim < 2 or image.shape[:2] != expected:
        raise InputError(
            f"rendering of {' x '.join(str(n) for n in image.shape[:2][::-1])} px: "
            f"expected {expected[1]} x {expected[0]} for this lens"
        )
