"""Boids as their author programmed them later: separation, alignment and cohesion as one steering force.

Source: Reynolds 1987 in the reading of his OpenSteer library (Reynolds 2004); Fine 2015, table 3.3 and section 3.4.1.
OpenSteer has no units: metres and seconds, unit mass, body frame.

Steering = w1 ŝ + w2 â + w3 ĉ, each term a unit vector: s the sum over the separation set of the vectors away from each
member divided by their length, once more for the weight of distance; a the mean of the alignment set's heading vectors
minus the own one; c the mean position of the cohesion set. The force is cut at its maximum, the speed at its.

Reads positions and headings. No neighbours: no force, the boid keeps its velocity. Obstacles are left to the avoidance
that all laws share; OpenSteer has one of its own. OpenSteer counts members within three radii whatever their bearing;
here the angle limits them too (`FILLED`). The row lists the members' velocity, which the rules do not read.

Two things that OpenSteer's vehicle does to its force are left out (`FILLED`): at each frame it is smoothed,
smoothed += s (force - smoothed) with s = 9 dt within 0.15 to 0.4; and below a fifth of the top speed it is turned into
a cone about the nose, whose angle has the cosine 1 - 2 (speed / that fifth)^20, so that a boid at rest gathers speed
straight ahead.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import limited, mean_direction, mean_vector, speed_limited, unit
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "headings"})
RULES = ("none", "flock")
SETS = {
    "separation": "distance-based(0, separation_m) & angle(separation_angle_deg)",
    "alignment": "distance-based(0, alignment_m) & angle(alignment_angle_deg)",
    "cohesion": "distance-based(0, cohesion_m) & angle(cohesion_angle_deg)",
}
SEPARATION, ALIGNMENT, COHESION = range(3)

OPENSTEER = "OpenSteer, the boids plug-in"


class Parameters(NamedTuple):
    """Of OpenSteer's boids."""

    separation_m: Annotated[float, Parameter("m", OPENSTEER, published=True, low=0.0)] = 5.0
    separation_angle_deg: Annotated[
        float, Parameter("deg", f"{OPENSTEER}: the cosine is -0.707", published=True, low=0.0, high=180.0)
    ] = math.degrees(math.acos(-0.707))
    separation_weight: Annotated[float, Parameter("m/s²", OPENSTEER, published=True, low=0.0)] = 12.0
    alignment_m: Annotated[float, Parameter("m", OPENSTEER, published=True, low=0.0)] = 7.5
    alignment_angle_deg: Annotated[
        float, Parameter("deg", f"{OPENSTEER}: the cosine is 0.7", published=True, low=0.0, high=180.0)
    ] = math.degrees(math.acos(0.7))
    alignment_weight: Annotated[float, Parameter("m/s²", OPENSTEER, published=True, low=0.0)] = 8.0
    cohesion_m: Annotated[float, Parameter("m", OPENSTEER, published=True, low=0.0)] = 9.0
    cohesion_angle_deg: Annotated[
        float, Parameter("deg", f"{OPENSTEER}: the cosine is -0.15", published=True, low=0.0, high=180.0)
    ] = math.degrees(math.acos(-0.15))
    cohesion_weight: Annotated[float, Parameter("m/s²", OPENSTEER, published=True, low=0.0)] = 8.0
    top_force_m_s2: Annotated[float, Parameter("m/s²", OPENSTEER, published=True, low=0.0)] = 27.0
    top_speed_m_s: Annotated[float, Parameter("m/s", OPENSTEER, published=True, low=0.0)] = 9.0


TAXONOMY = Taxonomy("homogeneous", "constrained", "continuous", "all", False, True, True, True)
VALIDATION = Validation("S", True, "global", "global", "global", "unbounded obstacles")
FILLED = (
    Filled(
        "motion computation",
        "Reynolds 1987 names three urges and gives none of them as a formula",
        "those of his own later library, its weights and radii",
    ),
    Filled(
        "motion computation",
        "table 3.3 divides the vectors away from the members by a negative square: an attraction",
        "away from each member, as in OpenSteer",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "table 3.3 averages angles",
        "the mean of heading vectors, as in OpenSteer",
        misprint=True,
    ),
    Filled(
        "neighbour selection",
        "table 3.3 prints one radius for all three urges",
        "a radius and an angle for each, as in OpenSteer",
    ),
    Filled(
        "neighbour selection",
        "OpenSteer counts members within three radii whatever their bearing",
        "the angle limits them too: who is right behind is not kept away from",
    ),
    Filled(
        "physical motion",
        "table 3.3 calls the sum a velocity; OpenSteer's vehicle smooths the force and, if slow, turns it",
        "a steering force on unit mass, as in OpenSteer, which acts as it is: neither smoothed nor turned",
    ),
)
HERD = Herd(4.0, 2.7, 0.05)
CREATE = {
    "separation_m": 0.9,
    "separation_weight": 0.05,
    "alignment_m": 2.0,
    "alignment_angle_deg": 90.0,
    "alignment_weight": 0.035,
    "cohesion_m": 5.6,
    "cohesion_weight": 0.035,
    "top_force_m_s2": 0.115,
    "top_speed_m_s": 0.25,
}
"""Accelerations are scaled by the square of the speeds over the lengths, which leaves the motion as it is."""


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Acceleration by the three urges."""
    away_x, away_y, found = 0.0, 0.0, 0
    for j in range(len(members.ids)):
        x, y = members.positions[j, 0], members.positions[j, 1]
        squared = x * x + y * y
        if sets[SEPARATION, j] and squared > 0.0:
            found += 1
            away_x -= x / squared
            away_y -= y / squared
    away_x, away_y = unit(away_x, away_y)
    aligned, along_x, along_y = mean_direction(members.headings, sets[ALIGNMENT])
    if aligned > 0:
        along_x, along_y = unit(along_x - 1.0, along_y)
    gathered, centre_x, centre_y = mean_vector(members.positions, sets[COHESION])
    centre_x, centre_y = unit(centre_x, centre_y)
    if found + aligned + gathered == 0:
        return Motion(Kind.HOLD, math.nan, math.nan, 0)
    w1, w2, w3 = parameters.separation_weight, parameters.alignment_weight, parameters.cohesion_weight
    ax, ay = limited(
        w1 * away_x + w2 * along_x + w3 * centre_x,
        w1 * away_y + w2 * along_y + w3 * centre_y,
        parameters.top_force_m_s2,
    )
    ax, ay = speed_limited(ax, ay, own.velocity[0], own.velocity[1], own.dt, parameters.top_speed_m_s)
    return Motion(Kind.ACCELERATION, ax, ay, 1)
