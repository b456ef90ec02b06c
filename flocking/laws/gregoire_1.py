"""Gregoire's first model: alignment and cohesion, and noise on the angle.

Source: Gregoire, Chate and Tu 2003 (Physica D 181); Fine 2015, table A.1, "Model 1". Heading(t + dt) = direction of
(alignment * sum of v_j + cohesion * sum of f_j) + noise * xi, with xi drawn evenly from [-pi, pi]; the speed is
constant, so that v_j is the speed along the heading of j. The pair force f_j is that of `flocking.cohesion`: hard
core, spring about the equilibrium distance, constant attraction. Metres, seconds; one step is one second.

Neighbours are those within the radius whose Voronoi cells touch the member's own, as in the publication. With all
within the radius, as table A.1 has it, the many that attract from beyond the nearest ones press a herd into its hard
cores, where nobody aligns.

Neighbours within the hard core outweigh everything: the member turns straight away from them. The sum of the v_j takes
in the member itself.

Needs positions and headings. No neighbours: straight on, with noise alone. Sums that cancel out exactly: the member's
own heading is kept. In a kinematic herd members move by the old velocity (`forward`), as in the publication.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.angles import wrap
from flocking.cohesion import FOR_CREATES, ORDER
from flocking.laws import _gregoire as gregoire
from flocking.parameters import Parameter
from flocking.taxonomy import Herd, Taxonomy, Validation
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "headings"})
RULES = ("flock", "hard core")
SETS = {"neighbours": "voronoi & distance-based(0, range_m)"}
RELATIONS = ORDER
DRAWS = 1

TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "member", False, True, False, True)
VALIDATION = Validation("S", True, "global", "constant", "global", "periodic free")
FILLED = gregoire.FILLED
HERD = Herd(spacing_m=0.5, speed_m_s=0.05, dt_s=1.0, space="periodic", updating="forward")
CREATE = {**FOR_CREATES, "noise": 0.1}


class Parameters(NamedTuple):
    """Of Gregoire's first model."""

    range_m: gregoire.RangeM = 1.0
    core_m: gregoire.CoreM = 0.2
    equilibrium_m: gregoire.EquilibriumM = 0.5
    attraction_m: gregoire.AttractionM = 0.8
    speed_m_s: gregoire.SpeedMS = 0.05
    alignment_s_m: gregoire.AlignmentSM = 35.0
    cohesion: gregoire.Cohesion = 5.0
    noise: Annotated[float, Parameter("", "our choice: a share of half a turn", low=0.0, high=1.0)] = 0.1


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: of the weighted sum, turned by uniform noise."""
    rule, _, x, y = gregoire.without_noise(members, sets[0], parameters)
    noise = parameters.noise * 2.0 * math.pi * (u[0] - 0.5)
    return Motion(Kind.HEADING, wrap(math.atan2(y, x) + noise), parameters.speed_m_s, rule)
