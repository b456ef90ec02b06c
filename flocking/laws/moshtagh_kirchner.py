"""Flocking by what a camera can tell: bearing and time to impact of the nearest member in view.

Source: Kirchner 2006, sections 3.5 and 3.6, equations 3.7, 3.8, 3.17 and 3.18, on the law of Moshtagh et al. 2005.
Metres and seconds; the source's inches, feet and degrees are converted. Body frame.

Two parts, as in section 3.6.7, with a message of four numbers between them:

- `message`, the image process. ω = −k Σ (β'/2) √(1 + 1/(τ β')²) over the members seen: β the bearing clockwise, β' its
  rate, τ = −d / d' the time to impact; beside it closure rate d', distance d and bearing of the nearest member.
- `controlled`, the controller. Its turn rate is ω. With V its speed: farther than the ideal distance V grows by
  d'/(150 in) an update; nearer it shrinks until it is at its least. Nearer still, at the least speed and closing in, it
  turns away by equation 3.18 instead; nearer than the danger distance it stands and turns away. Nobody in view:
  straight ahead at the speed it has.

Kirchner's deviations from Moshtagh are parameters or follow from them: the nearest member only (`nearest_only`), a
field of view of 220 degrees (`view_deg`) and of a camera's reach, a speed that is not constant. Where the printed
equations have two plausible readings, the other one is a parameter: `growth`, `growth_per_update`, `turn_adds`,
`omega_accelerates`, `own_turning`, `stop_is_kept` (docs/monocular.md, Control).

Reads positions and velocities: β' and τ come from the relative position and velocity, where the source measured them
from one image to the next; of a member without a velocity only distance and bearing are known. No camera, cone or
pixels here.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.compilation import compiled
from flocking.geometry import NOT_FOUND, nearest
from flocking.message import NOBODY, Message
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "velocities"})
MAY_LACK = frozenset({"velocities"})
"""A member is seen from its first image on, and closes in and turns from its second."""
RULES = ("straight ahead", "flock", "turn away", "danger")
SETS = {"seen": "distance-based(0, range_m) & field-of-view(view_deg)"}
RELATIONS = ("danger_m at most ideal_m", "least_m_s at most top_m_s")
STRAIGHT, FLOCK, AWAY, DANGER = range(4)
MEMORY = 3
SPEED, STARTED, TURN = range(3)
DRAWS = 1
MOVING_APART, ABSOLUTE, SIGNED = range(3)
"""Readings of equation 3.17."""

INCH = 0.0254
KIRCHNER = "Kirchner 2006"
TURN_MOST_DEG, TURN_LEAST_DEG, TURN_SCALE = 15.0, 5.0, 21.4
"""Of equation 3.18: deg/s, deg/s; the last divides degrees and quarter inches."""
STRAIGHT_ON = 1e-9
"""One whose bearing turns less than this share of the sum's term comes or goes straight on: the sign is rounding."""
MOST_AHEAD = 1.5
"""rad: how far an aim lies ahead at the most, so that a turning body still goes forward. A choice."""


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
    growth: Annotated[
        int,
        Parameter(
            "",
            "our reading of 3.17: 0 the speed grows while the nearest moves away, 1 by the absolute rate, 2 as signed",
            low=0,
            high=2,
            plausible=(MOVING_APART, ABSOLUTE, SIGNED),
        ),
    ] = MOVING_APART
    growth_per_update: Annotated[
        bool,
        Parameter(
            "",
            f"{KIRCHNER}, equation 3.6: the closure rate of 3.17 is the way since the last update; false: in a second",
            published=True,
            plausible=(False, True),
        ),
    ] = True
    turn_adds: Annotated[
        bool,
        Parameter(
            "",
            "our reading of 3.18: the turn rate that turns away; true: as printed it adds to the last one",
            plausible=(False, True),
        ),
    ] = False
    omega_accelerates: Annotated[
        bool,
        Parameter(
            "",
            "our reading of 3.8: a turn rate, as in the original; true: the angular acceleration that it is named",
            plausible=(False, True),
        ),
    ] = False
    own_turning: Annotated[
        bool,
        Parameter(
            "",
            "our reading of 3.8: the bearing's rate without the own turning; true: with it, as a camera measures it",
            plausible=(False, True),
        ),
    ] = False
    stop_is_kept: Annotated[
        bool,
        Parameter(
            "",
            "our reading of section 3.6.8: after a stop the speed is that of before; true: it is 0",
            plausible=(False, True),
        ),
    ] = False
    aim_s: Annotated[
        float,
        Parameter(
            "s",
            "our choice: 0: the heading of a turn of one update; above: bodies are told the heading this far ahead",
            low=0.0,
            plausible=(),
        ),
    ] = 0.0


TAXONOMY = Taxonomy("homogeneous", "constrained", "continuous", "member", False, True, True, False)
VALIDATION = Validation("SP", False, "local", "inferred", "-", "bounded free")
NO_ROW = "publications that the tables do not hold; the rows are what they earn"
FILLED = (
    Filled(
        "motion computation",
        "equation 3.8 is named an angular acceleration and written as a derivative of the heading",
        "a turn rate, as in the original; the parameter omega_accelerates has the other",
    ),
    Filled(
        "motion computation",
        "the signs of the bearing and of the turn",
        "bearings clockwise, as the cameras' angles are added, turns counter-clockwise: then members ahead align",
    ),
    Filled(
        "motion computation",
        "whether the rate of the bearing holds the own turning",
        "it does not: only the relative motion, which is what equation 3.8 is derived for; with own_turning it does",
    ),
    Filled(
        "motion computation",
        "the change of equation 3.17 is said to be always positive, which a closing member contradicts",
        "a negative closure rate changes nothing beyond the ideal distance; the parameter growth has two others",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "equations 3.6, 3.17 and 3.18 are steps an update of unstated length",
        "3.17 holds for the change of distance since the last update, however long ago; 3.18 is the turn rate itself, "
        "which the text puts between 5 and 15 degrees; growth_per_update and turn_adds have the others",
    ),
    Filled(
        "motion computation", "the unit of the speed in equation 3.17", "m/s, as Player takes it; the rate's, inches"
    ),
    Filled(
        "motion computation",
        "equation 3.8 divides by zero for a member whose bearing keeps",
        "no turn; nor where its rate is nothing but rounding",
    ),
    Filled("motion computation", "the side to turn away to from a member dead ahead", "drawn"),
    Filled(
        "motion computation",
        "a stopped member keeps its current velocity where nobody is in view any more: it would stand for good",
        "it goes on at the speed of before the stop; with stop_is_kept it stands",
    ),
    Filled("motion computation", "the coupling, the least speed and the preset slowing have no value", "parameters"),
)
HERD = Herd(1.2, 0.3, 0.1)
CREATE = {
    "range_m": 4.0,
    "ideal_m": 0.8,
    "danger_m": 0.4,
    "start_m_s": 0.2,
    "least_m_s": 0.05,
    "top_m_s": 0.4,
    "aim_s": 0.5,
}
"""Bodies turn towards an aim at twice its angle a second: an aim half a second ahead gives the very turn rate. The turn
of one update is a fifth of that, and one below a degree is no turn to them."""


@compiled
def alignment_rate(x: float, y: float, vx: float, vy: float, own_turn_rate: float = 0.0) -> float:
    """The sum's term of equation 3.8 for one member, counter-clockwise: its place and velocity relative to the own.

    √(β'² + 1/τ²) is the relative speed divided by the distance. `own_turn_rate`: what the bearing turns by besides.
    """
    squared = x * x + y * y
    if squared == 0.0:
        return 0.0
    turning = (x * vy - y * vx) / squared - own_turn_rate
    closing = (x * vx + y * vy) / squared
    rate = 0.5 * math.hypot(turning, closing)
    if abs(turning) <= STRAIGHT_ON * rate:
        return 0.0
    return math.copysign(rate, turning)


@compiled
def turn_away_rate(distance: float, bearing: float) -> float:
    """Equation 3.18, rad/s: the harder, the nearer and the straighter ahead the member is."""
    rate = TURN_MOST_DEG - (abs(math.degrees(bearing)) + 4.0 * (distance / INCH - 10.0)) / TURN_SCALE
    return math.radians(min(max(rate, TURN_LEAST_DEG), TURN_MOST_DEG))


@compiled
def speed_change(closure: float, growth: int) -> float:
    """The closure rate that the speed changes by in equation 3.17, by its readings, m/s."""
    if growth == ABSOLUTE:
        return abs(closure)
    return closure if growth == SIGNED else max(closure, 0.0)


@compiled
def message(own: Own, members: Members, sets: Bools, obstacles: Obstacles, parameters: Parameters) -> Message:
    """What the image process makes of the members seen."""
    k = nearest(members.positions, sets[0])
    if k == NOT_FOUND:
        return NOBODY
    turned = own.turn_rate if parameters.own_turning else 0.0
    x, y = members.positions[k, 0], members.positions[k, 1]
    vx, vy = members.velocities[k, 0] - own.velocity[0], members.velocities[k, 1] - own.velocity[1]
    distance = math.hypot(x, y)
    closure = (x * vx + y * vy) / distance if distance > 0.0 else 0.0
    bearing = math.atan2(y, x)
    rate = 0.0
    if math.isnan(closure):  # seen for the first time: how it moves is not known yet
        closure = 0.0
    if parameters.nearest_only:
        if distance > 0.0 and not math.isnan(vx):
            rate += alignment_rate(x, y, vx, vy, turned)
        return Message(parameters.coupling * rate, closure, distance, bearing)
    for j in range(len(members.ids)):
        x, y = members.positions[j, 0], members.positions[j, 1]
        vx, vy = members.velocities[j, 0] - own.velocity[0], members.velocities[j, 1] - own.velocity[1]
        if sets[0, j] and (x != 0.0 or y != 0.0) and not math.isnan(vx):
            rate += alignment_rate(x, y, vx, vy, turned)
    return Message(parameters.coupling * rate, closure, distance, bearing)


@compiled
def steered(rate: float, speed: float, dt: float, aim_s: float, rule: int) -> Motion:
    """The motion at that turn rate (rad/s) and speed (m/s)."""
    if aim_s == 0.0:
        return Motion(Kind.HEADING, rate * dt, speed, rule)
    aim = min(max(rate * aim_s, -MOST_AHEAD), MOST_AHEAD)
    if speed == 0.0:
        return Motion(Kind.HEADING, aim, 0.0, rule)
    return Motion(Kind.VELOCITY, speed * math.cos(aim), speed * math.sin(aim), rule)


@compiled
def controlled(told: Message, dt: float, parameters: Parameters, memory: Floats, u: Floats) -> Motion:
    """What the controller makes of the message."""
    if memory[STARTED] == 0.0:
        memory[STARTED], memory[SPEED] = 1.0, parameters.start_m_s
    distance, top_turn = told.distance, parameters.top_turn_rad_s
    if math.isnan(distance):
        memory[TURN] = 0.0
        return steered(0.0, memory[SPEED], dt, parameters.aim_s, STRAIGHT)
    if distance > parameters.ideal_m:
        least = min(memory[SPEED], parameters.least_m_s)
        since = dt if parameters.growth_per_update else 1.0
        grown = memory[SPEED] + parameters.closure_gain * speed_change(told.closure, parameters.growth) * since
        memory[SPEED] = max(grown, least)
    elif distance < parameters.ideal_m:
        memory[SPEED] = max(memory[SPEED] - parameters.slowing_m_s2 * dt, parameters.least_m_s)
    memory[SPEED] = min(memory[SPEED], parameters.top_m_s)

    danger = distance < parameters.danger_m
    slowest = memory[SPEED] <= parameters.least_m_s
    if danger or (distance < parameters.ideal_m and slowest and told.closure < 0.0):
        rate = turn_away_rate(distance, told.bearing)
        ahead = told.bearing == 0.0 or abs(told.bearing) == math.pi  # or right behind
        if (told.bearing > 0.0 and not ahead) or (ahead and u[0] < 0.5):
            rate = -rate
        if parameters.turn_adds:
            rate = min(max(memory[TURN] + rate, -top_turn), top_turn)
        memory[TURN] = rate
        speed = 0.0 if danger else memory[SPEED]
        if danger and parameters.stop_is_kept:
            memory[SPEED] = 0.0
        return steered(rate, speed, dt, parameters.aim_s, DANGER if danger else AWAY)

    rate = memory[TURN] + told.omega * dt if parameters.omega_accelerates else told.omega
    memory[TURN] = min(max(rate, -top_turn), top_turn)
    return steered(memory[TURN], memory[SPEED], dt, parameters.aim_s, FLOCK)


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """The turn and the speed: the controller's answer to the image process's message."""
    return controlled(message(own, members, sets, obstacles, parameters), own.dt, parameters, memory, u)
