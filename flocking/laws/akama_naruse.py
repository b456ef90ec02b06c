"""Boids as springs and dampers between all members within a range.

Source: Akama and Naruse 2014, "Development of link tension index for flocking agents", equations 1 to 5. Point masses
of unit mass; metres and seconds, which the publication leaves open.

Acceleration = the sum over the neighbours j of k_p (|p_j - p_i| - d) n_ij + k_v (v_j - v_i), where n_ij points to j,
d is the springs' natural length and the neighbours are those within the range alpha d. Equation 2 counts a member
exactly at the range; the selection here does not. Springs that come into being or break carry energy in and out.

Needs positions and velocities. No neighbours: the member keeps its velocity; it has left the flock.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import unit
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

SOURCE = "Akama and Naruse 2014"

NEEDS = frozenset({"positions", "velocities"})
RULES = ("none", "flock")
SETS = {"neighbours": "distance-based(0, range_m)"}
RELATIONS = ("length_m at most range_m",)
TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "member", False, True, True, False)
VALIDATION = Validation("S", True, "global", "global", "-", "unbounded free")
NO_ROW = "a publication that the tables do not hold"
FILLED = (
    Filled(
        "physical motion",
        "equations 4 and 5 do not say whether positions change by the old or the new velocity",
        "by the new one (semi-implicit Euler); a kinematic herd's updating can be set to forward",
    ),
    Filled("sensing", "how a member comes to know positions and velocities", "they are known without error"),
    Filled(
        "motion computation",
        "the coefficients of spring and damper and the mass",
        "a unit mass, so that the coefficients are 1/s² and 1/s; both 1, the only value of k_p that equation 7 fits",
    ),
    Filled("physical motion", "the time step of the Euler method", "0.01 s, small against a spring's period"),
)
HERD = Herd(spacing_m=1.0, speed_m_s=3.0, dt_s=0.01)
CREATE = {"range_m": 1.6, "length_m": 0.8, "spring_per_s2": 0.3, "damper_per_s": 0.6}


class Parameters(NamedTuple):
    """Of Akama and Naruse's springs."""

    range_m: Annotated[
        float, Parameter("m", f"{SOURCE}: alpha d, with alpha = 1.6 of 1.3, 1.6, 1.9", published=True, low=0.0)
    ] = 1.6
    length_m: Annotated[float, Parameter("m", f"{SOURCE}: the stable distance d", published=True, low=0.0)] = 1.0
    # plausible: equation 7 fits a k_p of 1 alone, and neither unit was published; four times either way
    spring_per_s2: Annotated[
        float, Parameter("1/s²", "our choice: k_p, not published", low=0.0, plausible=(0.25, 4.0))
    ] = 1.0
    # plausible: from none to four times k_p, far beyond critical damping of a pair
    damper_per_s: Annotated[
        float, Parameter("1/s", "our choice: k_v, not published", low=0.0, plausible=(0.0, 4.0))
    ] = 1.0
    mass: Annotated[float, Parameter("", "our choice: equation 4 has none; divides both coefficients", low=1e-6)] = 1.0


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Acceleration by springs and dampers."""
    found, ax, ay = 0, 0.0, 0.0
    for j in range(len(members.ids)):
        if not sets[0, j]:
            continue
        found += 1
        x, y = members.positions[j, 0], members.positions[j, 1]
        ux, uy = unit(x, y)
        pull = parameters.spring_per_s2 * (math.hypot(x, y) - parameters.length_m)
        ax += pull * ux + parameters.damper_per_s * (members.velocities[j, 0] - own.velocity[0])
        ay += pull * uy + parameters.damper_per_s * (members.velocities[j, 1] - own.velocity[1])
    if found == 0:
        return Motion(Kind.HOLD, math.nan, math.nan, 0)
    return Motion(Kind.ACCELERATION, ax / parameters.mass, ay / parameters.mass, 1)
