"""Shapes: lines of several kinds and labelled points (Stiny 1980, section 2), and the similarities that move them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from flocking.compilation import borrowing, compiled
from flocking.types import Floats, Ints
from generation.grammar.lines import TOLERANCE_M, holds, summed, without

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


@borrowing
def is_one(x: float, y: float, heading: float, u: float, v: float, other: float) -> bool:
    """Whether two places are one: (x, y), with a heading or without (nan), and (u, v)."""
    if math.hypot(x - u, y - v) > TOLERANCE_M:
        return False
    if math.isnan(heading) or math.isnan(other):
        return math.isnan(heading) and math.isnan(other)
    turns = (heading - other) / (2.0 * math.pi)
    return abs(turns - round(turns)) * 2.0 * math.pi <= TOLERANCE_RAD


@borrowing
def has_place(labels: Ints, places: Floats, label: int, place: Floats) -> bool:
    """Whether one of these labelled points has this label and this place (3,)."""
    for k in range(labels.size):
        if labels[k] == label and is_one(places[k, 0], places[k, 1], places[k, 2], place[0], place[1], place[2]):
            return True
    return False


@compiled
def added(one: Shape, other: Shape) -> Shape:
    """The sum of two shapes: lines merged to maximal ones, labelled points without doubles."""
    lines, kinds = summed(one.lines, one.kinds, other.lines, other.kinds)
    most = one.labels.size + other.labels.size
    labels, places = np.empty(most, np.int64), np.empty((most, 3))
    count = 0
    for k in range(one.labels.size):
        count = _label(labels, places, count, one.labels[k], one.places[k])
    for k in range(other.labels.size):
        if not has_place(labels[:count], places[:count], other.labels[k], other.places[k]):
            count = _label(labels, places, count, other.labels[k], other.places[k])
    return Shape(lines, kinds, labels[:count], places[:count])


@compiled
def taken(one: Shape, other: Shape) -> Shape:
    """The difference of two shapes: the first without the parts of its lines and the points that the second has."""
    lines, kinds = without(one.lines, one.kinds, other.lines, other.kinds)
    labels, places = np.empty(one.labels.size, np.int64), np.empty((one.labels.size, 3))
    count = 0
    for k in range(one.labels.size):
        if not has_place(other.labels, other.places, one.labels[k], one.places[k]):
            count = _label(labels, places, count, one.labels[k], one.places[k])
    return Shape(lines, kinds, labels[:count], places[:count])


@borrowing
def _label(labels: Ints, places: Floats, count: int, label: int, place: Floats) -> int:
    """Puts a labelled point behind the first `count`, and returns their new number."""
    labels[count] = label
    places[count, 0], places[count, 1], places[count, 2] = place
    return count + 1


@compiled
def moved(one: Shape, row: Floats) -> Shape:
    """A shape under a similarity, given by its numbers (5,)."""
    c, s, m, tx, ty = row
    lines, places = np.empty_like(one.lines), np.empty_like(one.places)
    for k in range(one.kinds.size):
        for end in range(0, 4, 2):
            x, y = one.lines[k, end], one.lines[k, end + 1]
            lines[k, end], lines[k, end + 1] = c * x - s * m * y + tx, s * x + c * m * y + ty
    for k in range(one.labels.size):
        x, y, heading = one.places[k]
        places[k, 0], places[k, 1] = c * x - s * m * y + tx, s * x + c * m * y + ty
        places[k, 2] = math.atan2(s, c) + m * heading
    return Shape(lines, one.kinds.copy(), one.labels.copy(), places)


@compiled
def applied(host: Shape, left: Shape, right: Shape, row: Floats) -> Shape:
    """[C - t(A)] + t(B): the shape C after the rule A -> B under the similarity t (Stiny 1980, section 3)."""
    return added(taken(host, moved(left, row)), moved(right, row))


@borrowing
def part_of(one: Shape, other: Shape) -> bool:
    """Whether the first is a sub-shape of the second: its lines are parts of lines, its labelled points are there."""
    for k in range(one.kinds.size):
        x0, y0, x1, y1 = one.lines[k]
        if not holds(other.lines, other.kinds, x0, y0, x1, y1, one.kinds[k]):
            return False
    for k in range(one.labels.size):  # noqa: SIM110 (a generator is not compiled)
        if not has_place(other.labels, other.places, one.labels[k], one.places[k]):
            return False
    return True


def same(one: Shape, other: Shape) -> bool:
    """Whether two shapes are equal."""
    return bool(part_of(one, other) and part_of(other, one))


def shortest(one: Shape) -> float:
    """The length of the shortest line of a shape, m; inf without lines."""
    return float(np.hypot(one.lines[:, 2] - one.lines[:, 0], one.lines[:, 3] - one.lines[:, 1]).min(initial=math.inf))
