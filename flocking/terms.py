"""Terms that laws share: unit vectors, the way to the goal, means over chosen members, normal draws. All compiled."""

from __future__ import annotations

import math

from flocking.compilation import compiled
from flocking.lanes import over
from flocking.types import Bools, Floats

NEGLIGIBLE = 1e-12
"""A sum or mean of vectors no longer than this, in the vectors' own unit, is zero but for rounding."""


@compiled
def length_of(x: float, y: float) -> float:
    """Length of (x, y), by `math.hypot` only where squares under- or overflow: it takes three times as long."""
    length = math.sqrt(x * x + y * y)
    if length < 1e-150 or length == math.inf:
        return math.hypot(x, y)
    return length


@compiled
def unit(x: float, y: float) -> tuple[float, float]:
    """(x, y) divided by its length; (0, 0) for a vector that has none."""
    length = length_of(x, y)
    if length == 0.0:
        return 0.0, 0.0
    return over(x, y, length)


@compiled
def unit_or_ahead(x: float, y: float) -> tuple[float, float]:
    """(x, y) divided by its length; straight ahead, (1, 0), for a vector that has none: a member at rest."""
    ux, uy = unit(x, y)
    if ux == 0.0 and uy == 0.0:
        return 1.0, 0.0
    return ux, uy


@compiled
def towards_goal(goal: Floats) -> tuple[bool, float, float]:
    """Whether a member has a goal, and the unit vector towards it: (0, 0) if it has none or has reached it.

    `goal` (2,) is its position relative to the member, m, and nan for a member that has none.
    """
    if math.isnan(goal[0]):
        return False, 0.0, 0.0
    x, y = unit(goal[0], goal[1])
    return True, x, y


@compiled
def direction(x: float, y: float) -> float:
    """Angle (rad) of the vector (x, y); 0 for one that has no length, whatever the signs of its zeros."""
    if x == 0.0 and y == 0.0:
        return 0.0
    return math.atan2(y, x)


@compiled
def count(chosen: Bools) -> int:
    """How many members are chosen."""
    found = 0
    for j in range(len(chosen)):
        if chosen[j]:
            found += 1
    return found


@compiled
def mean_vector(vectors: Floats, chosen: Bools) -> tuple[int, float, float]:
    """Number of chosen members and the mean of their rows of `vectors` (M, 2); (0, 0, 0) of nobody."""
    found, x, y = 0, 0.0, 0.0
    for j in range(len(chosen)):
        if chosen[j]:
            found += 1
            x += vectors[j, 0]
            y += vectors[j, 1]
    if found == 0:
        return 0, 0.0, 0.0
    return found, x / found, y / found


@compiled
def mean_unit_vector(vectors: Floats, chosen: Bools) -> tuple[int, float, float]:
    """The same of the unit vectors along the rows; a row without length counts as (0, 0)."""
    found, x, y = 0, 0.0, 0.0
    for j in range(len(chosen)):
        if chosen[j]:
            found += 1
            ux, uy = unit(vectors[j, 0], vectors[j, 1])
            x += ux
            y += uy
    if found == 0:
        return 0, 0.0, 0.0
    return found, x / found, y / found


@compiled
def mean_direction(angles: Floats, chosen: Bools) -> tuple[int, float, float]:
    """The same of the unit vectors at `angles` (M,), rad: bearings or headings."""
    found, x, y = 0, 0.0, 0.0
    for j in range(len(chosen)):
        if chosen[j]:
            found += 1
            x += math.cos(angles[j])
            y += math.sin(angles[j])
    if found == 0:
        return 0, 0.0, 0.0
    return found, x / found, y / found


@compiled
def heading_with_itself(headings: Floats, chosen: Bools) -> float:
    """Direction (rad) of the sum of the unit vectors at the chosen `headings` and of one's own, which is 0.

    0, one's own heading kept, where they cancel out.
    """
    found, x, y = mean_direction(headings, chosen)
    return math.atan2(found * y, found * x + 1.0)


@compiled
def rotated(x: float, y: float, angle: float) -> tuple[float, float]:
    """(x, y) turned counter-clockwise by `angle`, rad."""
    c, s = math.cos(angle), math.sin(angle)
    return c * x - s * y, s * x + c * y


@compiled
def normal(u: float) -> float:
    """The standard normal number at quantile u in [0, 1); normal(1 - u) is minus normal(u).

    Acklam's rational approximation (2003) refined by one step of Halley's method: errors below 1e-14 relative.
    """
    p = min(max(u, 1e-16), 1.0 - 1e-16)
    mirrored = p > 0.5
    if mirrored:
        p = 1.0 - p
    if p < 0.02425:
        q = math.sqrt(-2.0 * math.log(p))
        top = -7.784894002430293e-03
        for c in (-3.223964580411365e-01, -2.400758277161838, -2.549732539343734, 4.374664141464968, 2.938163982698783):
            top = top * q + c
        bottom = 7.784695709041462e-03
        for c in (3.224671290700398e-01, 2.445134137142996, 3.754408661907416, 1.0):
            bottom = bottom * q + c
        x = top / bottom
    else:
        q = p - 0.5
        r = q * q
        top = -3.969683028665376e01
        for c in (
            2.209460984245205e02,
            -2.759285104469687e02,
            1.383577518672690e02,
            -3.066479806614716e01,
            2.506628277459239,
        ):
            top = top * r + c
        bottom = -5.447609879822406e01
        for c in (1.615858368580409e02, -1.556989798598866e02, 6.680131188771972e01, -1.328068155288572e01, 1.0):
            bottom = bottom * r + c
        x = top * q / bottom
    error = 0.5 * math.erfc(-x / math.sqrt(2.0)) - p
    step = error * math.sqrt(2.0 * math.pi) * math.exp(x * x / 2.0)
    x -= step / (1.0 + x * step / 2.0)
    return -x if mirrored else x


@compiled
def limited(x: float, y: float, longest: float) -> tuple[float, float]:
    """(x, y), shortened to the length `longest` if it is longer."""
    length = length_of(x, y)
    if length <= longest:
        return x, y
    return x / length * longest, y / length * longest


@compiled
def speed_limited(ax: float, ay: float, vx: float, vy: float, dt: float, top_speed: float) -> tuple[float, float]:
    """The acceleration (ax, ay), changed so that after `dt` the velocity (vx, vy) is no faster than `top_speed`."""
    if not dt > 0.0:
        return ax, ay
    wx, wy = limited(vx + ax * dt, vy + ay * dt, top_speed)
    return (wx - vx) / dt, (wy - vy) / dt


@compiled
def random_vector(u: float, v: float) -> tuple[float, float]:
    """A vector whose two components are independent standard normal numbers; draws 1 - u, 1 - v give its mirror image.

    The direction is 2 pi u; the length depends on how far v is from one half.
    """
    length = math.sqrt(-2.0 * math.log(max(1.0 - abs(2.0 * v - 1.0), 1e-300)))
    return length * math.cos(2.0 * math.pi * u), length * math.sin(2.0 * math.pi * u)
