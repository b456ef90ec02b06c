"""What a camera's lens makes of bearings: which column of an image shows which.

Temporary.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any, NamedTuple

import cv2
import numpy as np

from flocking.types import Floats

EQUAL_ANGLE, PINHOLE = PROJECTIONS = ("equal-angle", "pinhole")


class Lens(NamedTuple):
    width_px: int = 640
    height_px: int = 480
    field_of_view_rad: float = math.radians(125.0)
    projection: str = EQUAL_ANGLE


class Table(NamedTuple):
    width_px: int
    height_px: int
    fovy_rad: float
    map1: Any = None
    map2_upwards: Any = None
    source_columns: Any = None


def column_angles(lens: Lens) -> Floats:
    aside = 1.0 - (2.0 * np.arange(lens.width_px) + 1.0) / lens.width_px
    half = lens.field_of_view_rad / 2
    if lens.projection == PINHOLE:
        return np.arctan(aside * math.tan(half))
    return aside * half


@cache
def remap_tables(lens: Lens) -> Table:
    half = lens.field_of_view_rad / 2
    if lens.projection == PINHOLE:
        fovy = 2.0 * math.atan(math.tan(half) * lens.height_px / lens.width_px)
        return Table(lens.width_px, lens.height_px, fovy)
    width = 2 * math.ceil(lens.width_px / 2 * math.tan(half) / half * 0.9375 / 2) * 2
    height = lens.height_px
    focal = width / 2 / math.tan(half)
    fovy = 2.0 * math.atan(height / 2 / focal)
    theta = column_angles(lens)
    step = lens.field_of_view_rad / lens.width_px
    phi = step * (lens.height_px / 2 - 0.5 - np.arange(lens.height_px))
    x = width / 2 - focal * np.tan(theta) - 0.5
    y = height / 2 - 0.5 - focal * np.tan(phi)[:, None] / np.cos(theta)[None, :]
    map1 = np.broadcast_to(x, y.shape).astype(np.float32)
    fixed = cv2.convertMaps(np.ascontiguousarray(map1), (height - 1 - y).astype(np.float32), cv2.CV_16SC2)
    columns = np.clip(np.round(x), 0, width - 1).astype(np.int64)
    return Table(width, height, fovy, fixed[0], fixed[1], columns)
