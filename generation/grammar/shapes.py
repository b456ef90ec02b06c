"""Shapes: lines of several kinds and labelled points (Stiny 1980, section 2), and the similarities that move them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from flocking.compilation import compiled
from flocking.types import Floats, Ints
from generation.grammar import lines as maximal


TOLERANCE_RAD = 1e-6
"""Directions nearer to one another than this are one, rad. A choice, as that of places."""


class Shape(NamedTuple):
    """Maximal lines of several kinds, and labelled points. Metres and radians.

    Kinds and labels are numbers: places in the lists of names that a grammar has.
    """

    lines: Floats
    """(L, 4) x0, y0, x1, y1."""
    kinds: Ints
    """(L,) the kind of each line."""
    labels: Ints
    """(P,) the label of each point."""
    places: Floats
    """(P, 3) x, y, heading of each point; nan: one without a direction."""


class Similarity(NamedTuple):
    """A transformation: mirrored in the x axis or not, then scaled, turned, and shifted."""

    scale: float = 1.0
    turn_rad: float = 0.0
    mirrored: bool = False
    x_m: float = 0.0
    y_m: float = 0.0

    def row(self) -> Floats:
        """(5,) the numbers c, s, m, x, y with which (x, y) goes to (c x - s m y + x, s x + c m y + y)."""
        c, s = self.scale * math.cos(self.turn_rad), self.scale * math.sin(self.turn_rad)
        return np.array([c, s, -1.0 if self.mirrored else 1.0, self.x_m, self.y_m])


def of_row(row: Floats) -> Similarity:
    """The similarity of (5,) such numbers."""
    c, s, m, x, y = row.tolist()
    return Similarity(math.hypot(c, s), math.atan2(s, c), m < 0.0, x, y)


EMPTY = Shape(np.empty((0, 4)), np.empty(0, np.int64), np.empty(0, np.int64), np.empty((0, 3)))


def shape(lines: Floats, kinds: Ints, labels: Ints, places: Floats) -> Shape:
    """The shape of any lines (they need not be maximal) and labelled points."""
    return added(EMPTY, Shape(lines, kinds, labels, places))


def added(one: Shape, other: Shape) -> Shape:
    """The sum of two shapes: lines merged to maximal ones, labelled points without doubles."""
    if not other.kinds.size:
        lines, kinds = one.lines, one.kinds
    else:
        lines, kinds = maximal.summed(one.lines, one.kinds, other.lines, other.kinds)
    labels, places = list(one.labels.tolist()), list(one.places.tolist())
    for label, place in zip(other.labels.tolist(), other.places.tolist(), strict=True):
        if not any(label == a and is_one(*place, *b) for a, b in zip(labels, places, strict=True)):
            labels.append(label)
            places.append(place)
    return Shape(lines, kinds, np.array(labels, np.int64), np.array(places, np.float64).reshape(-1, 3))


def taken(one: Shape, other: Shape) -> Shape:
    """The difference of two shapes: the first without the parts of its lines and the points that the second has."""
    if not other.kinds.size:
        lines, kinds = one.lines, one.kinds
    else:
        lines, kinds = maximal.without(one.lines, one.kinds, other.lines, other.kinds)
    gone = list(zip(other.labels.tolist(), other.places.tolist(), strict=True))
    kept = [
        k
        for k, (label, place) in enumerate(zip(one.labels.tolist(), one.places.tolist(), strict=True))
        if not any(label == a and is_one(*place, *b) for a, b in gone)
    ]
    return Shape(lines, kinds, one.labels[kept], one.places[kept])


def moved(one: Shape, row: Floats) -> Shape:
    """A shape under a similarity, given by its numbers (5,)."""
    c, s, m, x, y = row.tolist()
    turned = np.array([[c, s], [-s * m, c * m]])
    lines = (one.lines.reshape(-1, 2) @ turned + (x, y)).reshape(-1, 4)
    places = one.places.copy()
    if places.size:
        places[:, :2] = places[:, :2] @ turned + (x, y)
        places[:, 2] = math.atan2(s, c) + m * places[:, 2]
    return Shape(lines, one.kinds, one.labels, places)


def part_of(one: Shape, other: Shape) -> bool:
    """Whether the first is a sub-shape of the second: its lines are parts of lines, its labelled points are there."""
    for line, kind in zip(one.lines.tolist(), one.kinds.tolist(), strict=True):
        if not maximal.holds(other.lines, other.kinds, *line, kind):
            return False
    has = list(zip(other.labels.tolist(), other.places.tolist(), strict=True))
    return all(
        any(label == a and is_one(*place, *b) for a, b in has)
        for label, place in zip(one.labels.tolist(), one.places.tolist(), strict=True)
    )


def same(one: Shape, other: Shape) -> bool:
    """Whether two shapes are equal."""
    return part_of(one, other) and part_of(other, one)


@compiled
def is_one(x: float, y: float, heading: float, u: float, v: float, other: float) -> bool:
    """Whether two places are one: (x, y), with a heading or without (nan), and (u, v)."""
    if math.hypot(x - u, y - v) > maximal.TOLERANCE_M:
        return False
    if math.isnan(heading) or math.isnan(other):
        return math.isnan(heading) and math.isnan(other)
    turns = (heading - other) / (2.0 * math.pi)
    return abs(turns - round(turns)) * 2.0 * math.pi <= TOLERANCE_RAD


def size(one: Shape) -> float:
    """The farthest that anything in a shape is from its origin, m."""
    ends = np.concatenate([one.lines.reshape(-1, 2), one.places[:, :2]])
    return float(np.hypot(ends[:, 0], ends[:, 1]).max(initial=0.0))


def shortest(one: Shape) -> float:
    """The length of the shortest line of a shape, m; inf without lines."""
    return float(np.hypot(one.lines[:, 2] - one.lines[:, 0], one.lines[:, 3] - one.lines[:, 1]).min(initial=math.inf))
