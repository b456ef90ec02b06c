"""Steps of a fixed length along the direction that a law decides on: those of Viscido, Hamilton and the LCH variations.

A step has its length however near or far what it leads to is. Where there is no direction the member stands still.
"""

from __future__ import annotations

import math

from flocking.compilation import compiled
from flocking.terms import NEGLIGIBLE, unit
from flocking.types import Kind, Motion


@compiled
def step(x: float, y: float, step_m: float, rule: int) -> Motion:
    """Way-point one step of `step_m` (m) along the unit vector (x, y); stand still for (0, 0), no direction."""
    if x == 0.0 and y == 0.0:
        return Motion(Kind.STOP, math.nan, math.nan, rule)
    return Motion(Kind.WAY_POINT, x * step_m, y * step_m, rule)


@compiled
def step_along(x: float, y: float, step_m: float, rule: int) -> Motion:
    """The same along a sum or mean (x, y) of any length; stand still where it is zero but for rounding."""
    if math.hypot(x, y) <= NEGLIGIBLE:
        return Motion(Kind.STOP, math.nan, math.nan, rule)
    ux, uy = unit(x, y)
    return step(ux, uy, step_m, rule)
