"""Which robots touch one another or a wall, from MuJoCo's list of contacts."""

from __future__ import annotations

from flocking.compilation import compiled
from flocking.types import Bools, Floats, Ints

UNOWNED = -1
"""Owner of a geom that is neither part of a hull nor a wall (floor, wheels, casters)."""


@compiled
def begun(pairs: Ints, points: Floats, owners: Ints, touching: Bools, found: Floats) -> int:
    """Contacts that began in this step: writes them to `found`, and the present state to `touching`.

    pairs (C, 2): geoms of each contact; points (C, 3); owners (ngeom,): robot 0 to N − 1, N for walls, or `UNOWNED`;
    touching (N, N + 1): state after the last step, column N for walls, the smaller robot in the row; found (F, 4):
    rows robot, other (−1 = wall), x, y. Returns how many rows it wrote.
    """
    robots = touching.shape[0]
    now = touching.copy()
    now[:] = False
    count = 0
    for c in range(len(pairs)):
        first, second = owners[pairs[c, 0]], owners[pairs[c, 1]]
        if first == UNOWNED or second == UNOWNED or first == second:
            continue
        low, high = min(first, second), max(first, second)
        if now[low, high]:
            continue
        now[low, high] = True
        if not touching[low, high] and count < len(found):
            found[count, 0] = low
            found[count, 1] = high if high < robots else -1
            found[count, 2] = points[c, 0]
            found[count, 3] = points[c, 1]
            count += 1
    touching[:] = now
    return count
