"""Social force model of pedestrians: what a walker wants, and what others and walls keep it from, add up.

Source: Helbing, Buzna, Johansson and Werner 2005, circular specification, on the model of Helbing and Molnar 1995; Fine
2015, section 3.4.1, which does not formalise it. Metres and seconds, forces per mass, body frame.

Acceleration = (desired speed · e − v) / relaxation time
+ Σ members (A1 exp((diameter − d) / B1) w(φ) + A2 exp((diameter − d) / B2)) away from each
+ Σ walls A_w exp((radius − d) / B_w) away from each + Σ members C towards each + fluctuation, with
w(φ) = λ + (1 − λ)(1 + cos φ) / 2, φ the angle between the own motion and the direction to the other one.

The first repulsion is anisotropic: what is behind counts λ times what is ahead. The second is the same all around. The
publication's crowds have the second alone, A1 = 0, so that λ does not count.

Reads the members' positions, the goal and the obstacles. With no neighbours the walker goes its way: the driving term,
the walls and the fluctuation remain. Walkers that differ (the row's heterogeneous group) have other parameters.
Deviation: the row lists the others' velocity, which the circular form of the repulsion does not read.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import random_vector, speed_limited, towards_goal, unit_or_ahead
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "goal", "obstacles"})
RULES = ("alone", "social")
SETS = {"neighbours": "distance-based(0, range_m)"}
DRAWS = 2

HELBING_1995 = "Helbing and Molnar 1995, the model's parameters"
HELBING_2005 = "Helbing et al. 2005"


class Parameters(NamedTuple):
    """Of the social forces."""

    desired_speed_m_s: Annotated[float, Parameter("m/s", f"{HELBING_1995}: the mean", published=True, low=0.0)] = 1.34
    relaxation_s: Annotated[float, Parameter("s", f"{HELBING_2005}: tau", published=True, low=1e-3)] = 1.0
    top_speed_factor: Annotated[
        float, Parameter("", f"{HELBING_1995}: top speed by desired speed", published=True, low=1.0)
    ] = 1.3
    diameter_m: Annotated[float, Parameter("m", "our choice: a pedestrian's, shoulder to shoulder", low=0.0)] = 0.6
    repulsion_m_s2: Annotated[
        float, Parameter("m/s²", f"{HELBING_2005}: A2, of the isotropic repulsion", published=True, low=0.0)
    ] = 3.0
    repulsion_range_m: Annotated[float, Parameter("m", f"{HELBING_2005}: B2, its range", published=True, low=0.01)] = (
        0.2
    )
    anisotropic_m_s2: Annotated[
        float, Parameter("m/s²", f"{HELBING_2005}: A1, of the anisotropic repulsion", published=True, low=0.0)
    ] = 0.0
    anisotropic_range_m: Annotated[
        float, Parameter("m", "our choice: B1, its range; of no effect where its strength is 0", low=0.01)
    ] = 0.2
    anisotropy: Annotated[
        float,
        Parameter(
            "",
            f"{HELBING_2005}: λ, weight of what is behind in the anisotropic repulsion; 1 = all alike",
            published=True,
            low=0.0,
            high=1.0,
        ),
    ] = 0.75
    wall_m_s2: Annotated[
        float, Parameter("m/s²", f"{HELBING_2005}: A of the walls' repulsion", published=True, low=0.0)
    ] = 5.0
    wall_range_m: Annotated[
        float, Parameter("m", f"{HELBING_2005}: B of the walls' repulsion", published=True, low=0.01)
    ] = 0.1
    attraction_m_s2: Annotated[
        float, Parameter("m/s²", "our choice: C, the pull of each neighbour, whatever its distance", low=0.0)
    ] = 0.1
    fluctuation: Annotated[
        float,
        Parameter("m/s^1.5", "our choice: the fluctuation alone spreads each velocity by this in a second", low=0),
    ] = 0.1
    range_m: Annotated[float, Parameter("m", "our choice: members farther away are not felt", low=0.0)] = 10.0


TAXONOMY = Taxonomy("heterogeneous", "idealized", "continuous", "all", False, True, True, False)
VALIDATION = Validation("SP", False, "global", "global", "-", "bounded obstacles")
REMARK = "table 3.4 has the row of Helbing et al. 2000; the physical agents were people"
FILLED = (
    Filled(
        "motion computation",
        "the attraction is defined by its name only",
        "a constant pull towards each neighbour, the form of the authors' model of escape (2000); 0 takes it away",
    ),
    Filled(
        "motion computation",
        "the fluctuation is a random term of unstated properties",
        "white noise, normal and alike in all directions, drawn anew at each computation and held for its time step",
    ),
    Filled(
        "motion computation",
        "where a walker without a destination wants to go",
        "where it goes; straight ahead where it stands",
    ),
    Filled("neighbour selection", "no range is given", "members nearer than a range; the forces fade long before it"),
    Filled("sensing", "how a wall acts", "by its nearest point, one force a surface"),
)
HERD = Herd(2.0, 1.34, 0.05)
CREATE = {
    "desired_speed_m_s": 0.25,
    "diameter_m": 0.33,
    "repulsion_m_s2": 0.5,
    "wall_m_s2": 0.8,
    "wall_range_m": 0.15,
    "attraction_m_s2": 0.03,
    "fluctuation": 0.02,
    "range_m": 5.6,
}


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Acceleration by the sum of all forces."""
    vx, vy = own.velocity[0], own.velocity[1]
    going_x, going_y = unit_or_ahead(vx, vy)
    has_goal, wanted_x, wanted_y = towards_goal(own.goal)
    if not has_goal:
        wanted_x, wanted_y = going_x, going_y
    ax = (parameters.desired_speed_m_s * wanted_x - vx) / parameters.relaxation_s
    ay = (parameters.desired_speed_m_s * wanted_y - vy) / parameters.relaxation_s
    felt = 0
    for j in range(len(members.ids)):
        distance = math.hypot(members.positions[j, 0], members.positions[j, 1])
        if sets[0, j] and distance > 0.0:
            felt = 1
            nx, ny = members.positions[j, 0] / distance, members.positions[j, 1] / distance
            depth = parameters.diameter_m - distance
            push = parameters.repulsion_m_s2 * math.exp(depth / parameters.repulsion_range_m)
            if parameters.anisotropic_m_s2 > 0.0:
                facing = 0.5 * (1.0 + going_x * nx + going_y * ny)
                weight = parameters.anisotropy + (1.0 - parameters.anisotropy) * facing
                push += weight * parameters.anisotropic_m_s2 * math.exp(depth / parameters.anisotropic_range_m)
            ax += (parameters.attraction_m_s2 - push) * nx
            ay += (parameters.attraction_m_s2 - push) * ny
    for k in range(len(obstacles.points)):
        distance = math.hypot(obstacles.points[k, 0], obstacles.points[k, 1])
        if distance > 0.0:
            push = parameters.wall_m_s2
            push *= math.exp((0.5 * parameters.diameter_m - distance) / parameters.wall_range_m)
            ax -= push * obstacles.points[k, 0] / distance
            ay -= push * obstacles.points[k, 1] / distance
    if own.dt > 0.0:
        jolt_x, jolt_y = random_vector(u[0], u[1])
        ax += parameters.fluctuation / math.sqrt(own.dt) * jolt_x
        ay += parameters.fluctuation / math.sqrt(own.dt) * jolt_y
    top_speed = parameters.top_speed_factor * parameters.desired_speed_m_s
    ax, ay = speed_limited(ax, ay, vx, vy, own.dt, top_speed)
    return Motion(Kind.ACCELERATION, ax, ay, felt)
