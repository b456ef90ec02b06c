"""Hamilton's rule as extended by Fine and Shell (extended HA).

Source: Fine 2015, algorithm 2 with the text of sections 2.1.1, 2.1.2 and 2.2. Metres, body frame.

Nothing detected: the last command is kept. One input, or none farther from the nearest one (a1) than the exclusion
distance: SNN. Otherwise a2 is the input nearest to a1 among those farther from it than the exclusion distance, and
the way-point lies on the line between the two, the repulsion distance away from a1; with a1 within the repulsion
distance, the way-point is perpendicular to that line, its sign drawn at random.

Readings of what the document leaves open:

- Line 6 of the printed algorithm selects a2 without regard to the exclusion distance, and may select a1 itself; the
  distance would then be idle. Section 2.2 says that it selects the two, and so it does here.
- "On the line between the two": where the gap is narrower than the repulsion distance, the way-point is a2 and not
  a point beyond it. Section 2.2 gives the reason: the exclusion distance finds two members "far enough apart for a
  feasible point to exist on the line between" them, and two adjacent readings give the SNN way-point. With
  `beyond_gap` true it may lie beyond a2.
- SNN within the repulsion distance: stand still (section 2.1.1).
- The perpendicular way-point is one repulsion distance away from the focal member; its sign is drawn anew at each
  computation.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.geometry import NOT_FOUND, line, nearest, nearest_to
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions"})
RULES = ("none", "snn", "hamilton", "perpendicular")
SETS = {"neighbours": "all"}
DRAWS = 1
TAXONOMY = Taxonomy("homogeneous", "constrained", "discrete", "-", False, True, False, False)
VALIDATION = Validation("P", False, "local", "-", "-", "bounded free")
FILLED = (
    Filled(
        "motion computation",
        "line 6 of algorithm 2 seeks the second member without the exclusion distance, and may find the first again",
        "the nearest to the first among those beyond the exclusion distance, as in section 2.2",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "a gap narrower than the repulsion distance",
        "the way-point is the second member; the parameter beyond_gap puts it beyond",
    ),
    Filled("motion computation", "SNN within the repulsion distance", "the member stands still, as in section 2.1.1"),
    Filled("motion computation", "how far the perpendicular way-point is", "one repulsion distance"),
)
HERD = Herd(spacing_m=1.3, speed_m_s=0.25, dt_s=0.1)
CREATE: dict[str, float] = {}

NONE, SNN, HAMILTON, PERPENDICULAR = range(4)


class Parameters(NamedTuple):
    """Of the extended rule."""

    # plausible: two body-lengths of a machine of 0.30 to 0.40 m, with what stands on it
    repulsion_m: Annotated[
        float,
        Parameter(
            "m",
            "Fine 2015, section 2.1.1: two body-lengths; body-length = the Create's diameter",
            low=0.0,
            plausible=(0.6, 0.8),
        ),
    ] = 0.66
    exclusion_m: Annotated[
        float, Parameter("m", "Fine 2015, section 2.3.1 (0, 0.5 and 1 m)", published=True, low=0.0)
    ] = 0.5
    beyond_gap: Annotated[
        bool,
        Parameter(
            "", "our reading of section 2.2: the way-point never lies beyond the second member", plausible=(False, True)
        ),
    ] = False


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Algorithm 2 of Fine 2015."""
    positions = members.positions
    a1 = nearest(positions, sets[0])
    if a1 == NOT_FOUND:
        return Motion(Kind.HOLD, math.nan, math.nan, NONE)
    x, y = positions[a1, 0], positions[a1, 1]
    near = math.hypot(x, y) <= parameters.repulsion_m
    a2 = nearest_to(positions, sets[0], a1, parameters.exclusion_m)
    if a2 == NOT_FOUND:
        if near:
            return Motion(Kind.STOP, math.nan, math.nan, SNN)
        return Motion(Kind.WAY_POINT, x, y, SNN)
    gap, along_x, along_y = line(positions, a1, a2)
    if near:
        side = parameters.repulsion_m if u[0] < 0.5 else -parameters.repulsion_m
        return Motion(Kind.WAY_POINT, -along_y * side, along_x * side, PERPENDICULAR)
    reach = parameters.repulsion_m
    if not parameters.beyond_gap:
        reach = min(reach, gap)
    return Motion(Kind.WAY_POINT, x + along_x * reach, y + along_y * reach, HAMILTON)
