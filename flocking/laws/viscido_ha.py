"""Hamilton's rule (HA) in its original form: into the gap beside the nearest neighbour.

Source: Hamilton 1971 and Viscido, Miller and Wethey 2002; Fine 2015, algorithm 1 with section 2.1.1, and table A.1,
Viscido et al. (2002) (HA). The unit is the body-length, one metre here.

k is the nearest neighbour and l the member nearest to k. The way-point lies on the line between the two, two
body-lengths away from k, and the member takes a step of one body-length towards it. With k within the repulsion
distance, the step is perpendicular to that line, its sign drawn at random.

Needs positions. Fewer than two members, or two in one place: undefined in the publication (section 3.5.2); the step is
SNN's, as in section 2.1.2. No neighbours: the member keeps its motion.

Differences between the sources, and the readings:

- Table A.1 measures the point from l towards k, one body-length (e = d_lk + r_l - r_i); algorithm 1 and the text of
  section 2.1.1 measure it from k, two body-lengths. The text is followed; `from_second` true with `offset_m` 1 gives
  the table's point.
- Table A.1 turns the sum of position and step by a right angle, which would depend on where the origin lies. The step
  is turned here.
- The table turns the direction of the way-point, the text the line between the two members: the text is followed.
- `l` is never the focal member itself, though it may well be nearest to k: it is not among those that it detects.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.geometry import NOT_FOUND, line, nearest, nearest_to
from flocking.laws._selfish_herd import NOBODY, BodyLengthM, RepulsionM
from flocking.parameters import Parameter
from flocking.steps import step
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import unit
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions"})
RULES = ("none", "snn", "hamilton", "perpendicular")
SETS = {"detected": "all"}
DRAWS = 1
TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "-", False, True, False, False)
VALIDATION = Validation("S", True, "global", "-", "-", "bounded free")
FILLED = (
    Filled("motion computation", "what a member does that detects one other", "a step of SNN, as in section 2.1.2"),
    NOBODY,
    Filled(
        "motion computation",
        "table A.1 turns position plus step by a right angle, which depends on the origin",
        "the step is perpendicular to the line between the two members, as in section 2.1.1",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "table A.1 measures the way-point from l, algorithm 1 from k",
        "from k, as algorithm 1; the parameter from_second gives the other",
    ),
)
HERD = Herd(spacing_m=4.0, speed_m_s=1.0, dt_s=1.0, space="bounded")
CREATE = {"step_m": 0.33, "repulsion_m": 0.66, "offset_m": 0.66}

NONE, SNN, HAMILTON, PERPENDICULAR = range(4)


class Parameters(NamedTuple):
    """Of the original Hamilton's rule."""

    step_m: BodyLengthM = 1.0
    repulsion_m: RepulsionM = 2.0
    offset_m: Annotated[
        float, Parameter("m", "Fine 2015, section 2.1.1: two body-lengths from the nearest", published=True, low=0.0)
    ] = 2.0
    from_second: Annotated[
        bool, Parameter("", "our reading: measured from the nearest neighbour k; true: from l, as table A.1 prints")
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
    """Algorithm 1 of Fine 2015, as a step."""
    positions = members.positions
    k = nearest(positions, sets[0])
    if k == NOT_FOUND:
        return Motion(Kind.HOLD, math.nan, math.nan, NONE)
    near = math.hypot(positions[k, 0], positions[k, 1]) <= parameters.repulsion_m
    second = nearest_to(positions, sets[0], k, 0.0)
    if second == NOT_FOUND:
        rule = SNN
        x, y = unit(positions[k, 0], positions[k, 1])
        if near:
            x, y = 0.0, 0.0
    else:
        gap, along_x, along_y = line(positions, k, second)
        if near:
            rule = PERPENDICULAR
            side = 1.0 if u[0] < 0.5 else -1.0
            x, y = -along_y * side, along_x * side
        else:
            rule = HAMILTON
            reach = gap - parameters.offset_m if parameters.from_second else parameters.offset_m
            x, y = unit(positions[k, 0] + along_x * reach, positions[k, 1] + along_y * reach)
    return step(x, y, parameters.step_m, rule)
