"""Lines of shapes as maximal lines: sum, difference and part (Stiny 1980, section 2).

Lines (L, 4) are x0, y0, x1, y1 in metres, each of a kind (L,). A shape's lines are maximal: two of one kind that lie on
one another, or end to end in one direction, are one line. So a shape is written in one way only, and a part of a line
is a part of the shape.
"""

from __future__ import annotations

import math

import numpy as np

from flocking.compilation import compiled
from flocking.types import Floats, Ints

TOLERANCE_M = 1e-6
"""Places nearer to one another than this are one, m. A choice: a thousandth of `SHORTEST_M`, and some thousand times
what rounding adds up to over the longest derivation."""
SHORTEST_M = 1e-3
"""Lines shorter than this are not drawn, m. A choice: a millimetre."""


@compiled
def lies_on(x: float, y: float, line: Floats) -> bool:
    """Whether a place lies on a line (4,)."""
    dx, dy = line[2] - line[0], line[3] - line[1]
    length = math.hypot(dx, dy)
    ux, uy = dx / length, dy / length
    rx, ry = x - line[0], y - line[1]
    along = rx * ux + ry * uy
    return abs(rx * uy - ry * ux) <= TOLERANCE_M and -TOLERANCE_M <= along <= length + TOLERANCE_M


@compiled
def holds(lines: Floats, kinds: Ints, x0: float, y0: float, x1: float, y1: float, kind: int) -> bool:
    """Whether the line from (x0, y0) to (x1, y1) is a part of one of these maximal lines of its kind."""
    for k in range(lines.shape[0]):
        if kinds[k] == kind and lies_on(x0, y0, lines[k]) and lies_on(x1, y1, lines[k]):
            return True
    return False


@compiled
def summed(lines: Floats, kinds: Ints, more: Floats, more_kinds: Ints) -> tuple[Floats, Ints]:
    """The maximal lines of both together; the first have to be maximal already. Those of `more` come last, in order."""
    most = lines.shape[0] + more.shape[0]
    out, out_kinds = np.empty((most, 4)), np.empty(most, np.int64)
    count = lines.shape[0]
    out[:count], out_kinds[:count] = lines, kinds
    grown = np.empty(4)
    for m in range(more.shape[0]):
        grown[:] = more[m]
        kind = more_kinds[m]
        merged = True
        while merged:  # a line that has grown may reach another
            merged = False
            kept = 0
            for k in range(count):
                if not merged and out_kinds[k] == kind and _meets(out[k], grown):
                    _merge(grown, out[k])
                    merged = True
                else:
                    out[kept], out_kinds[kept] = out[k], out_kinds[k]
                    kept += 1
            count = kept
        out[count], out_kinds[count] = grown, kind
        count += 1
    return out[:count].copy(), out_kinds[:count].copy()


@compiled
def without(lines: Floats, kinds: Ints, taken: Floats, taken_kinds: Ints) -> tuple[Floats, Ints]:
    """What is left of maximal lines where these are taken away."""
    most = lines.shape[0] + taken.shape[0]  # each that is taken lies within one line at the most
    out, out_kinds = np.empty((most, 4)), np.empty(most, np.int64)
    count = lines.shape[0]
    out[:count], out_kinds[:count] = lines, kinds
    for t in range(taken.shape[0]):
        for k in range(count):
            if out_kinds[k] != taken_kinds[t] or not _meets(out[k], taken[t]):
                continue
            x0, y0, x1, y1 = out[k, 0], out[k, 1], out[k, 2], out[k, 3]
            length = math.hypot(x1 - x0, y1 - y0)
            ux, uy = (x1 - x0) / length, (y1 - y0) / length
            a = (taken[t, 0] - x0) * ux + (taken[t, 1] - y0) * uy
            b = (taken[t, 2] - x0) * ux + (taken[t, 3] - y0) * uy
            low, high = min(a, b), max(a, b)
            if min(high, length) - max(low, 0.0) <= TOLERANCE_M:  # they only touch
                continue
            before, after = low > TOLERANCE_M, high < length - TOLERANCE_M
            if before:
                out[k, 2], out[k, 3] = x0 + low * ux, y0 + low * uy
            if after and not (before and count == most):
                at = count if before else k
                out[at, 0], out[at, 1] = x0 + high * ux, y0 + high * uy
                out[at, 2], out[at, 3] = x1, y1
                out_kinds[at] = out_kinds[k]
                if before:
                    count += 1
            if not before and not after:
                out_kinds[k] = -1  # gone
    kept = 0
    for k in range(count):
        if out_kinds[k] >= 0:
            out[kept], out_kinds[kept] = out[k], out_kinds[k]
            kept += 1
    return out[:kept].copy(), out_kinds[:kept].copy()


@compiled
def _meets(one: Floats, other: Floats) -> bool:
    """Whether two lines lie in one direction and overlap or touch end to end."""
    length = math.hypot(one[2] - one[0], one[3] - one[1])
    second = math.hypot(other[2] - other[0], other[3] - other[1])
    if second > length:  # the longer one has the better direction
        one, other, length = other, one, second
    ux, uy = (one[2] - one[0]) / length, (one[3] - one[1]) / length
    ax, ay, bx, by = other[0] - one[0], other[1] - one[1], other[2] - one[0], other[3] - one[1]
    if abs(ax * uy - ay * ux) > TOLERANCE_M or abs(bx * uy - by * ux) > TOLERANCE_M:
        return False
    a, b = ax * ux + ay * uy, bx * ux + by * uy
    return min(a, b) <= length + TOLERANCE_M and max(a, b) >= -TOLERANCE_M


@compiled
def _merge(grown: Floats, other: Floats) -> None:
    """Makes the first line reach over the second, with which it meets."""
    ux, uy = grown[2] - grown[0], grown[3] - grown[1]
    if math.hypot(other[2] - other[0], other[3] - other[1]) > math.hypot(ux, uy):
        ux, uy = other[2] - other[0], other[3] - other[1]
        if ux * (grown[2] - grown[0]) + uy * (grown[3] - grown[1]) < 0.0:
            ux, uy = -ux, -uy
    x0, y0, x1, y1 = grown[0], grown[1], grown[2], grown[3]
    for k in range(2):
        x, y = other[2 * k], other[2 * k + 1]
        if x * ux + y * uy < x0 * ux + y0 * uy:
            x0, y0 = x, y
        if x * ux + y * uy > x1 * ux + y1 * uy:
            x1, y1 = x, y
    grown[0], grown[1], grown[2], grown[3] = x0, y0, x1, y1
