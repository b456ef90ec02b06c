"""Lines of shapes as maximal lines: sum, difference and part (Stiny 1980, section 2).

Lines (L, 4) are x0, y0, x1, y1 in metres, each of a kind (L,). A shape's lines are maximal: two of one kind that lie on
one another, or end to end in one direction, are one line. So a shape is written in one way only, and a part of a line
is a part of the shape.
"""

from __future__ import annotations

import math

import numpy as np

from flocking.compilation import borrowing, compiled
from flocking.types import Floats, Ints

TOLERANCE_M = 1e-6
"""Places nearer to one another than this are one, m. A choice: a thousandth of `SHORTEST_M`, and some thousand times
what rounding adds up to over the longest derivation."""
SHORTEST_M = 1e-3
"""Lines shorter than this are not drawn, m. A choice: a millimetre."""


@borrowing
def lies_on(x: float, y: float, line: Floats) -> bool:
    """Whether a place lies on a line (4,)."""
    dx, dy = line[2] - line[0], line[3] - line[1]
    length = math.hypot(dx, dy)
    ux, uy = dx / length, dy / length
    rx, ry = x - line[0], y - line[1]
    along = rx * ux + ry * uy
    return abs(rx * uy - ry * ux) <= TOLERANCE_M and -TOLERANCE_M <= along <= length + TOLERANCE_M


@borrowing
def holds(lines: Floats, kinds: Ints, x0: float, y0: float, x1: float, y1: float, kind: int) -> bool:
    """Whether the line from (x0, y0) to (x1, y1) is a part of one of these maximal lines of its kind."""
    for k in range(lines.shape[0]):
        if kinds[k] == kind and lies_on(x0, y0, lines[k]) and lies_on(x1, y1, lines[k]):
            return True
    return False


@compiled
def summed(lines: Floats, kinds: Ints, more: Floats, more_kinds: Ints) -> tuple[Floats, Ints]:
    """The maximal lines of both together; the first have to be maximal already. Those of `more` come last, in order."""
    most = kinds.size + more_kinds.size
    out, out_kinds = np.empty((most, 4)), np.empty(most, np.int64)
    count = _copied(lines, kinds, out, out_kinds)
    for m in range(more_kinds.size):
        count = _put(more[m], more_kinds[m], out, out_kinds, count)
    return out[:count], out_kinds[:count]


@borrowing
def _put(line: Floats, kind: int, out: Floats, out_kinds: Ints, count: int) -> int:
    """Adds a line to the first `count` of `out`, merged with those that it meets, and returns their new number."""
    x0, y0, x1, y1 = line
    while True:  # a line that has grown may reach another
        met = -1
        for k in range(count):
            if met < 0 and out_kinds[k] == kind and _meets(out[k], x0, y0, x1, y1):
                met = k
                x0, y0, x1, y1 = _merged(out[k], x0, y0, x1, y1)
            elif met >= 0:
                _set(out, out_kinds, k - 1, out[k, 0], out[k, 1], out[k, 2], out[k, 3], out_kinds[k])
        if met < 0:
            _set(out, out_kinds, count, x0, y0, x1, y1, kind)
            return count + 1
        count -= 1


@compiled
def without(lines: Floats, kinds: Ints, taken: Floats, taken_kinds: Ints) -> tuple[Floats, Ints]:
    """What is left of maximal lines where these are taken away."""
    most = kinds.size + taken_kinds.size  # each that is taken lies within one line at the most
    out, out_kinds = np.empty((most, 4)), np.empty(most, np.int64)
    count = _copied(lines, kinds, out, out_kinds)
    for t in range(taken_kinds.size):
        count = _cut(taken[t], taken_kinds[t], out, out_kinds, count)
    return out[:count], out_kinds[:count]


@borrowing
def _cut(line: Floats, kind: int, out: Floats, out_kinds: Ints, count: int) -> int:
    """Takes a line away from the first `count` lines of `out`, and returns their new number."""
    kept, total = 0, count
    for k in range(count):
        x0, y0, x1, y1 = out[k]
        of = out_kinds[k]
        if of != kind or not _meets(line, x0, y0, x1, y1):
            _set(out, out_kinds, kept, x0, y0, x1, y1, of)
            kept += 1
            continue
        length = math.hypot(x1 - x0, y1 - y0)
        ux, uy = (x1 - x0) / length, (y1 - y0) / length
        a = (line[0] - x0) * ux + (line[1] - y0) * uy
        b = (line[2] - x0) * ux + (line[3] - y0) * uy
        low, high = min(a, b), max(a, b)
        before, after = low > TOLERANCE_M, high < length - TOLERANCE_M
        if before and after and low < high and total < out_kinds.size:
            _set(out, out_kinds, total, x0 + high * ux, y0 + high * uy, x1, y1, of)
            total += 1
            after = False
        if before:
            _set(out, out_kinds, kept, x0, y0, x0 + min(low, length) * ux, y0 + min(low, length) * uy, of)
            kept += 1
        elif after:
            _set(out, out_kinds, kept, x0 + max(high, 0.0) * ux, y0 + max(high, 0.0) * uy, x1, y1, of)
            kept += 1
    for k in range(count, total):
        _set(out, out_kinds, kept, out[k, 0], out[k, 1], out[k, 2], out[k, 3], out_kinds[k])
        kept += 1
    return kept


@borrowing
def _copied(lines: Floats, kinds: Ints, out: Floats, out_kinds: Ints) -> int:
    for k in range(kinds.size):
        _set(out, out_kinds, k, lines[k, 0], lines[k, 1], lines[k, 2], lines[k, 3], kinds[k])
    return int(kinds.size)


@borrowing
def _set(out: Floats, out_kinds: Ints, k: int, x0: float, y0: float, x1: float, y1: float, kind: int) -> None:
    out[k, 0], out[k, 1], out[k, 2], out[k, 3], out_kinds[k] = x0, y0, x1, y1, kind


@borrowing
def _meets(line: Floats, x0: float, y0: float, x1: float, y1: float) -> bool:
    """Whether two lines lie in one direction and overlap or touch end to end."""
    u0, v0, u1, v1 = line
    if math.hypot(x1 - x0, y1 - y0) > math.hypot(u1 - u0, v1 - v0):  # the longer one has the better direction
        u0, v0, u1, v1, x0, y0, x1, y1 = x0, y0, x1, y1, u0, v0, u1, v1
    length = math.hypot(u1 - u0, v1 - v0)
    ux, uy = (u1 - u0) / length, (v1 - v0) / length
    if abs((x0 - u0) * uy - (y0 - v0) * ux) > TOLERANCE_M or abs((x1 - u0) * uy - (y1 - v0) * ux) > TOLERANCE_M:
        return False
    a, b = (x0 - u0) * ux + (y0 - v0) * uy, (x1 - u0) * ux + (y1 - v0) * uy
    return min(a, b) <= length + TOLERANCE_M and max(a, b) >= -TOLERANCE_M


@borrowing
def _merged(line: Floats, x0: float, y0: float, x1: float, y1: float) -> tuple[float, float, float, float]:
    """The line over two that meet, in the direction of the second."""
    ux, uy = x1 - x0, y1 - y0
    if math.hypot(line[2] - line[0], line[3] - line[1]) > math.hypot(ux, uy):
        sense = math.copysign(1.0, ux * (line[2] - line[0]) + uy * (line[3] - line[1]))
        ux, uy = sense * (line[2] - line[0]), sense * (line[3] - line[1])
    for k in range(0, 4, 2):
        x, y = line[k], line[k + 1]
        if x * ux + y * uy < x0 * ux + y0 * uy:
            x0, y0 = x, y
        if x * ux + y * uy > x1 * ux + y1 * uy:
            x1, y1 = x, y
    return x0, y0, x1, y1
