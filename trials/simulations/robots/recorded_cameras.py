"""What cameras saw in a recording: the images with what was made of them, and estimates beside the truth."""

from __future__ import annotations

from itertools import pairwise

import cv2
import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from flocking.types import Floats, Ints
from trials.simulations import views
from trials.simulations.columns import packed, series, times_column
from trials.simulations.robots.measures import nearest_rows
from trials.simulations.robots.seen import exact_inputs
from trials.types import Pictures, TrialResult

SIDES = ("left", "right")
FOUND_COLOUR, ESTIMATE_COLOUR, TRUTH_COLOUR = 0x2FBF8FFF, 0xFFB000FF, 0xB8C4CEFF
LONGEST_S = 60.0
"""A time to impact beyond this is not drawn, as that of a cone that goes away is not."""
LEGEND = """
- **images**: what the robot's cameras saw; **green**: the columns that made an input; *taken for*: the pixels that were
  taken for a cone's colour
- **estimates**: of the nearest input, beside the near side of the cone of the robot that it belongs to; a gap in the
  truth where it is a false one
- **time to impact**: at the rate of the last two estimates, and of the truth of the same robot
"""


def send_pictures(recording: rr.RecordingStream, result: TrialResult) -> None:
    """Sends images, masks and runs, and for each robot with eyes its estimates beside the truth."""
    pictures = result.pictures
    if pictures is None:
        return
    for k, name in enumerate(result.robot_names):
        mine = np.flatnonzero(pictures.robots == k)
        if len(mine) == 0:
            continue
        for side, images in enumerate((pictures.left, pictures.right)):
            _send(recording, f"cameras/{name}/{SIDES[side]}", pictures, mine, side, [images[row] for row in mine])
        _estimates(recording, result, k, name)


def _send(
    recording: rr.RecordingStream, entity: str, pictures: Pictures, mine: Ints, side: int, images: list[bytes]
) -> None:
    times = [times_column(pictures.times[mine])]
    blobs, kinds = [np.frombuffer(each, np.uint8) for each in images], ["image/jpeg"] * len(images)
    recording.send_columns(f"{entity}/image", times, rr.EncodedImage.columns(blob=blobs, media_type=kinds))
    masks = [_drawn(pictures.masks[row][side]) for row in mine]
    kinds = ["image/png"] * len(masks)
    recording.send_columns(f"{entity}_taken_for", times, rr.EncodedImage.columns(blob=masks, media_type=kinds))
    found = pictures.found[mine]
    width = found.shape[1] // 2
    middle = _grey(images[0]).shape[0] / 2.0
    runs = [_runs(row[side * width : (side + 1) * width]) for row in found]
    strips = [[[start, middle], [end, middle]] for of_image in runs for start, end in of_image]
    columns = rr.LineStrips2D.columns(strips=np.array(strips, np.float32).reshape(-1, 2, 2))
    style = rr.LineStrips2D.from_fields(colors=packed([FOUND_COLOUR]), radii=[2.0], draw_order=10.0)
    recording.log(f"{entity}/found", style, static=True)
    recording.send_columns(f"{entity}/found", times, columns.partition(np.array([len(each) for each in runs])))


def _drawn(mask: bytes) -> NDArray[np.uint8]:
    """(bytes,) a PNG in which the numbers of colours are shades that can be told apart."""
    labels = _grey(mask)
    shades = labels * max(1, 255 // max(1, int(labels.max())))
    return np.asarray(cv2.imencode(".png", shades)[1], np.uint8).ravel()


def _grey(coded: bytes) -> NDArray[np.uint8]:
    """(H, W) an image without its colours."""
    image = cv2.imdecode(np.frombuffer(coded, np.uint8), cv2.IMREAD_GRAYSCALE)
    assert image is not None
    return np.asarray(image, np.uint8)


def _runs(found: Ints) -> list[tuple[int, int]]:
    """Where the columns (W,) that made one input begin and where they end."""
    edges = np.flatnonzero(np.diff(np.r_[-1, found, -1]) != 0)
    return [(int(a), int(b)) for a, b in pairwise(edges) if found[a] >= 0]


def _estimates(recording: rr.RecordingStream, result: TrialResult, k: int, name: str) -> None:
    updates = result.updates
    mine = np.flatnonzero(updates.robots == k)
    rows = nearest_rows(updates)[mine]
    seen = rows >= 0
    mine, rows = mine[seen], rows[seen]
    times, inputs = updates.times[mine], updates.input_positions[rows].astype(np.float64)
    owners = updates.input_owners[rows].astype(np.int64)
    exact = exact_inputs(result, times, updates.robots[mine], updates.poses_w[mine])
    true = np.where(owners[:, None] >= 0, exact[np.arange(len(mine)), owners], np.nan)
    for told, at, colour, whose in (
        ("estimate", inputs, ESTIMATE_COLOUR, np.zeros(len(mine), np.int64)),
        ("truth", true, TRUTH_COLOUR, owners),
    ):
        away = np.hypot(at[:, 0], at[:, 1])
        for what, values in (("bearing_deg", np.degrees(np.arctan2(at[:, 1], at[:, 0]))), ("distance_m", away)):
            series(recording, f"eyes/{name}/{what}/{told}", told, colour, times, values)
        some, impact = _impact(times, away, whose)
        series(recording, f"eyes/{name}/impact_s/{told}", told, colour, some, impact)


def _impact(times: Floats, away: Floats, whose: Ints) -> tuple[Floats, Floats]:
    """When, and in how long at the rate of the last two of these distances the cone would be reached: equation 3.7.

    Of two that are not of the same robot (`whose`) there is none.
    """
    if len(times) < 2:
        return np.empty(0), np.empty(0)
    with np.errstate(divide="ignore", invalid="ignore"):
        impact = -away[1:] * np.diff(times) / np.diff(away)
        some = (impact > 0.0) & (impact < LONGEST_S) & (whose[1:] == whose[:-1])
    return times[1:][some], impact[some]


def views_of(result: TrialResult) -> list[rrb.Tabs]:
    """The views of what cameras saw: a tab for each robot with eyes."""
    pictures = result.pictures
    if pictures is None:
        return []
    tabs = []
    for k in np.unique(pictures.robots):
        name = result.robot_names[k]
        images = [
            rrb.Spatial2DView(origin=f"/cameras/{name}/{entity}", name=words)
            for side in SIDES
            for entity, words in ((side, side), (f"{side}_taken_for", f"{side}, taken for"))
        ]
        estimates = [
            views.plot("Bearing (degrees)", [f"/eyes/{name}/bearing_deg/**"]),
            views.plot("Distance (m)", [f"/eyes/{name}/distance_m/**"]),
            views.plot("Time to impact (s)", [f"/eyes/{name}/impact_s/**"]),
        ]
        tabs.append(
            rrb.Vertical(
                rrb.Horizontal(images[0], images[2]),
                rrb.Horizontal(images[1], images[3]),
                rrb.Horizontal(*estimates),
                name=name,
                row_shares=[3, 3, 2],
            )
        )
    return [rrb.Tabs(*tabs, name="Cameras")]
