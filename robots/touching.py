"""Which robots touch one another or a wall, from MuJoCo's list of contacts."""

from __future__ import annotations

from flocking.compilation import compiled
from flocking.types import Floats, Ints

UNOWNED = -1
"""Owner of a geom that is neither part of a hull nor a wall (floor, wheels, casters)."""


APART_S = 0.5
"""s that two must have been apart before they are said to touch anew: robots that push one another rattle. A choice."""


FORCE = 0.5
"""N with which two must press on one another to be said to touch: what presses a bumper's switch
(robots/create/bumpers.py). MuJoCo lists contacts from a few millimetres' distance on, where there is no force yet.
A choice."""


@compiled
def any_hull(pairs: Ints, owners: Ints) -> bool:
    """Whether any contact (C, 2) of two geoms is one of a hull; owners (ngeom,): `UNOWNED` for what is none."""
    found = False
    for c in range(len(pairs)):
        found |= owners[pairs[c, 0]] != UNOWNED or owners[pairs[c, 1]] != UNOWNED
    return found


@compiled
def normal_forces(rows: Ints, dimensions: Ints, forces: Floats, found: Floats) -> None:
    """Fills the first C of `found` with the normal force of each contact, N; 0 for those that the solver left out.

    rows (C,): a contact's first row in the solver's forces, −1 = none; dimensions (C,): 1, or more with friction (a
    pyramid of 2 (dimension − 1) edges, whose sum is the normal force); forces (nefc,), N.
    """
    for c in range(len(rows)):
        found[c] = 0.0
        if rows[c] < 0:
            continue
        for row in range(rows[c], rows[c] + (1 if dimensions[c] == 1 else 2 * (dimensions[c] - 1))):
            found[c] += forces[row]


@compiled
def begun(
    pairs: Ints, points: Floats, forces: Floats, owners: Ints, last: Ints, tick: int, release: int, found: Floats
) -> int:
    """Touches that began in this step: writes them to `found`, and the tick of each pair's last touch to `last`.

    pairs (C, 2), points (C, 3), forces (C,): geoms, places and normal forces of all contacts, m and N; owners
    (ngeom,): robot 0 to N − 1, N for walls, or `UNOWNED`; last (N, N + 1): column N for walls, the smaller robot in
    the row; release: ticks apart after which a touch is a new one; found (F, 4): rows robot, other (−1 = wall), x, y.
    Returns how many rows it wrote.
    """
    robots = last.shape[0]
    count = 0
    for c in range(len(pairs)):
        first, second = owners[pairs[c, 0]], owners[pairs[c, 1]]
        if min(first, second) == UNOWNED or first == second or forces[c] < FORCE:
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
