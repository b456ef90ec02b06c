"""Which robots touch one another or a wall, from MuJoCo's list of contacts."""

from __future__ import annotations

from flocking.compilation import compiled
from flocking.types import Floats, Ints

UNOWNED = -1
"""Owner of a geom that is neither part of a hull nor a wall (floor, wheels, casters)."""


APART_S = 0.5
"""s that two must have been apart before they are said to touch anew: robots that push one another rattle. A choice."""


@compiled
def begun(pairs: Ints, points: Floats, owners: Ints, apart: Ints, release: int, found: Floats) -> int:
    """Contacts that began in this step: writes them to `found`, and how long each pair has been apart to `apart`.

    pairs (C, 2): geoms of each contact; points (C, 3); owners (ngeom,): robot 0 to N − 1, N for walls, or `UNOWNED`;
    apart (N, N + 1): steps since each pair touched last, column N for walls, the smaller robot in the row; release:
    steps apart after which a touch is a new one; found (F, 4): rows robot, other (−1 = wall), x, y. Returns how many
    rows it wrote.
    """
    robots = apart.shape[0]
    apart += 1
    count = 0
    for c in range(len(pairs)):
        first, second = owners[pairs[c, 0]], owners[pairs[c, 1]]
        if min(first, second) == UNOWNED or first == second:
            continue
        low, high = min(first, second), max(first, second)
        if apart[low, high] > release and count < len(found):
            found[count, 0] = low
            found[count, 1] = high if high < robots else -1
            found[count, 2] = points[c, 0]
            found[count, 3] = points[c, 1]
            count += 1
        apart[low, high] = 0
    return count
