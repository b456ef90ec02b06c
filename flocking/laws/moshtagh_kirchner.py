"""Flocking by what a camera can tell: bearing and time to impact of the nearest member in view.

Source: Kirchner 2006, sections 3.5 and 3.6, equations 3.7, 3.8, 3.17 and 3.18, on the law of Moshtagh et al. 2005.
Metres and seconds; the source's inches, feet and degrees are converted. Body frame.

Turn rate ω = −k Σ (β'/2) √(1 + 1/(τ β')²) over the members seen: β the bearing clockwise, β' its rate, τ = −d / d' the
time to impact. With V the speed and d' the closure rate: farther than the ideal distance V grows by d'/(150 in) an
update; nearer it shrinks until it is at its least. Nearer still, at the least speed and closing in, the member turns
away by equation 3.18 instead; nearer than the danger distance it stands and turns away. Nobody in view: straight ahead
at the speed it has.

Kirchner's deviations from Moshtagh are parameters or follow from them: the nearest member only (`nearest_only`), a
field of view of 220 degrees (`view_deg`) and of a camera's reach, a speed that is not constant.

Reads positions and velocities: β' and τ come from the relative position and velocity, where the source measured them
from one image to the next. No camera, cone or pixels here.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.compilation import compiled
from flocking.geometry import NOT_FOUND, nearest
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "velocities"})
RULES = ("straight ahead", "flock", "turn away", "danger")
SETS = {"seen": "distance-based(0, range_m) & field-of-view(view_deg)"}
RELATIONS = ("danger_m at most ideal_m", "least_m_s at most top_m_s")
STRAIGHT, FLOCK, AWAY, DANGER = range(4)
MEMORY = 2
SPEED, STARTED = range(2)
DRAWS = 1

INCH = 0.0254
KIRCHNER = "Kirchner 2006"
TURN_MOST_DEG, TURN_LEAST_DEG, TURN_SCALE = 15.0, 5.0, 21.4
"""Of equation 3.18: deg/s, deg/s; the last divides degrees and quarter inches."""

STAYS = 1e-9
"""A bearing that changes by less than this part of 1/τ stays: far above rounding, far below what a robot could tell."""


class Parameters(NamedTuple):
    """Of Kirchner's robots."""

    coupling: Annotated[float, Parameter("", "our choice: k of equation 3.8, which has no value", low=0.0)] = 5.0
    nearest_only: Annotated[bool, Parameter("", f"{KIRCHNER}, section 3.6.1.1", published=True)] = True
    view_deg: Annotated[float, Parameter("deg", f"{KIRCHNER}, section 3.1", published=True, low=0.0, high=360.0)] = (
        220.0
    )
    range_m: Annotated[float, Parameter("m", f"{KIRCHNER}, section 3.3: eight feet", published=True, low=0.0)] = 2.4384
    ideal_m: Annotated[float, Parameter("m", f"{KIRCHNER}, section 3.6.8: 36 inches", published=True, low=0.0)] = 0.9144
    danger_m: Annotated[float, Parameter("m", f"{KIRCHNER}, section 3.6.8: 10 inches", published=True, low=0.0)] = 0.254
    start_m_s: Annotated[float, Parameter("m/s", "our choice: the speed at first", low=0.0)] = 0.3
    least_m_s: Annotated[float, Parameter("m/s", "our choice: the least speed, which has no value", low=0.0)] = 0.1
    top_m_s: Annotated[float, Parameter("m/s", f"{KIRCHNER}, section 3.3", published=True, low=0.0)] = 0.8
    closure_gain: Annotated[
        float, Parameter("1/s", f"{KIRCHNER}, equation 3.17: one in 150 inches", published=True, low=0.0)
    ] = 1.0 / (150.0 * INCH)
    slowing_m_s2: Annotated[float, Parameter("m/s²", "our choice: the preset slowing, which has no value", low=0.0)] = (
        0.2
    )
    top_turn_rad_s: Annotated[float, Parameter("rad/s", f"{KIRCHNER}, section 3.3", published=True, low=0.0)] = 2.0


TAXONOMY = Taxonomy("homogeneous", "constrained", "continuous", "member", False, True, True, False)
VALIDATION = Validation("SP", False, "local", "inferred", "-", "bounded free")
NO_ROW = "publications that the tables do not hold; the rows are what they earn"
FILLED = (
    Filled(
        "motion computation",
        "equation 3.8 is named an angular acceleration and written as a derivative of the heading",
        "a turn rate, as in the original",
    ),
    Filled(
        "motion computation",
        "the signs of the bearing and of the turn",
        "bearings clockwise, as the cameras' angles are added, turns counter-clockwise: then members ahead align",
    ),
    Filled(
        "motion computation",
        "whether the rate of the bearing holds the own turning",
        "it does not: only the relative motion, which is what equation 3.8 is derived for",
    ),
    Filled(
        "motion computation",
        "the change of equation 3.17 is said to be always positive, which a closing member contradicts",
        "a negative closure rate changes nothing beyond the ideal distance",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "equations 3.17 and 3.18 are steps an update of unstated length",
        "3.17 holds for the change of distance since the last update, however long ago; 3.18 is the turn rate itself, "
        "which the text puts between 5 and 15 degrees",
    ),
    Filled("motion computation", "the side to turn away to from a member dead ahead", "drawn"),
    Filled("motion computation", "the coupling, the least speed and the preset slowing have no value", "parameters"),
)
HERD = Herd(1.2, 0.3, 0.1)
CREATE = {"range_m": 4.0, "ideal_m": 0.8, "danger_m": 0.4, "start_m_s": 0.2, "least_m_s": 0.05, "top_m_s": 0.4}


@compiled
def alignment_rate(x: float, y: float, vx: float, vy: float) -> float:
    """The sum's term of equation 3.8 for one member, counter-clockwise: its place and velocity relative to the own.

    √(β'² + 1/τ²) is the relative speed divided by the distance. A bearing that stays, but for rounding, turns it to
    neither side: so does that of a virtual member, whose velocity differs from the own one along the line to it alone.
    """
    squared = x * x + y * y
    turning = (x * vy - y * vx) / squared
    closing = (x * vx + y * vy) / squared
    if abs(turning) <= STAYS * abs(closing):
        return 0.0
    return math.copysign(0.5 * math.hypot(turning, closing), turning)


@compiled
def turn_away_rate(distance: float, bearing: float) -> float:
    """Equation 3.18, rad/s: the harder, the nearer and the straighter ahead the member is."""
    rate = TURN_MOST_DEG - (abs(math.degrees(bearing)) + 4.0 * (distance / INCH - 10.0)) / TURN_SCALE
    return math.radians(min(max(rate, TURN_LEAST_DEG), TURN_MOST_DEG))


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading after one update's turn, and the speed."""
    if memory[STARTED] == 0.0:
        memory[STARTED], memory[SPEED] = 1.0, parameters.start_m_s
    k = nearest(members.positions, sets[0])
    if k == NOT_FOUND:
        return Motion(Kind.HEADING, 0.0, memory[SPEED], STRAIGHT)
    x, y = members.positions[k, 0], members.positions[k, 1]
    vx, vy = members.velocities[k, 0] - own.velocity[0], members.velocities[k, 1] - own.velocity[1]
    distance = math.hypot(x, y)
    closure = (x * vx + y * vy) / distance if distance > 0.0 else 0.0
    if distance > parameters.ideal_m:
        memory[SPEED] += parameters.closure_gain * max(closure, 0.0) * own.dt
    elif distance < parameters.ideal_m:
        memory[SPEED] = max(memory[SPEED] - parameters.slowing_m_s2 * own.dt, parameters.least_m_s)
    memory[SPEED] = min(memory[SPEED], parameters.top_m_s)

    danger = distance < parameters.danger_m
    slowest = memory[SPEED] <= parameters.least_m_s
    if danger or (distance < parameters.ideal_m and slowest and closure < 0.0):
        turn = turn_away_rate(distance, math.atan2(y, x)) * own.dt
        if y > 0.0 or (y == 0.0 and u[0] < 0.5):
            turn = -turn
        return Motion(Kind.HEADING, turn, 0.0 if danger else memory[SPEED], DANGER if danger else AWAY)

    rate = 0.0
    for j in range(len(members.ids)):
        x, y = members.positions[j, 0], members.positions[j, 1]
        if sets[0, j] and (j == k or not parameters.nearest_only) and (x != 0.0 or y != 0.0):
            rate += alignment_rate(
                x, y, members.velocities[j, 0] - own.velocity[0], members.velocities[j, 1] - own.velocity[1]
            )
    rate = min(max(parameters.coupling * rate, -parameters.top_turn_rad_s), parameters.top_turn_rad_s)
    return Motion(Kind.HEADING, rate * own.dt, memory[SPEED], FLOCK)
