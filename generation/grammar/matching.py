"""Where a left side matches: all similarities under which it is a sub-shape (Stiny 1980; Krishnamurti 1981).

Two places of a left side and where they go decide a similarity, but for its mirror image. The first is a labelled
point, or where two of its lines meet when they are prolonged; the second is another labelled point, or the foot of the
perpendicular on another line. So candidates are few, all are found, and each is tried on the whole left side.

A left side whose size or place along a line is left open, as a single line's, has infinitely many matches. Of these the
ones are taken that put an end of its lines on an end of a line.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from flocking.compilation import borrowing
from flocking.errors import InputError
from flocking.types import Floats, Ints
from generation.grammar.lines import TOLERANCE_M, holds
from generation.grammar.shapes import TOLERANCE_RAD, Shape, is_one

LABEL, CORNER, END, FOOT, HEADING, DIRECTION, NONE = range(7)
TOLERANCE_SCALE = 1e-6
"""Scales nearer to one than this are one. A choice, as that of places."""
LEAST_ANGLE = 1e-4
"""Lines that are nearer to parallel than this, rad, are parallel. A choice."""


CAPACITY = 64
"""Matches for which there is room at first. A choice."""


class Allowed(NamedTuple):
    """Under which transformations a left side may match."""

    translation: bool = True
    rotation: bool = True
    scale: bool = True
    reflection: bool = True


class Plan(NamedTuple):
    """Which places of a left side decide where it matches."""

    anchor: int
    """LABEL, CORNER or END (of all lines)."""
    first: int
    """The labelled point, or the first line of the corner."""
    other: int
    """The second line of the corner."""
    second: int
    """LABEL, FOOT, END, HEADING (of the anchor), DIRECTION (of a line) or NONE."""
    of: int
    """The labelled point or the line of the second."""


def plan(left: Shape, allowed: Allowed, name: str) -> Plan:
    """The places that decide where a left side matches. Raises `InputError` where they leave a match undecided."""
    anchor, first, other = END, 0, 0
    if left.labels.size:
        directed = np.flatnonzero(~np.isnan(left.places[:, 2]))
        anchor, first = LABEL, int(directed[0]) if directed.size else 0
        at = left.places[first, :2]
    else:
        corners = [
            (i, j) for i in range(len(left.kinds)) for j in range(i) if _crossing(left.lines[i], left.lines[j])[0]
        ]
        if corners:
            anchor, (first, other) = CORNER, corners[0]
            _, x, y = _crossing(left.lines[first], left.lines[other])
            at = np.array([x, y])
        else:
            at = left.lines[0, :2]
    labels = np.flatnonzero(np.hypot(*(left.places[:, :2] - at).T) > TOLERANCE_M)
    feet = [k for k, line in enumerate(left.lines) if math.dist(_foot(at[0], at[1], line), at) > TOLERANCE_M]
    through = [k for k in range(len(left.kinds)) if k not in feet]
    if not allowed.scale and not allowed.rotation:
        return Plan(anchor, first, other, NONE, 0)
    if not allowed.scale and anchor == LABEL and not math.isnan(left.places[first, 2]):
        return Plan(anchor, first, other, HEADING, 0)
    if not allowed.scale and anchor != LABEL:
        return Plan(anchor, first, other, DIRECTION, first)
    if labels.size:
        return Plan(anchor, first, other, LABEL, int(labels[0]))
    if feet:
        return Plan(anchor, first, other, FOOT, feet[0])
    if through and not allowed.scale:
        return Plan(anchor, first, other, DIRECTION, through[0])
    if through:
        return Plan(anchor, first, other, END, 0)
    open_ = "size" if allowed.scale else "direction"
    raise InputError(
        f"left side {name!r}: its labels alone leave the {open_} of a match open; expected a line or a second label in "
        f"it, or `under` without {'scale' if allowed.scale else 'rotation'}"
        + ("" if allowed.scale else ", or a heading of its label")
    )


class Search(NamedTuple):
    """What is looked for, where, and what has been found."""

    left: Shape
    host: Shape
    plan: Plan
    allowed: Allowed
    least: float
    most_m: float
    found: Floats
    """(capacity, 5) the similarities, in the order in which they were found."""
    total: Ints
    """(1,) their number; beyond the capacity they are counted only."""


def matches(left: Shape, host: Shape, plan: Plan, allowed: Allowed, least: float, most_m: float) -> Floats:
    """(M, 5) all similarities (`shapes.Similarity.row`) under which `left` is a sub-shape of `host`.

    Those of a scale below `least`, and those that shift by more than `most_m`, are left out.
    """
    capacity = CAPACITY
    while True:
        found, total = np.empty((capacity, 5)), np.zeros(1, np.int64)
        _search(Search(left, host, plan, allowed, least, most_m, found, total))
        if total[0] <= capacity:
            return found[: total[0]]
        capacity = int(total[0])


@borrowing
def _search(search: Search) -> None:
    """Tries all similarities that bring the anchor of the left side to its like in the host."""
    left, host, plan = search.left, search.host, search.plan
    if plan.anchor == LABEL:
        px, py = left.places[plan.first, 0], left.places[plan.first, 1]
        for k in range(host.labels.size):
            if host.labels[k] == left.labels[plan.first]:
                x, y, heading = host.places[k]
                _from(px, py, x, y, heading, -1, 0, search)
    elif plan.anchor == CORNER:
        one, two = left.lines[plan.first], left.lines[plan.other]
        _, px, py = _crossing(one, two)
        for i in range(host.kinds.size):
            for j in range(host.kinds.size):
                alike = host.kinds[i] == left.kinds[plan.first] and host.kinds[j] == left.kinds[plan.other]
                if alike and abs(_sine(host.lines[i], host.lines[j]) - _sine(one, two)) <= TOLERANCE_RAD:
                    crosses, x, y = _crossing(host.lines[i], host.lines[j])
                    if crosses:
                        _from(px, py, x, y, np.nan, i, 0, search)
    else:
        for line in range(left.kinds.size):
            for i in range(host.kinds.size):
                if host.kinds[i] == left.kinds[line]:
                    for end in range(0, 4, 2):
                        px, py = left.lines[line, end], left.lines[line, end + 1]
                        _from(px, py, host.lines[i, 0], host.lines[i, 1], np.nan, i, line, search)
                        _from(px, py, host.lines[i, 2], host.lines[i, 3], np.nan, i, line, search)


@borrowing
def _from(px: float, py: float, x: float, y: float, heading: float, on: int, line: int, search: Search) -> None:
    """Tries all similarities that bring (px, py) of the left side to (x, y) of the host.

    `heading`: of the host's label there; `on`: the host's line through it, -1 for any; `line`: the left side's.
    """
    left, host, plan = search.left, search.host, search.plan
    if plan.second == NONE:
        _try(1.0, 0.0, 1.0, px, py, x, y, search)
        if search.allowed.reflection:
            _try(1.0, 0.0, -1.0, px, py, x, y, search)
            _try(-1.0, 0.0, -1.0, px, py, x, y, search)
    elif plan.second == HEADING:
        if not math.isnan(heading):
            _turned(left.places[plan.first, 2], heading, px, py, x, y, search)
    elif plan.second == DIRECTION:
        of = line if plan.anchor == END else plan.of
        angle = _angle(left.lines[of])
        for k in range(host.kinds.size):
            if host.kinds[k] == left.kinds[of] and on in (-1, k):
                _turned(angle, _angle(host.lines[k]), px, py, x, y, search)
                _turned(angle, _angle(host.lines[k]) + math.pi, px, py, x, y, search)
    elif plan.second == LABEL:
        qx, qy = left.places[plan.of, 0], left.places[plan.of, 1]
        for k in range(host.labels.size):
            if host.labels[k] == left.labels[plan.of]:
                _both(px, py, qx, qy, x, y, host.places[k, 0], host.places[k, 1], search)
    elif plan.second == FOOT:
        of = plan.of
        if plan.anchor == END:  # any line that does not go through this end
            for k in range(left.kinds.size):
                qx, qy = _foot(px, py, left.lines[k])
                if math.hypot(qx - px, qy - py) > TOLERANCE_M:
                    of = k
                    break
        qx, qy = _foot(px, py, left.lines[of])
        for k in range(host.kinds.size):
            if host.kinds[k] == left.kinds[of]:
                u, v = _foot(x, y, host.lines[k])
                _both(px, py, qx, qy, x, y, u, v, search)
    else:
        for of in range(left.kinds.size):
            for k in range(host.kinds.size):
                if host.kinds[k] == left.kinds[of]:
                    for end in range(0, 4, 2):
                        qx, qy = left.lines[of, end], left.lines[of, end + 1]
                        _both(px, py, qx, qy, x, y, host.lines[k, 0], host.lines[k, 1], search)
                        _both(px, py, qx, qy, x, y, host.lines[k, 2], host.lines[k, 3], search)


@borrowing
def _both(px: float, py: float, qx: float, qy: float, x: float, y: float, u: float, v: float, search: Search) -> None:
    """Tries the two similarities that bring (px, py) and (qx, qy) of the left side to (x, y) and (u, v) of the host."""
    dx, dy, ex, ey = qx - px, qy - py, u - x, v - y
    square = dx * dx + dy * dy
    if square <= TOLERANCE_M**2 or ex * ex + ey * ey <= TOLERANCE_M**2:
        return
    _try((ex * dx + ey * dy) / square, (ey * dx - ex * dy) / square, 1.0, px, py, x, y, search)
    if search.allowed.reflection:
        _try((ex * dx - ey * dy) / square, (ey * dx + ex * dy) / square, -1.0, px, py, x, y, search)


@borrowing
def _turned(angle: float, to: float, px: float, py: float, x: float, y: float, search: Search) -> None:
    """Tries the two similarities without scale that turn a direction of the left side to one of the host."""
    _try(math.cos(to - angle), math.sin(to - angle), 1.0, px, py, x, y, search)
    if search.allowed.reflection:
        _try(math.cos(to + angle), math.sin(to + angle), -1.0, px, py, x, y, search)


@borrowing
def _try(c: float, s: float, m: float, px: float, py: float, x: float, y: float, search: Search) -> None:
    """Adds a similarity to those found if it is allowed, new, and brings the whole left side onto the host."""
    scale = math.hypot(c, s)
    if scale < search.least:
        return
    if not search.allowed.scale:
        if abs(scale - 1.0) > TOLERANCE_SCALE:
            return
        c, s, scale = c / scale, s / scale, 1.0
    if not search.allowed.rotation:
        if abs(s) > TOLERANCE_RAD * scale or (c < 0.0 and m > 0.0):
            return
        c, s = math.copysign(scale, c), 0.0
    tx, ty = x - c * px + s * m * py, y - s * px - c * m * py
    if abs(tx) > search.most_m or abs(ty) > search.most_m:
        return
    if not search.allowed.translation:
        if math.hypot(tx, ty) > TOLERANCE_M:
            return
        tx, ty = 0.0, 0.0
    for k in range(min(search.total[0], search.found.shape[0])):
        a, b, n, u, v = search.found[k]
        if n == m and math.hypot(a - c, b - s) <= TOLERANCE_SCALE * scale and math.hypot(u - tx, v - ty) <= TOLERANCE_M:
            return
    if _brings(c, s, m, tx, ty, search.left, search.host):
        if search.total[0] < search.found.shape[0]:
            row = search.found[search.total[0]]
            row[0], row[1], row[2], row[3], row[4] = c, s, m, tx, ty
        search.total[0] += 1


@borrowing
def _brings(c: float, s: float, m: float, tx: float, ty: float, left: Shape, host: Shape) -> bool:
    """Whether a similarity brings the whole left side onto the host."""
    for k in range(left.kinds.size):
        x0, y0, x1, y1 = left.lines[k]
        u0, v0 = c * x0 - s * m * y0 + tx, s * x0 + c * m * y0 + ty
        u1, v1 = c * x1 - s * m * y1 + tx, s * x1 + c * m * y1 + ty
        if not holds(host.lines, host.kinds, u0, v0, u1, v1, left.kinds[k]):
            return False
    for k in range(left.labels.size):
        x, y, heading = left.places[k]
        u, v, to = c * x - s * m * y + tx, s * x + c * m * y + ty, math.atan2(s, c) + m * heading
        there = False
        for n in range(host.labels.size):
            if host.labels[n] == left.labels[k]:
                there = there or is_one(u, v, to, host.places[n, 0], host.places[n, 1], host.places[n, 2])
        if not there:
            return False
    return True


@borrowing
def _angle(line: Floats) -> float:
    return math.atan2(line[3] - line[1], line[2] - line[0])


@borrowing
def _crossing(one: Floats, other: Floats) -> tuple[bool, float, float]:
    """Whether two lines, prolonged, meet in one place, and where."""
    ux, uy, vx, vy = one[2] - one[0], one[3] - one[1], other[2] - other[0], other[3] - other[1]
    cross = ux * vy - uy * vx
    if abs(cross) <= LEAST_ANGLE * math.hypot(ux, uy) * math.hypot(vx, vy):
        return False, 0.0, 0.0
    t = ((other[0] - one[0]) * vy - (other[1] - one[1]) * vx) / cross
    return True, one[0] + t * ux, one[1] + t * uy


@borrowing
def _sine(one: Floats, other: Floats) -> float:
    """The sine of the angle between two lines, without sign."""
    ux, uy, vx, vy = one[2] - one[0], one[3] - one[1], other[2] - other[0], other[3] - other[1]
    return float(abs(ux * vy - uy * vx) / (math.hypot(ux, uy) * math.hypot(vx, vy)))


@borrowing
def _foot(x: float, y: float, line: Floats) -> tuple[float, float]:
    """The foot of the perpendicular from a place on a line, prolonged."""
    ux, uy = line[2] - line[0], line[3] - line[1]
    t = ((x - line[0]) * ux + (y - line[1]) * uy) / (ux * ux + uy * uy)
    return line[0] + t * ux, line[1] + t * uy
