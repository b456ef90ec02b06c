"""Grid maps of ROS: a YAML file beside a PNG or PGM image.

Source: the documentation of ROS's map_server: a cell is occupied where p > occupied_thresh and free where
p < free_thresh, for p = (255 − v) / 255 of its brightness v, or v / 255 with `negate`; the image's last row is the
map's first; `origin` is the pose (x, y, yaw) of the corner of its lower left cell. The mean of all channels counts, as
there, in mode trinary that of transparency too. Cells that are neither occupied nor free are unknown: no walls.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any, NamedTuple

import cv2
import numpy as np
import yaml

from flocking.errors import InputError
from flocking.types import Bools, Floats
from generation.environment import Environment
from generation.plans import beams, outlines
from generation.plans.drawing import contents
from generation.plans.units import Unit
from generation.primitives import MOST_M

MOST_CELLS = 50_000_000
"""Of a map. A choice: 350 m x 350 m in cells of 5 cm."""
MODES = ("trinary", "scale")
KEYS = ("image", "resolution", "origin", "occupied_thresh", "free_thresh", "negate")
"""What a map's YAML must have."""
_PNG = b"\x89PNG\r\n\x1a\n"
_PGM = re.compile(rb"P[25](?:\s|#[^\n]*\n)+(\d{1,9})(?:\s|#[^\n]*\n)+(\d{1,9})(?:\s|#[^\n]*\n)+(\d{1,5})\s")


class Grid(NamedTuple):
    """Which cells of a map are occupied and free, and where they are."""

    occupied: Bools
    """(rows, columns), the first row at the bottom of the map."""
    free: Bools
    """Likewise."""
    cell_m: float
    pose_w: tuple[float, float, float]
    """x (m), y (m) and yaw (rad) of the corner of the first cell."""

    def in_world(self, cells: Floats) -> Floats:
        """(N, 2) places in the world, m, of places (N, 2) in the map: columns and rows from the corner, in cells."""
        x, y, yaw = self.pose_w
        along, up = self.cell_m * cells[:, 0], self.cell_m * cells[:, 1]
        c, s = math.cos(yaw), math.sin(yaw)
        return np.column_stack([x + c * along - s * up, y + s * along + c * up])


def read(path: Path, given: Unit | None) -> tuple[Environment, list[str]]:
    """The environment of a map's occupied cells, and lines that tell how near it is to the map. Raises `InputError`."""
    if given is not None:
        raise InputError(f"{path} has a resolution of its own: expected no unit or scale for a map")
    image, grid = _grid(path)
    unknown = grid.occupied.size - np.count_nonzero(grid.occupied) - np.count_nonzero(grid.free)
    if not grid.occupied.any():
        raise InputError(f"{path}: no cell of {image} is occupied: expected walls; is negate right?")
    walls = outlines.polygons(grid.occupied, grid.in_world, str(path))
    error = beams.error(grid.occupied, grid.free, grid.cell_m, grid.pose_w, Environment(walls).walls())
    rows, columns = grid.occupied.shape
    told = [
        f"{columns} x {rows} cells of {grid.cell_m:g} m: {np.count_nonzero(grid.occupied)} occupied, "
        f"{unknown} unknown, which are no walls",
        beams.told(error, grid.cell_m),
    ]
    origin: dict[str, Any] = {
        "file": path.name, "format": "ros map", "image": image.name, "metres_per_unit": grid.cell_m,
    }  # fmt: skip
    if error is not None:
        origin |= {"beams": error.beams, "beams_within_a_cell": error.share, "beams_worst_m": error.worst_m}
    return Environment(walls, origin=origin), told


def _grid(path: Path) -> tuple[Path, Grid]:
    """The image's path, and the cells of a map."""
    values = _values(path)
    resolution = _number(values["resolution"], f"{path}: resolution", 1e-6, 1e4)
    pose = values["origin"]
    if not isinstance(pose, list) or len(pose) != 3:
        raise InputError(f"{path}: origin = {_short(pose)}: expected [x, y, yaw], m and rad")
    x, y, yaw = (_number(number, f"{path}: origin", -MOST_M, MOST_M) for number in pose)
    occupied_above = _number(values["occupied_thresh"], f"{path}: occupied_thresh", 0.0, 1.0)
    free_below = _number(values["free_thresh"], f"{path}: free_thresh", 0.0, 1.0)
    if free_below > occupied_above:
        raise InputError(f"{path}: free_thresh = {free_below:g} lies above occupied_thresh = {occupied_above:g}")
    if values["negate"] not in (0, 1):
        raise InputError(f"{path}: negate = {_short(values['negate'])}: expected 0 or 1")
    mode = values.get("mode", "trinary")
    if mode not in MODES:
        raise InputError(f"{path}: mode = {_short(mode)}: expected {' or '.join(MODES)}")
    if not isinstance(values["image"], str) or not values["image"] or "\0" in values["image"]:
        raise InputError(f"{path}: image = {_short(values['image'])}: expected the name of a PNG or PGM file")
    image = path.parent / values["image"]
    bright, seen = _brightness(image, path, mode)
    probability = bright if values["negate"] else 1.0 - bright
    return image, Grid(
        np.ascontiguousarray(((probability > occupied_above) & seen)[::-1]),
        np.ascontiguousarray(((probability < free_below) & seen)[::-1]),
        resolution,
        (x, y, yaw),
    )


def _values(path: Path) -> dict[str, Any]:
    data = contents(path, "a ROS map's YAML")
    if len(data) > 1_000_000 or (b"&" in data and b"*" in data):  # aliases of aliases grow without end
        raise InputError(f"{path} is no ROS map's YAML: it is too large, or has aliases")
    try:
        values = yaml.safe_load(data)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise InputError(f"{path} is broken YAML: {' '.join(str(error).split())[:200]}") from None
    if not isinstance(values, dict):
        raise InputError(f"{path} is no ROS map's YAML: expected {', '.join(KEYS)}")
    missing = [key for key in KEYS if key not in values]
    if missing:
        raise InputError(f"{path} is no ROS map's YAML: it lacks {', '.join(missing)}")
    return values


def _brightness(image: Path, path: Path, mode: str) -> tuple[Floats, Bools]:
    """(rows, columns) brightness from 0 to 1 of an image, the first row on top, and whether a cell is opaque at all."""
    if not image.is_file():
        raise InputError(f"{path}: its image {image} does not exist: expected a PNG or PGM file")
    data = contents(image, "a PNG or PGM file")
    width, height = _size(data, image)
    if width * height > MOST_CELLS:
        raise InputError(f"{image} has {width} x {height} cells: expected at most {MOST_CELLS // 1_000_000} million")
    level = cv2.utils.logging.getLogLevel()
    cv2.utils.logging.setLogLevel(0)
    try:
        pixels = cv2.imdecode(np.frombuffer(data, dtype=np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:
        pixels = None
    finally:
        cv2.utils.logging.setLogLevel(level)
    if pixels is None or pixels.shape[:2] != (height, width):
        raise InputError(f"{image} is broken: expected a whole PNG or PGM file")
    most = float(np.iinfo(pixels.dtype).max)
    channels = pixels.reshape(height, width, -1)
    opaque = np.ones((height, width), dtype=np.bool_)
    if channels.shape[2] in (2, 4) and mode == "scale":
        opaque = channels[:, :, -1] > 0
        channels = channels[:, :, :-1]
    return channels.mean(axis=2, dtype=np.float64) / most, opaque


def _size(data: bytes, image: Path) -> tuple[int, int]:
    """Width and height as the head of a PNG or PGM file says, before anything is unpacked."""
    if data.startswith(_PNG) and len(data) >= 24:
        width, height = (int.from_bytes(data[at : at + 4], "big") for at in (16, 20))
    elif found := _PGM.match(data):
        width, height, most = map(int, found.groups())
        if most not in (255, 65535):
            raise InputError(f"{image}: its brightest value is {most}: expected 255 or 65535")
    else:
        raise InputError(f"{image} is neither PNG nor PGM: expected one of these")
    if width == 0 or height == 0:
        raise InputError(f"{image} has no cells: expected a PNG or PGM file")
    return width, height


def _number(given: Any, what: str, low: float, high: float) -> float:
    if isinstance(given, bool) or not isinstance(given, int | float) or not low <= given <= high:
        raise InputError(f"{what} = {_short(given)}: expected a number from {low:g} to {high:g}")
    return float(given)


def _short(value: object) -> str:
    text = " ".join(repr(value).split())
    return text if len(text) <= 60 else f"{text[:57]}..."
