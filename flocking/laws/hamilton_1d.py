"""Hamilton's one-dimensional model: jump into the narrower of the gaps beside one's own.

Source: Hamilton 1971, "Geometry for the selfish herd", section 1 (frogs on the rim of a pond) and its figure 2; Fine
2015, table A.1, Hamilton (1971) (1D). The rim's unit is one metre here, and the line is the world's x axis.

A member lies in the gap between its neighbours to the left and to the right. It stays if that gap is narrower than both
of the gaps beyond them; else it jumps into the narrower of the two, passing the neighbour by a third of that gap.

Needs positions, and the own compass to know the axis. All members count, the axis alone matters of their places.
Readings:

- Table A.1 prints half the distance to the farther end of the gap as a new position (no own position added) and
  compares distances from the member rather than gaps. The original's rule is used.
- The pond's rim closes on itself, a line ends: a gap that has only one end is infinitely wide.
- Nobody, or nobody beyond the neighbours: there is no gap to jump into, so the member stays. So does one that shares
  its place with another: its own gap has no width.
- Of two gaps equally narrow, one is drawn at random.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "compass"})
RULES = ("stay", "jump")
SETS = {"neighbours": "all"}
DRAWS = 1
AXIS = True
TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "-", False, True, False, False)
VALIDATION = Validation("S", True, "global", "-", "-", "unbounded free")
FILLED = (
    Filled(
        "neighbour selection",
        "table A.1 selects the Voronoi neighbours",
        "all members: of those on a line the law finds the next ones itself, which are these",
    ),
    Filled(
        "motion computation",
        "table A.1 compares distances from the member and returns half of one as its position",
        "gaps are compared, and the jump passes the neighbour by a third of the gap, as in the original",
        misprint=True,
    ),
    Filled("motion computation", "what a member at the end of a line does", "a gap without an end is infinitely wide"),
    Filled("motion computation", "two gaps equally narrow", "one of them is drawn"),
)
HERD = Herd(spacing_m=1.0, speed_m_s=100.0, dt_s=1.0)
CREATE: dict[str, float] = {}

STAY, JUMP = range(2)
SAME_PLACE_M = 1e-9
"""Members that jump to one place land there but for rounding."""


class Parameters(NamedTuple):
    """Of Hamilton's one-dimensional model."""

    passing: Annotated[
        float, Parameter("", "Hamilton 1971, figure 2: a third of the gap", published=True, low=0.0, high=1.0)
    ] = 1.0 / 3.0


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Way-point on the axis: into the narrower gap."""
    axis_x, axis_y = math.cos(own.compass), -math.sin(own.compass)
    left, beyond_left, right, beyond_right = -math.inf, -math.inf, math.inf, math.inf
    shares = False
    for j in range(len(sets[0])):
        if sets[0, j]:
            s = members.positions[j, 0] * axis_x + members.positions[j, 1] * axis_y
            if abs(s) <= SAME_PLACE_M:
                shares = True
            elif s > 0.0:
                if s < right:
                    right, beyond_right = s, right
                elif s < beyond_right:
                    beyond_right = s
            elif s > left:
                left, beyond_left = s, left
            elif s > beyond_left:
                beyond_left = s
    left_gap = left - beyond_left if beyond_left > -math.inf else math.inf
    right_gap = beyond_right - right if beyond_right < math.inf else math.inf
    narrower = min(left_gap, right_gap)
    if shares or narrower == math.inf or right - left < narrower:
        return Motion(Kind.STOP, math.nan, math.nan, STAY)
    to_left = u[0] < 0.5 if left_gap == right_gap else left_gap < right_gap
    if to_left:
        jump = left - parameters.passing * left_gap
        return Motion(Kind.WAY_POINT, jump * axis_x, jump * axis_y, JUMP)
    jump = right + parameters.passing * right_gap
    return Motion(Kind.WAY_POINT, jump * axis_x, jump * axis_y, JUMP)
