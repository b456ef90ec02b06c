"""Kobots that flock while they migrate: alignment, proximal control and a preferred direction.

Source: Gökçe and Şahin 2009, "To flock or not to flock: the pros and cons of flocking in long-range migration of mobile
robot swarms"; Fine 2015, table A.1. Metres and seconds; distances are between centres.

The desired heading is that of h + beta p + w2 (d_home - d), with h and p as in `turgut`, d_home the unit vector towards
the goal, which may err, and d the member's own heading. The speed falls with the turn as there.

Needs positions, headings, obstacles and the goal; a member without a goal flocks only. Nobody heard: the own heading
takes the place of h, so that a member alone turns to its goal by and by or, without one, keeps its heading.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from flocking.laws import _kobots as kobots
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import normal, rotated, towards_goal
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

SOURCE = "Gökçe and Şahin 2009"

NEEDS = frozenset({"positions", "headings", "obstacles", "goal"})
RULES = ("alone", "flock", "home", "flock home")
SETS = {"heard": "distance-based(0, range_m)", "sensed": "distance-based(0, sensed_m)"}
RELATIONS = ("touching_m below sensed_m",)
DRAWS = 1
TAXONOMY = Taxonomy("heterogeneous", "constrained", "discrete", "all", False, True, True, True)
VALIDATION = Validation("SP", False, "global", "-", "local", "bounded free")
FILLED = (
    Filled(
        "member detection",
        "table 3.2 lists velocity, which the formula does not read",
        "the row is given as printed; the law reads no velocities",
    ),
    kobots.LEVELS,
    kobots.ANGLES,
    Filled(
        "motion computation",
        "what h is for a member that hears nobody; with none, d_home - d turns it beyond its goal each time",
        "its own heading",
    ),
    Filled(
        "motion computation",
        "the noise of the homing direction, one of the publication's four factors, is not in table A.1",
        "a normal error of the direction at each update, 0 unless set",
    ),
)
HERD = Herd(spacing_m=0.3, speed_m_s=0.07, dt_s=0.1)
CREATE = kobots.FOR_CREATES


class Parameters(NamedTuple):
    """Of Kobots that migrate."""

    range_m: kobots.RangeM = 20.0
    sensed_m: kobots.SensedM = 0.32
    touching_m: kobots.TouchingM = 0.12
    desired_level: kobots.DesiredLevel = 3.0
    proximal_weight: kobots.ProximalWeight = 4.0
    homing_weight: Annotated[float, Parameter("", "our choice: w2", low=0.0)] = 0.5
    homing_noise_rad: Annotated[
        float, Parameter("rad", f"our choice: standard deviation of the homing error that {SOURCE} vary", low=0.0)
    ] = 0.0
    speed_m_s: kobots.SpeedMS = 0.07


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: alignment, proximal control and home; the speed falls with the turn."""
    heard, x, y = kobots.alignment(members.headings, sets[0])
    sensed, px, py = kobots.proximal(members.positions, sets[1], obstacles.points, parameters)
    x, y = x + parameters.proximal_weight * px, y + parameters.proximal_weight * py
    rule = 1 if heard + sensed > 0 else 0
    has_goal, ux, uy = towards_goal(own.goal)
    if has_goal:
        home_x, home_y = rotated(ux, uy, parameters.homing_noise_rad * normal(u[0]))
        x += parameters.homing_weight * (home_x - 1.0)
        y += parameters.homing_weight * home_y
        rule += 2
    bearing, speed = kobots.steered(x, y, parameters.speed_m_s)
    return Motion(Kind.HEADING, bearing, speed, rule)
