"""The perception functions, compiled: each takes a mask of members and leaves only those that it selects.

Source: Fine 2015, table 3.1; field of view and occlusion as in sections 3.5.2 and 4.2; the densest component as in
LCH variations 1 and 3 (section 4.1). A function sees only the members that the mask holds. Ties are broken so that the
order of the members does not matter. `flocking.selection` has the same as plain functions on `Members`; the kinematic
herd calls these.
"""

from __future__ import annotations

import math
from enum import IntEnum

from flocking.compilation import allocating, borrowing, compiled, inlined
from flocking.density import keep_densest
from flocking.geometry import before
from flocking.types import Bools, Floats, Ints

ARGUMENTS = 8
"""Numbers that a step of a selection has room for."""


class Step(IntEnum):
    """The perception functions, as the compiled code tells them apart."""

    ALL = 0
    FIXED_SET = 1
    GRAPH = 2
    DISTANCE_BASED = 3
    NEAREST = 4
    K_NEAREST = 5
    VORONOI = 6
    BOUNDING_BOX = 7
    ANGLE = 8
    SECTOR = 9
    FIELD_OF_VIEW = 10
    UNOCCLUDED = 11
    DENSEST_DISTANCE = 12
    DENSEST_ANGLE = 13


@compiled
def keep_ids(ids: Ints, wanted: Floats, mask: Bools) -> None:
    """FixedSet(): members whose id is one of `wanted` (nan = no id)."""
    for j in range(len(mask)):
        if mask[j]:
            found = False
            for k in range(len(wanted)):
                if ids[j] >= 0 and wanted[k] == ids[j]:
                    found = True
            mask[j] = found


@inlined
def keep_within(positions: Floats, low_m: float, high_m: float, mask: Bools) -> None:
    """DistanceBased(): members at a distance in [low, high)."""
    for j in range(len(mask)):
        d = math.sqrt(positions[j, 0] * positions[j, 0] + positions[j, 1] * positions[j, 1])
        mask[j] &= (low_m <= d) & (d < high_m)


@compiled
def keep_between(positions: Floats, least: float, below: float, mask: Bools) -> None:
    """DistanceBased() by squared distances in [least, below), as `squared_bound` makes them: no root is taken.

    `positions` (2 · M,) flat: x, y, x, y and so on.
    """
    for j in range(len(mask)):
        squared = positions[2 * j] * positions[2 * j] + positions[2 * j + 1] * positions[2 * j + 1]
        mask[j] &= (least <= squared) & (squared < below)


def squared_bound(bound_m: float) -> float:
    """The least number whose rounded root is at least `bound_m`: squares below it are of distances below the bound."""
    squared = bound_m * bound_m
    while math.sqrt(squared) < bound_m:
        squared = math.nextafter(squared, math.inf)
    while squared > 0.0 and math.sqrt(math.nextafter(squared, 0.0)) >= bound_m:
        squared = math.nextafter(squared, 0.0)
    return squared


@allocating
def keep_nearest(positions: Floats, k: int, mask: Bools) -> None:
    """k-Nearest(): the k nearest members; of equally near ones the one with the smaller position first."""
    chosen = mask.copy()
    for j in range(len(mask)):
        mask[j] = False
    for _ in range(k):
        best = -1
        for j in range(len(mask)):
            known = chosen[j] and not mask[j] and not math.isnan(positions[j, 0])
            if known and (best == -1 or before(positions, j, best)):
                best = j
        if best == -1:
            return
        mask[best] = True


@compiled
def keep_in_box(positions: Floats, x0: float, y0: float, x1: float, y1: float, mask: Bools) -> None:
    """BoundingBox(): members in the rectangle, its border included; body axes."""
    for j in range(len(mask)):
        if mask[j]:
            mask[j] = x0 <= positions[j, 0] <= x1 and y0 <= positions[j, 1] <= y1


@compiled
def keep_angle(bearings: Floats, angle_rad: float, mask: Bools) -> None:
    """Angle(): members whose bearing is less than the angle to either side."""
    for j in range(len(mask)):
        mask[j] &= abs(bearings[j]) < angle_rad


@inlined
def keep_cone(positions: Floats, cosine: float, mask: Bools) -> None:
    """Angle() by positions, without a bearing: `cosine` of the angle. Whoever is in one's own place is dead ahead."""
    for j in range(len(mask)):
        x, y = positions[j, 0], positions[j, 1]
        squared = x * x + y * y
        ahead = (squared == 0.0) & (cosine < 1.0)
        mask[j] &= (x > cosine * math.sqrt(squared)) | ahead


@compiled
def keep_view(bearings: Floats, width_rad: float, mask: Bools) -> None:
    """Members within a field of view of that width about the nose, its border included."""
    for j in range(len(mask)):
        mask[j] &= abs(bearings[j]) <= width_rad / 2.0


@compiled
def keep_sector(bearings: Floats, from_rad: float, to_rad: float, mask: Bools) -> None:
    """Members with a bearing from `from_rad` counter-clockwise to `to_rad`, the first border included.

    A whole turn or more counter-clockwise holds everybody whose bearing is known.
    """
    if to_rad - from_rad >= 2.0 * math.pi:
        from_rad, to_rad = 0.0, math.inf
    width = (to_rad - from_rad) % (2.0 * math.pi) if to_rad < math.inf else to_rad
    for j in range(len(mask)):
        if mask[j]:
            mask[j] = (bearings[j] - from_rad) % (2.0 * math.pi) < width


@allocating
def keep_unoccluded(positions: Floats, radius_m: float, mask: Bools) -> None:
    """Members whose centre is in sight: no nearer member's disc of that radius covers the line to it."""
    chosen = mask.copy()
    for j in range(len(mask)):
        if not chosen[j]:
            continue
        x, y = positions[j, 0], positions[j, 1]
        d = math.hypot(x, y)
        if d == 0.0:
            continue
        for k in range(len(mask)):
            if k == j or not chosen[k]:
                continue
            xk, yk = positions[k, 0], positions[k, 1]
            across = (xk * y - yk * x) / d
            if xk * xk + yk * yk < x * x + y * y and xk * x + yk * y > 0.0 and abs(across) < radius_m:
                mask[j] = False


@borrowing
def keep(
    step: int,
    given: Floats,
    positions: Floats,
    bearings: Floats,
    ids: Ints,
    linked: Bools,
    tessellated: Bools,
    mask: Bools,
) -> None:
    """One step of a selection, `given` (ARGUMENTS,) its numbers. Angles in degrees here, as the text has them.

    `linked` (M,): the graph joins the member to the focal one; `tessellated` (M,): their Voronoi cells touch.
    """
    if step == Step.FIXED_SET:
        keep_ids(ids, given, mask)
    elif step == Step.GRAPH or step == Step.VORONOI:
        for j in range(len(mask)):
            mask[j] = mask[j] and (linked[j] if step == Step.GRAPH else tessellated[j])
    elif step == Step.DISTANCE_BASED:
        keep_within(positions, given[0], given[1], mask)
    elif step == Step.NEAREST:
        keep_nearest(positions, 1, mask)
    elif step == Step.K_NEAREST:
        keep_nearest(positions, int(min(given[0], len(mask))), mask)
    elif step == Step.BOUNDING_BOX:
        keep_in_box(positions, given[0], given[1], given[2], given[3], mask)
    elif step == Step.ANGLE:
        keep_angle(bearings, math.radians(given[0]), mask)
    elif step == Step.SECTOR:
        keep_sector(bearings, math.radians(given[0]), math.radians(given[1]), mask)
    elif step == Step.FIELD_OF_VIEW:
        keep_view(bearings, math.radians(given[0]), mask)
    elif step == Step.UNOCCLUDED:
        keep_unoccluded(positions, given[0], mask)
    elif step == Step.DENSEST_DISTANCE:
        keep_densest(positions, bearings, given[0], False, mask)
    elif step == Step.DENSEST_ANGLE:
        keep_densest(positions, bearings, math.radians(given[0]), True, mask)
