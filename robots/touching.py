"""Which robots touch one another or a wall, from MuJoCo's list of contacts."""

from __future__ import annotations

import mujoco
import numpy as np

from flocking.compilation import compiled
from flocking.types import Floats, Ints
from robots.physics import HULL_MASK

UNOWNED = -1
"""Owner of a geom that is neither part of a hull nor a wall (floor, wheels, casters)."""


APART_S = 0.5
"""s that two must have been apart before they are said to touch anew: robots that push one another rattle. A choice."""


FORCE = 0.5
"""N with which two must press on one another to be said to touch: what presses a bumper's switch
(robots/create/bumpers.py). MuJoCo lists contacts from a few millimetres' distance on, where there is no force yet.
A choice."""


def hulls_of(model: mujoco.MjModel, roots: Ints) -> Ints:
    """(ngeom,) for each geom which of the robots with these root bodies (N,) it is a hull of, else `UNOWNED`."""
    robots = {int(root): k for k, root in enumerate(roots)}
    is_hull = model.geom_contype & HULL_MASK > 0
    owners = [robots.get(int(body), UNOWNED) for body in model.geom_bodyid]
    return np.where(is_hull, np.array(owners, dtype=np.int64), UNOWNED)


@compiled
def any_hull(pairs: Ints, owners: Ints) -> bool:
    """Whether any contact (C, 2) of two geoms is one of a hull; owners (ngeom,): `UNOWNED` for what is none."""
    found = False
    for c in range(len(pairs)):
        found |= owners[pairs[c, 0]] != UNOWNED or owners[pairs[c, 1]] != UNOWNED
    return found


@compiled
def normal_force(row: int, efc_force: Floats) -> float:
    """The normal force of a contact, N; 0 where the solver left it out.

    row: its first in the solver's forces `efc_force` (nefc,), −1 = none. With an elliptic cone, as in
    `physics.apply_options`, that one is the normal force; those of friction follow.
    """
    return efc_force[row] if row >= 0 else 0.0


@compiled
def begun(
    pairs: Ints, points: Floats, rows: Ints, efc_force: Floats, owners: Ints, last: Ints, tick: int, release: int,
    found: Floats,
) -> int:  # fmt: skip
    """Touches that began in this step: writes them to `found`, and the tick of each pair's last touch to `last`.

    pairs (C, 2), points (C, 3): geoms and places of all contacts, m; rows (C,), efc_force (nefc,): as in
    `normal_force`; owners (ngeom,): robot 0 to N − 1, N for walls, or `UNOWNED`; last (N, N + 1): column N for
    walls, the smaller robot in the row; release: ticks apart after which a touch is a new one; found (F, 4): rows
    robot, other (−1 = wall), x, y. Returns how many rows it wrote.
    """
    robots = last.shape[0]
    count = 0
    for c in range(len(pairs)):
        first, second = owners[pairs[c, 0]], owners[pairs[c, 1]]
        if min(first, second) == UNOWNED or first == second:
            continue
        if normal_force(rows[c], efc_force) < FORCE:
            continue
        low, high = min(first, second), max(first, second)
        if tick - last[low, high] > release and count < len(found):
            found[count, 0] = low
            found[count, 1] = high if high < robots else -1
            found[count, 2] = points[c, 0]
            found[count, 3] = points[c, 1]
            count += 1
        last[low, high] = tick
    return count
