"""What a map's region of successful configurations is like: its area, density and connection, as numbers.

Fine 2015, section 7.4, asks for regions of high density and for their connectivity, and gives no measures: those here
are ours. A map by refinement is read as the cells that its deepest configurations stand for, at the finest resolution;
volumes are shares of what the schema makes something of.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from scipy import ndimage

from flocking.types import Bools, Floats, Ints
from generation.maps.trees import ParameterMap, painted


class Region(NamedTuple):
    """The successful configurations of a map. All but the last two are nan for a map of random configurations."""

    area: float
    """Share of the possible parameters whose cell is successful."""
    density: float
    """Share of the possible parameters around a successful one that are successful as well, mean over the successful
    ones; around: in a window as wide as a cell of the first iteration. As much as the area where successes are strewn
    at random, 1 inside of a large region without holes. nan without a success."""
    components: float
    """Parts of the successful cells that faces connect; a full turn goes on at its beginning."""
    largest_share: float
    """Volume share of the largest of them; nan without a success."""
    mean: float
    """Mean share of successes over the possible parameters; of a random map over its configurations."""
    inside: float
    """The same in a box; nan where no box is given."""
    outside: float
    """And outside of it."""


def region(map_: ParameterMap, within: Mapping[str, tuple[float, float]] | None = None) -> Region:
    """The measures of a map's region. `within`: a box, by the names of its axes; other axes count whole."""
    share = np.where(map_.possible, map_.judged.successes / np.maximum(map_.judged.trials, 1), np.nan)
    if (map_.levels < 0).any():
        box = _in_box(map_, map_.points, within)
        return Region(math.nan, math.nan, math.nan, math.nan, *_means(share, np.ones(len(share)), box))
    level = map_.finest
    owner = painted(map_.box, map_.cells, map_.levels, level)
    possible, success = map_.possible[owner] & (owner >= 0), map_.successful[owner] & (owner >= 0)
    whole = max(1, int(possible.sum()))
    _, sizes = components(success, map_.box.wraps)
    in_box = _cells_in_box(map_, within, level)
    means = _means(share[owner], possible.astype(np.float64), in_box)
    return Region(
        float(success.sum()) / whole,
        density(success, possible, 1 << level, map_.box.wraps),
        float(len(sizes)),
        float(sizes.max()) / float(sizes.sum()) if len(sizes) else math.nan,
        *means,
    )


def density(success: Bools, possible: Bools, window: int, wraps: Bools) -> float:
    """Share of success among the possible cells in a window of so many cells about a successful one: their mean."""
    if not success.any():
        return math.nan
    modes = ["wrap" if each else "constant" for each in wraps]
    near = ndimage.uniform_filter(success.astype(np.float64), window, mode=modes)
    there = ndimage.uniform_filter(possible.astype(np.float64), window, mode=modes)
    return float(np.clip(near[success] / there[success], 0.0, 1.0).mean())


def components(success: Bools, wraps: Bools) -> tuple[Ints, Floats]:
    """The parts that faces connect: a label of each cell, 0 = none, and how many cells each part has."""
    labels, count = ndimage.label(success)
    parent = np.arange(count + 1)

    def root(label: int) -> int:
        while parent[label] != label:
            label = int(parent[label])
        return label

    for axis in np.flatnonzero(wraps):
        first, last = labels.take(0, axis), labels.take(-1, axis)
        for one, other in zip(first[(first > 0) & (last > 0)], last[(first > 0) & (last > 0)], strict=True):
            a, b = sorted((root(int(one)), root(int(other))))
            parent[b] = a
    roots = np.array([root(label) for label in range(count + 1)])
    kept, joined = np.unique(roots[labels], return_inverse=True)
    joined = joined.reshape(labels.shape) + (0 if kept[0] == 0 else 1)
    return joined, np.bincount(joined.ravel())[1:].astype(np.float64)


def _means(share: Floats, weights: Floats, in_box: Floats | None) -> tuple[float, float, float]:
    """The mean share of success everywhere, in the box (`in_box`: how much of each is), and outside."""
    known = np.isfinite(share)
    parts = [weights] if in_box is None else [weights, weights * in_box, weights * (1.0 - in_box)]
    found = [
        float((share[known] * part[known]).sum() / part[known].sum()) if part[known].sum() > 0.0 else math.nan
        for part in parts
    ]
    return (found[0], math.nan, math.nan) if in_box is None else (found[0], found[1], found[2])


def _in_box(map_: ParameterMap, points: Floats, within: Mapping[str, tuple[float, float]] | None) -> Floats | None:
    """(C,) 1 for points in the box, 0 for others."""
    if within is None:
        return None
    inside = np.ones(len(points), np.bool_)
    for column, axis in enumerate(map_.box.axes):
        low, high = within.get(axis.name, (-math.inf, math.inf))
        inside &= (points[:, column] >= low) & (points[:, column] <= high)
    return inside.astype(np.float64)


def _cells_in_box(map_: ParameterMap, within: Mapping[str, tuple[float, float]] | None, level: int) -> Floats | None:
    """How much of each of the finest cells is in the box."""
    if within is None:
        return None
    found = np.ones(map_.box.shape(level))
    for column, (axis, cells) in enumerate(zip(map_.box.axes, map_.box.shape(level), strict=True)):
        low, high = within.get(axis.name, (-math.inf, math.inf))
        edges = np.linspace(axis.low, axis.high, cells + 1)
        covered = np.clip(np.minimum(edges[1:], high) - np.maximum(edges[:-1], low), 0.0, None) / np.diff(edges)
        shape = [1] * found.ndim
        shape[column] = cells
        found *= covered.reshape(shape)
    return found
