"""One-dimensional asynchronous swarm: each member goes to the middle between the two beside it in the row.

Source: Gazi and Passino 2005, "Stability of a one-dimensional discrete-time asynchronous swarm"; Fine 2015, table A.1.
Members move along the world's x axis, in the order of their ids towards +x. Metres; the publication's units are free.

The first member stands still. One between two others goes to x_i - g(x_i - (x_{i-1} + x_{i+1})/2), the last one to
x_N - g(x_N - x_{N-1} - r), with r the comfortable distance; none comes closer to its neighbours than the width w,
and where both sides press, the left one counts. Here g(y) = k y with 0 < k < 1. The row comes to rest with all gaps
equal to r, although members act at different times on positions sensed earlier.

Needs positions, ids and the compass. Neighbours are the members with the next smaller and the next larger id: a member
is the first, or the last, if it detects nobody with a smaller, or larger, id. Nobody detected: it is the first and
stands still. A new position is a way-point. Reversing the x axis does not mirror the law, since the row runs to +x.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.geometry import NOT_FOUND
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

SOURCE = "Gazi and Passino 2005"

NEEDS = frozenset({"positions", "ids", "compass"})
RULES = ("first", "between", "last")
SETS = {"row": "all"}
RELATIONS = ("width_m below spacing_m", "gain above 0", "gain below 1")
AXIS = True
CHIRAL = True
TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "-", True, True, False, False)
VALIDATION = Validation("MS", False, "global", "global", "global", "unbounded free")
FILLED = (
    Filled(
        "neighbour selection",
        "table A.1 selects Voronoi neighbours, although the rule goes by the index",
        "the members with the next smaller and the next larger id, which in a row are the same",
    ),
    Filled(
        "motion computation",
        "table A.1 keeps the middle members from x_{i-1} - w on the right",
        "x_{i+1} - w, as in the original",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "the scaling function g is any that shrinks its argument",
        "a constant share of it",
    ),
    Filled(
        "motion computation",
        "the minimum distances use current positions and g those sensed earlier",
        "both use what the member has detected; how old that is, the trial decides",
    ),
    Filled(
        "motion computation",
        "table 3.2 lists no collision avoidance, although the rule keeps members the width apart",
        "the row is given as printed",
    ),
)
HERD = Herd(spacing_m=1.0, speed_m_s=0.5, dt_s=1.0)
CREATE = {"spacing_m": 0.8, "width_m": 0.4}


class Parameters(NamedTuple):
    """Of Gazi and Passino's row."""

    spacing_m: Annotated[float, Parameter("m", f"our choice: the comfortable distance r of {SOURCE}", low=0.0)] = 1.0
    width_m: Annotated[float, Parameter("m", f"our choice: the size w of a member of {SOURCE}", low=0.0)] = 0.1
    gain: Annotated[float, Parameter("", f"our choice: {SOURCE} ask for 0 < k < 1", low=0.0, high=1.0)] = 0.5


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Way-point on the world's x axis through the member."""
    before, after = NOT_FOUND, NOT_FOUND
    for j in range(len(members.ids)):
        if not sets[0, j]:
            continue
        if members.ids[j] < own.id and (before == NOT_FOUND or members.ids[j] > members.ids[before]):
            before = j
        if members.ids[j] > own.id and (after == NOT_FOUND or members.ids[j] < members.ids[after]):
            after = j
    if before == NOT_FOUND:
        return Motion(Kind.STOP, math.nan, math.nan, 0)
    c, s = math.cos(own.compass), math.sin(own.compass)
    left = c * members.positions[before, 0] - s * members.positions[before, 1]
    if after == NOT_FOUND:
        step = max(left + parameters.width_m, parameters.gain * (left + parameters.spacing_m))
        return Motion(Kind.WAY_POINT, c * step, -s * step, 2)
    right = c * members.positions[after, 0] - s * members.positions[after, 1]
    to_middle = parameters.gain * (left + right) / 2.0
    step = max(left + parameters.width_m, min(to_middle, right - parameters.width_m))
    return Motion(Kind.WAY_POINT, c * step, -s * step, 1)
