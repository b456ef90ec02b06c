"""Labelled images in COCO's format: what a tracker's users train and test with.

One entry of `images` a picture, with who took it, with which camera and when; one of `annotations` for each cone and
each robot that a picture shows, with its box, its pixels (run-length encoded, column by column, as COCO has them) and
two attributes of ours, `bearing_rad` and `distance_m`. Both are from the lens that took the picture: the bearing off
its axis, left positive, so that `sensing.camera.lens.places` gives the column; the distance to the near side of a cone,
and to the centre of a robot. Pixels and boxes are of what can be seen: what is hidden is no one's.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from flocking.errors import InputError
from flocking.types import Floats

CATEGORIES = ("cone", "robot")
"""By number from 1, as COCO counts them."""


class Labelled(NamedTuple):
    """One picture and what is on it; N robots."""

    file_name: str
    robot: int
    """Who took it."""
    camera: str
    """`left` or `right`."""
    time_s: float
    cones: NDArray[np.integer]
    """(H, W) index of the robot whose cone each pixel shows, −1 = no one's."""
    robots: NDArray[np.integer]
    """(H, W) the same of robots as a whole, their cones included."""
    cones_at: Floats
    """(N, 2) bearing of each cone's axis in the camera's frame, rad, and distance from the lens to its near side, m."""
    robots_at: Floats
    """(N, 2) the same of the robots' own centres."""


def coco(
    pictures: Iterable[Labelled],
    description: str = "",
    settings: Mapping[int, Mapping[str, Mapping[str, Any]]] | None = None,
) -> dict[str, Any]:
    """All of it as one dictionary, ready for JSON. `settings`: by robot, how its cameras are set, in sections."""
    robots = [
        {"robot": robot, **{name: _finite(values) for name, values in sections.items()}}
        for robot, sections in (settings or {}).items()
    ]
    images: list[dict[str, Any]] = []
    annotations: list[dict[str, Any]] = []
    for number, picture in enumerate(pictures, start=1):
        height, width = picture.cones.shape
        images.append(
            {
                "id": number, "file_name": picture.file_name, "width": width, "height": height,
                "robot": picture.robot, "camera": picture.camera, "time_s": round(picture.time_s, 9),
            }
        )  # fmt: skip
        for annotation in annotations_of(picture):
            annotations.append({"id": len(annotations) + 1, "image_id": number, **annotation})
    return {
        "info": {"description": description, "version": "1", **({"robots": robots} if robots else {})},
        "licenses": [],
        "categories": [{"id": k, "name": name, "supercategory": "thing"} for k, name in enumerate(CATEGORIES, start=1)],
        "images": images,
        "annotations": annotations,
    }


def _finite(values: Mapping[str, Any]) -> dict[str, Any]:
    """Values for JSON, which has no number for what is not finite."""
    return {
        name: None if isinstance(value, float) and not math.isfinite(value) else value for name, value in values.items()
    }


def annotations_of(picture: Labelled) -> list[dict[str, Any]]:
    """Of all cones, then of all robots that a picture shows, by index. Raises InputError for shapes that differ."""
    if picture.cones.shape != picture.robots.shape or picture.cones.ndim != 2:
        raise InputError(f"owners of shapes {picture.cones.shape} and {picture.robots.shape}: expected one (H, W)")
    made = []
    seen = ((picture.cones, picture.cones_at), (picture.robots, picture.robots_at))
    for category, (owners, at) in enumerate(seen, start=1):
        for owner in np.unique(owners[owners >= 0]).tolist():
            if owner >= len(at):
                raise InputError(f"a pixel of robot {owner}: expected an index below {len(at)}, that of the bearings")
            mask = owners == owner
            rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
            made.append(
                {
                    "category_id": category,
                    "bbox": [
                        int(columns[0]),
                        int(rows[0]),
                        int(columns[-1] - columns[0] + 1),
                        int(rows[-1] - rows[0] + 1),
                    ],
                    "area": int(mask.sum()),
                    "segmentation": encoded(mask),
                    "iscrowd": 0,
                    "robot": owner,
                    "bearing_rad": float(at[owner, 0]),
                    "distance_m": float(at[owner, 1]),
                }
            )
    return made


def encoded(mask: NDArray[np.bool_]) -> dict[str, Any]:
    """A mask (H, W) as COCO's uncompressed run lengths: how many pixels are not, are, are not …, column by column."""
    flat = np.asarray(mask, dtype=np.bool_).ravel(order="F")
    changes = np.flatnonzero(np.diff(flat)) + 1
    bounds = np.concatenate([[0], changes, [len(flat)]])
    counts = np.diff(bounds).tolist()
    return {"size": list(mask.shape), "counts": [0, *counts] if len(flat) and flat[0] else counts}


def decoded(lengths: dict[str, Any]) -> NDArray[np.bool_]:
    """The mask (H, W) again. Raises InputError for run lengths that do not fill it."""
    size: Sequence[int] = lengths["size"]
    counts = np.asarray(lengths["counts"], dtype=np.int64)
    if counts.sum() != size[0] * size[1] or np.any(counts < 0):
        raise InputError(f"run lengths of {counts.sum()} pixels: expected {size[0]} x {size[1]}")
    flat = np.repeat(np.arange(len(counts)) % 2 == 1, counts)
    return flat.reshape(size, order="F")
