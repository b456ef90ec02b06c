"""Self-organised flocking of Kobots: heading alignment and proximal control over eight sensors.

Source: Turgut, Çelikkanat, Gökçe and Şahin 2008, "Self-organized flocking in mobile robot swarms"; Fine 2015, table
A.1. Metres and seconds; distances are between centres.

The desired heading is that of h + beta p. h is the unit vector along the sum of the neighbours' noisy headings, within
radio range. p = 1/8 sum over the sensors k of f_k, along the sensor's direction k pi/4. A sensor reads the nearest
thing in its eighth of the circle as a level o from 0 (nothing) to 7 (touching), and f = -(o - o_des)²/C above the
desired level and +(o - o_des)²/C below, with o_des = 3 for robots and 0 for obstacles; C makes f -1 at level 7. The
speed is u_max times the cosine of the turn to the desired heading, and 0 for more than a right angle.

Needs positions, headings and obstacles. Nobody heard: the own heading takes the place of h, so that a member alone
moves straight on at full speed.
Each heading that is heard has a noise of its own, which so averages out over the neighbours: the vector of length
`noise` at a normal angle to it is added to it. The nearest neighbour has the first of the draws that follow from the
law's two (`flocking.draws`), and so on.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.compilation import compiled
from flocking.draws import drawn, seeded
from flocking.geometry import NOT_FOUND, before
from flocking.laws import _kobots as kobots
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.terms import NEGLIGIBLE, normal, unit
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "headings", "obstacles"})
RULES = ("alone", "align", "proximal", "align and proximal")
SETS = {"heard": "distance-based(0, range_m)", "sensed": "distance-based(0, sensed_m)"}
RELATIONS = ("touching_m below sensed_m",)
DRAWS = 2
TAXONOMY = Taxonomy("homogeneous", "constrained", "discrete", "all", False, True, True, False)
VALIDATION = Validation("SP", False, "global", "-", "local", "bounded free")
FILLED = (
    Filled(
        "member detection",
        "table 3.2 lists velocity and no orientation, although the formula reads headings",
        "the row is given as printed; the law reads headings and no velocities",
    ),
    kobots.LEVELS,
    kobots.ANGLES,
    Filled(
        "motion computation",
        "the noise's mean in table A.1 is a sum of headings",
        "to each heading heard a vector of length noise at a normal angle to it is added, as in the original",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "what h is for a member that hears nobody",
        "its own heading, without noise",
    ),
    Filled(
        "physical motion",
        "the robot turns at a rate in proportion to the turn that is left",
        "the desired heading is handed on; how fast a body turns is its own affair",
    ),
)
HERD = Herd(spacing_m=0.3, speed_m_s=0.07, dt_s=0.1)
CREATE = kobots.FOR_CREATES


class Parameters(NamedTuple):
    """Of Kobots that align and keep their distance."""

    range_m: kobots.RangeM = 20.0
    sensed_m: kobots.SensedM = 0.32
    touching_m: kobots.TouchingM = 0.12
    desired_level: kobots.DesiredLevel = 3.0
    proximal_weight: kobots.ProximalWeight = 4.0
    noise: Annotated[float, Parameter("", "our choice: length of the noise vector", low=0.0)] = 0.0
    noise_rad: Annotated[
        float, Parameter("rad", "our choice: standard deviation of the noise vector's angle", low=0.0)
    ] = math.pi / 2.0
    speed_m_s: kobots.SpeedMS = 0.07


@compiled
def following(positions: Floats, heard: Bools, last: int) -> int:
    """Row of the member heard that comes next after row `last` by distance; the nearest for `NOT_FOUND`.

    `NOT_FOUND` if there is none; of members in one place only one is found.
    """
    best = NOT_FOUND
    for j in range(len(heard)):
        later = heard[j] and (last == NOT_FOUND or before(positions, last, j))
        if later and (best == NOT_FOUND or before(positions, j, best)):
            best = j
    return best


@compiled
def noisy_alignment(
    positions: Floats, headings: Floats, heard: Bools, noise: float, noise_rad: float, u: Floats
) -> tuple[float, float]:
    """The unit vector along the sum of the headings heard, each with its noise; (0, 0) if they cancel out.

    `u` (2,): mirrored draws, 1 - u, mirror the noise.
    """
    first, second = seeded(u[0], u[1])
    side = 1.0 if u[0] < 0.5 else -1.0
    x, y = 0.0, 0.0
    nearest = following(positions, heard, NOT_FOUND)
    while nearest != NOT_FOUND:
        for j in range(len(heard)):
            here = positions[j, 0] == positions[nearest, 0] and positions[j, 1] == positions[nearest, 1]
            if heard[j] and here:
                first, second, uniform = drawn(first, second)
                angle = side * noise_rad * normal(uniform)
                error = math.atan2(noise * math.sin(angle), 1.0 + noise * math.cos(angle))
                x += math.cos(headings[j] + error)
                y += math.sin(headings[j] + error)
        nearest = following(positions, heard, nearest)
    if math.hypot(x, y) < NEGLIGIBLE:
        return 0.0, 0.0
    return unit(x, y)


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: alignment and proximal control; the speed falls with the turn."""
    heard, hx, hy = kobots.alignment(members.headings, sets[0])
    if heard > 0 and parameters.noise > 0.0:
        hx, hy = noisy_alignment(
            members.positions, members.headings, sets[0], parameters.noise, parameters.noise_rad, u
        )
    sensed, px, py = kobots.proximal(members.positions, sets[1], obstacles.points, parameters)
    weight = parameters.proximal_weight
    bearing, speed = kobots.steered(hx + weight * px, hy + weight * py, parameters.speed_m_s)
    rule = (1 if heard > 0 else 0) + (2 if sensed > 0 else 0)
    return Motion(Kind.HEADING, bearing, speed, rule)
