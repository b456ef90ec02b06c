"""Runs of one colour in the rows of an image, in one pass over its labels: algorithm 2 of Kirchner 2006, section 3.6.5.

A run is a stretch of one row that begins and ends with a pixel of the colour and holds no more than so many (5)
consecutive pixels that are not: 12 orange pixels, 4 others and 7 orange ones are a run of 23. The longest run is the
width of the closest cone.

The misprints of algorithm 2, mended: a run ends at its last orange pixel, not at the hole after it; pixels skipped are
counted anew in each hole ("consecutive"); a run that reaches the last column counts as well. Of runs of the same
length the first is taken: the upper, then the left one.

Several colours have runs of their own; a pixel of another colour is a hole.
"""

from __future__ import annotations

import numpy as np

from flocking.compilation import borrowing, compiled
from flocking.types import Ints
from sensing.camera.segmentation import Labels

LARGEST_HOLE_PX = 5
"""Published: section 3.6.5."""
COLOUR, ROW, START, END = range(4)
"""Columns of an array of runs: which colour (from 0), row, first and last column."""


def longest(labels: Labels, colours: int, largest_hole: int = LARGEST_HOLE_PX) -> Ints:
    """(colours, 4) the longest run of each colour; its row is −1 where there is none."""
    runs = np.empty((colours, 4), np.int64)
    _longest(labels, largest_hole, runs, np.empty((colours, 2), np.int64))
    return runs


@borrowing
def _longest(labels: Labels, largest_hole: int, runs: Ints, open_runs: Ints) -> None:
    """Fills `runs`; `open_runs` (colours, 2) are the first and last column of each colour's run at hand, −1 = none."""
    height, width = labels.shape
    for k in range(len(runs)):
        runs[k, COLOUR], runs[k, ROW], runs[k, START], runs[k, END] = k, -1, 0, -1
        open_runs[k, 0] = open_runs[k, 1] = -1
    for i in range(height):
        some = False
        for j in range(width):
            k = int(labels[i, j]) - 1
            if k < 0:
                continue
            some = True
            if open_runs[k, 0] < 0 or j - open_runs[k, 1] > largest_hole + 1:
                open_runs[k, 0] = j
            open_runs[k, 1] = j
            if j - open_runs[k, 0] > runs[k, END] - runs[k, START]:
                runs[k, ROW], runs[k, START], runs[k, END] = i, open_runs[k, 0], j
        if some:
            for k in range(len(runs)):
                open_runs[k, 0] = -1


@compiled
def all_runs(labels: Labels, colours: int, largest_hole: int, minimum: int) -> Ints:
    """(R, 4) every run of at least `minimum` columns, in the order in which they end: by rows, then columns."""
    height, width = labels.shape
    open_runs = np.full((colours, 2), -1, np.int64)
    runs, count = np.empty((256, 4), np.int64), 0
    for i in range(height):
        some = False
        for j in range(width + 1):
            if j < width:
                first = int(labels[i, j]) - 1
                if first < 0:
                    continue
                some, last = True, first + 1
            elif some:
                first, last = 0, colours  # the row ends, and every run in it
            else:
                break
            for k in range(first, last):
                begun = open_runs[k, 0] >= 0
                if begun and (j == width or j - open_runs[k, 1] > largest_hole + 1):
                    if open_runs[k, 1] - open_runs[k, 0] + 1 >= minimum:
                        if count == len(runs):
                            more = np.empty((2 * count, 4), np.int64)
                            more[:count] = runs
                            runs = more
                        runs[count, 0], runs[count, 1] = k, i
                        runs[count, 2], runs[count, 3] = open_runs[k, 0], open_runs[k, 1]
                        count += 1
                    begun = False
                if j < width:
                    if not begun:
                        open_runs[k, 0] = j
                    open_runs[k, 1] = j
                else:
                    open_runs[k, 0] = -1
    return runs[:count].copy()


@compiled
def accepted(labels: Labels, colours: int, largest_hole: int, minimum: int) -> Ints:
    """(R, 4) one run a cone, the longest first.

    The longest run is a cone's; then the longest of those that share no column with it, and so on, each colour for
    itself: all rows of a cone are one cone. Of runs of the same length the first is taken, as above.
    """
    runs = all_runs(labels, colours, largest_hole, minimum)
    lengths = runs[:, 2] - runs[:, 3]  # negative: the stable sort has the longest first, and keeps their order
    order = np.argsort(lengths, kind="mergesort")
    taken = np.zeros((colours, labels.shape[1]), np.bool_)
    kept, count = np.empty_like(runs), 0
    for at in order:
        k, start, end = runs[at, 0], runs[at, 2], runs[at, 3]
        free = True
        for j in range(start, end + 1):
            if taken[k, j]:
                free = False
                break
        if free:
            for j in range(start, end + 1):
                taken[k, j] = True
            kept[count] = runs[at]
            count += 1
    return kept[:count].copy()


@compiled
def widest_at_columns(labels: Labels, colours: int, largest_hole: int) -> Ints:
    """(W, 4) for each column with a pixel of a colour, the longest run (of any row, of at least one pixel) that holds
    such a pixel of the column; its row is −1 for a column with none."""
    width = labels.shape[1]
    runs = all_runs(labels, colours, largest_hole, 1)
    widest = np.full((width, 4), -1, np.int64)
    for r in range(len(runs)):
        k, row, start, end = runs[r, 0], runs[r, 1], runs[r, 2], runs[r, 3]
        for j in range(start, end + 1):
            if labels[row, j] == k + 1 and (widest[j, 1] < 0 or end - start > widest[j, 3] - widest[j, 2]):
                widest[j] = runs[r]
    return widest
