"""Cones as connected blobs: several at once, though they hide one another or are partly hidden. A detector of today.

Each colour's pixels are closed over small holes and split into connected components (OpenCV). A component's outline is
how high it stands over its lowest row in each column. Cones that touch in the image have a peak each: where the outline
falls between two peaks, it is cut. Of each part, the peak is the cone's axis, and its half width is that of the side
that shows more: what stands before a cone hides one side of it, and a cut or the image's border ends one. Where both
sides were cut, they are carried on down the slopes of their flanks. Where both agree, the part's width is the cone's.

What hides a cone's tip and one side hides how far away it is: such a part seems farther away than it is.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from flocking.compilation import borrowing, compiled
from flocking.types import Floats, Ints
from sensing.camera.looking import Eyes, Sighted
from sensing.camera.segmentation import Labels

PROMINENCE_PX = 2.0
"""Choice: a peak stands out of the valley beside it by more than this, or it is part of its neighbour;"""
PROMINENCE = 0.15
"""and by more than this share of its height."""
LOPSIDED_PX = 2.0
"""Choice: sides that differ by at most this, or by `LOPSIDED`, are those of a whole cone."""
LOPSIDED = 0.15


def blobs(labels: Labels, colours: int, largest_hole: int, minimum: int, edges: Floats) -> tuple[Ints, Floats]:
    """(R, 3) colour, first and last column of each cone that an image shows, and (R, 2) bearings (rad) of the left and
    the right border of the whole cone, as far as it can be told. Those narrower than `minimum` px are none.

    `edges` (W + 1,) are the bearings of the columns' borders, rad.
    """
    found, borders = [np.empty((0, 3), np.int64)], [np.empty((0, 2))]
    boxes_of = _boxes(labels, colours)
    for colour in range(colours):
        x, y, past_x, past_y = boxes_of[colour].tolist()
        if past_x - x < minimum:
            continue
        mask = (labels[y:past_y, x:past_x] == colour + 1).view(np.uint8)
        _fill(mask, largest_hole)
        count, numbers, boxes, _ = cv2.connectedComponentsWithStats(mask, connectivity=8, ltype=cv2.CV_32S)
        if count > 1:
            parts, angles = _parts(numbers, boxes.astype(np.int64), minimum, x, edges)
            found.append(np.column_stack((np.full(len(parts), colour), parts)))
            borders.append(angles)
    return np.concatenate(found), np.concatenate(borders)


def sighted_blobs(labels: tuple[Labels, Labels], colours: int, largest_hole: int, minimum: int, eyes: Eyes) -> Sighted:
    """The blobs of both images, each of which may be a cone."""
    found, borders = [], []
    for side in range(2):
        parts, angles = blobs(labels[side], colours, largest_hole, minimum, eyes.edges[side])
        found.append(np.column_stack((np.full(len(parts), side), parts)))
        borders.append(angles)
    return Sighted(np.concatenate(found), np.concatenate(borders))


@compiled
def _boxes(labels: Labels, colours: int) -> Ints:
    """(colours, 4) first column and row of each colour, and those past its last."""
    height, width = labels.shape
    boxes = np.zeros((colours, 4), np.int64)
    boxes[:, 0] = width
    for i in range(height):
        for j in range(width):
            k = int(labels[i, j]) - 1
            if k >= 0:
                if boxes[k, 3] == 0:
                    boxes[k, 1] = i
                boxes[k, 3] = i + 1
                boxes[k, 0] = min(boxes[k, 0], j)
                boxes[k, 2] = max(boxes[k, 2], j + 1)
    return boxes


@borrowing
def _fill(mask: Labels, largest_hole: int) -> None:
    """Sets what in a row of a mask (0 or 1) lies between two pixels that are set, at most so many columns apart."""
    for i in range(mask.shape[0]):
        last = -1
        for j in range(mask.shape[1]):
            if mask[i, j] != 0:
                if last >= 0 and j - last - 1 <= largest_hole:
                    mask[i, last + 1 : j] = 1
                last = j


@compiled
def _parts(numbers: NDArray[np.int32], boxes: Ints, minimum: int, offset: int, edges: Floats) -> tuple[Ints, Floats]:
    """First and last column, and borders, of all parts of all components; `offset` (px) is where the crop begins.

    `boxes` (components, 5) are x, y, width, height, area, component 0 the rest of the crop.
    """
    width = len(edges) - 1
    parts, borders, count = np.empty((64, 2), np.int64), np.empty((64, 2)), 0
    for c in range(1, len(boxes)):
        left, top, wide, high = boxes[c, 0], boxes[c, 1], boxes[c, 2], boxes[c, 3]
        if wide < minimum:
            continue
        heights = np.zeros(wide)
        for j in range(wide):
            for i in range(top, top + high):
                if numbers[i, left + j] == c:
                    heights[j] = top + high - i
                    break
        peaks, cuts = _peaks(heights)
        for p in range(len(peaks)):
            start, end = cuts[p], cuts[p + 1] - 1
            if end - start + 1 < minimum:
                continue
            if count == len(parts):
                more_parts, more_borders = np.empty((2 * count, 2), np.int64), np.empty((2 * count, 2))
                more_parts[:count], more_borders[:count] = parts, borders
                parts, borders = more_parts, more_borders
            parts[count, 0], parts[count, 1] = offset + left + start, offset + left + end
            from_left = p == 0 and offset + left > 0
            to_right = p == len(peaks) - 1 and offset + left + wide < width
            borders[count, 0], borders[count, 1] = _borders(
                heights[start : end + 1], edges[parts[count, 0] : parts[count, 1] + 2], from_left, to_right
            )
            count += 1
    return parts[:count].copy(), borders[:count].copy()


@compiled
def _peaks(heights: Floats) -> tuple[Ints, Ints]:
    """Columns (P,) of the peaks of an outline, and where it is cut (P + 1,): from the first column to past the last."""
    wide = len(heights)
    peaks, cuts, count = np.empty(wide, np.int64), np.empty(wide + 1, np.int64), 0
    cuts[0] = 0
    rising, peak, valley = True, 0, 0
    for j in range(1, wide):
        if rising:
            if heights[j] > heights[peak]:
                peak = j
            elif heights[peak] - heights[j] > max(PROMINENCE_PX, PROMINENCE * heights[peak]):
                peaks[count] = peak
                count += 1
                rising, valley = False, j
        elif heights[j] < heights[valley]:
            valley = j
        elif heights[j] - heights[valley] > max(PROMINENCE_PX, PROMINENCE * heights[j]):
            cuts[count] = valley + 1
            rising, peak = True, j
    if rising:
        peaks[count] = peak
        count += 1
    cuts[count] = wide
    return peaks[:count].copy(), cuts[: count + 1].copy()


@compiled
def _borders(heights: Floats, edges: Floats, from_left: bool, to_right: bool) -> tuple[float, float]:
    """Bearings of the left and the right border of the cone of which a part stands so high (C,) in columns with these
    edges (C + 1,); whether its left and its right side are not cut short."""
    wide = len(heights)
    highest, first, last = heights.max(), -1, -1
    for j in range(wide):
        if heights[j] == highest:
            first = j if first < 0 else first
            last = j
    axis = (edges[first] + edges[last + 1]) / 2.0
    left, right = edges[0] - axis, axis - edges[wide]
    column = (edges[0] - edges[wide]) / wide
    alike = abs(left - right) <= max(LOPSIDED_PX * column, LOPSIDED * (left + right) / 2.0)
    if from_left and to_right and alike:
        return edges[0], edges[wide]
    if from_left or to_right:  # a side that is cut shows at least how wide it is
        half = max(left, right)
    else:
        half = max(_carried(left, highest, heights[0]), _carried(right, highest, heights[wide - 1]))
    return axis + half, axis - half


@compiled
def _carried(side: float, highest: float, at_cut: float) -> float:
    """How wide a side (rad) is if its flank goes on to the ground as it goes from the peak to the cut."""
    fallen = highest - at_cut
    return side * highest / fallen if fallen > 0.0 else side
