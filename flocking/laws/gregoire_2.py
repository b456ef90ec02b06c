"""Gregoire's second model: alignment, cohesion and noise as three vectors, of which the sum is the heading.

Source: Gregoire, Chate and Tu 2003 (Physica D 181); Fine 2015, table A.1, "Model 2". Heading(t + dt) = direction of
(alignment * sum of v_j + cohesion * sum of f_j + number * noise * e), with e a unit vector drawn evenly from all
directions: the more the neighbours agree, the less it counts beside the sum of the v_j. Neighbours, speed, v_j, f_j
and hard core are those of `gregoire_1`. Metres, seconds; one step is one second.

The sum of the v_j, and the number, take in the member itself. Needs positions and headings. No neighbours: the
member's own velocity and noise. In a kinematic herd members move by the old velocity, as in `gregoire_1`.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.cohesion import FOR_CREATES, ORDER
from flocking.laws import _gregoire as gregoire
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "headings"})
RULES = ("flock", "hard core")
SETS = {"neighbours": "voronoi & distance-based(0, range_m)"}
RELATIONS = ORDER
DRAWS = 1

TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "member", False, True, False, True)
VALIDATION = Validation("S", True, "global", "constant", "global", "periodic free")
FILLED = (
    *gregoire.FILLED,
    Filled(
        "motion computation",
        "whether noise acts beside an infinite force",
        "it does not: it is finite",
    ),
)
HERD = Herd(spacing_m=0.5, speed_m_s=0.05, dt_s=1.0, space="periodic", updating="forward")
CREATE = {**FOR_CREATES, "noise": 0.5}


class Parameters(NamedTuple):
    """Of Gregoire's second model."""

    range_m: gregoire.RangeM = 1.0
    core_m: gregoire.CoreM = 0.2
    equilibrium_m: gregoire.EquilibriumM = 0.5
    attraction_m: gregoire.AttractionM = 0.8
    speed_m_s: gregoire.SpeedMS = 0.05
    alignment_s_m: gregoire.AlignmentSM = 35.0
    cohesion: gregoire.Cohesion = 5.0
    noise: Annotated[float, Parameter("", gregoire.SAME_MODEL, low=0.0)] = 1.0


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: of the weighted sum, noise in it."""
    rule, found, x, y = gregoire.without_noise(members, sets[0], parameters)
    if rule == gregoire.FLOCK:
        noise = parameters.noise * (found + 1)
        angle = 2.0 * math.pi * u[0]
        x += noise * math.cos(angle)
        y += noise * math.sin(angle)
    return Motion(Kind.HEADING, math.atan2(y, x), parameters.speed_m_s, rule)
