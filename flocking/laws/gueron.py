"""The dynamics of herds: four zones, and in the stress zone five sectors that each turn, slow or hasten a member.

Source: Gueron, Levin and Rubenstein 1996, "The dynamics of herds: from individuals to aggregations"; Fine 2015, table
A.1, which formalises one of the four zones, and section 3.4.1. Lengths in metres, one body-length being one metre.

The stress zone is a rectangle about the member. In it lie five sectors: front F, left and right front LF and RF, left
and right back LB and RB. With w > 1 and u the member's own speed, the table's seven cases are

    F alone                        course as it is, speed u / w
    LF and RF alone                course as it is, speed 0
    LB and RB alone                course as it is, speed u w
    LF alone, LB alone             a right angle to the right of the course, speed u
    RF alone, RB alone             a right angle to the left of the course, speed u

The combinations that it omits are read so that these remain as they are:

    LF and RF, whatever else       speed 0: there is no way past
    else F, one side alone         step to the free side, speed u
    else F                         course, speed u / w
    else one side alone            step to the free side, speed u
    else LB and RB                 course, speed u w: pressed from behind
    else (one front, the back across) course, speed u: no side is free

With nobody in the stress zone the other three zones are read so, each only if those before it are empty:

    neutral      ahead, within `neutral_m`: course, speed u (the zone's name)
    attraction   ahead, within `attraction_m`: speed u w, turned by `approach_rad` towards the side if all are on one
    rear         behind, within `attraction_m`: the member leads, and waits: speed u / w
    nobody       course, speed u

The course is the direction of the goal, for a herd on the move to somewhere; a sidestep ends with the update, and the
course is taken up again. A member without a goal takes its own heading for the course: then a sidestep is a turn that
stays, as the table prints it. Zones and sectors lie about the course; one straight behind is in LB and RB.

Needs positions, and of itself the goal. Members of role 1 are the strong ones: a higher speed, else the same law (the
heterogeneous group). Speeds are worked out from the member's own speed and not from the last one, from which a member
that had stopped could never start again. The publication's numbers are not in the document: all are choices.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.angles import wrap
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions", "goal"})
RULES = (
    "alone",
    "slow behind",
    "stop",
    "pressed",
    "sidestep",
    "boxed in",
    "neutral",
    "attraction",
    "lead",
)
SETS = {"neighbours": "distance-based(0, attraction_m)"}
RELATIONS = ("neutral_m at most attraction_m",)
TAXONOMY = Taxonomy("heterogeneous", "idealized", "discrete", "member", False, True, False, False)
VALIDATION = Validation("S", True, "local", "global", "global", "unbounded free")
FILLED = (
    Filled(
        "neighbour selection",
        "table A.1 selects by a bounding box and five angles about the member's course, which no heading gives",
        "the law tells zones and sectors apart itself, about the course; only the range is a selection",
    ),
    Filled("neighbour selection", "the angles of the five sectors", "front 30 degrees either way, sides to 90"),
    Filled(
        "motion computation",
        "25 of the 32 combinations of sectors in table A.1",
        "the blocked front first, then the free side, then the back",
    ),
    Filled(
        "motion computation",
        "three of the four zones in table A.1",
        "neutral: no response; attraction: approach in haste; rear: the leader waits",
    ),
    Filled(
        "motion computation",
        "table A.1 multiplies the last speed, which never recovers from 0",
        "the member's own speed is multiplied",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "whether a turn of 90 degrees stays",
        "a sidestep for a member with a goal, a turn for one without",
    ),
    Filled("motion computation", "how many members of a herd are strong", "a choice: five of a kinematic herd"),
)
HERD = Herd(spacing_m=3.0, speed_m_s=1.0, dt_s=0.5, leaders=5)
CREATE = {
    "stress_length_m": 0.6,
    "stress_width_m": 0.45,
    "neutral_m": 1.2,
    "attraction_m": 4.0,
    "speed_m_s": 0.2,
    "strong_speed_m_s": 0.3,
    "factor": 1.5,
}

ALONE, SLOW, BLOCKED, PRESSED, SIDESTEP, BOXED, NEUTRAL, ATTRACTION, LEAD = range(9)
STRAIGHT_RAD = 1e-9
"""A member this near to the course, ahead or behind, is on neither side: rounding of angles is smaller."""
SIDE = math.pi / 2.0
"""Between the front and the back sectors, rad."""


class Parameters(NamedTuple):
    """Of the dynamics of herds."""

    stress_length_m: Annotated[float, Parameter("m", "w1 of table A.1, half the length; our choice", low=0.0)] = 2.0
    stress_width_m: Annotated[float, Parameter("m", "w2 of table A.1, half the width; our choice", low=0.0)] = 1.0
    front_rad: Annotated[float, Parameter("rad", "half the angle of F; our choice", low=0.0, high=math.pi / 2.0)] = (
        math.pi / 6.0
    )
    neutral_m: Annotated[float, Parameter("m", "radius of the neutral zone; our choice", low=0.0)] = 5.0
    attraction_m: Annotated[float, Parameter("m", "radius of the attraction and rear zones; our choice", low=0.0)] = (
        15.0
    )
    approach_rad: Annotated[
        float, Parameter("rad", "turn towards those in the attraction zone; our choice", low=0.0, high=math.pi / 2.0)
    ] = math.pi / 4.0
    speed_m_s: Annotated[float, Parameter("m/s", "u of a weak member; our choice", low=0.0)] = 1.0
    strong_speed_m_s: Annotated[float, Parameter("m/s", "u of a strong member (role 1); our choice", low=0.0)] = 1.2
    factor: Annotated[float, Parameter("", "w_i of table A.1, haste and delay; our choice", low=1.0)] = 2.0


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: the course, a sidestep or an approach."""
    course = 0.0
    if not math.isnan(own.goal[0]):
        course = math.atan2(own.goal[1], own.goal[0])
    front = left_front = right_front = left_back = right_back = False
    neutral = rear = ahead_left = ahead_right = False
    for j in range(len(sets[0])):
        if not sets[0, j]:
            continue
        d = math.hypot(members.positions[j, 0], members.positions[j, 1])
        if d == 0.0:
            continue
        angle = wrap(math.atan2(members.positions[j, 1], members.positions[j, 0]) - course)
        along, across = d * math.cos(angle), d * math.sin(angle)
        straight_behind = math.pi - abs(angle) <= STRAIGHT_RAD
        if abs(along) <= parameters.stress_length_m and abs(across) <= parameters.stress_width_m:
            if abs(angle) <= parameters.front_rad:
                front = True
            elif abs(angle) <= SIDE:
                left_front = left_front or angle > 0.0
                right_front = right_front or angle < 0.0
            else:
                left_back = left_back or angle > 0.0 or straight_behind
                right_back = right_back or angle < 0.0 or straight_behind
        elif abs(angle) > SIDE:
            rear = True
        elif d <= parameters.neutral_m:
            neutral = True
        else:
            ahead_left = ahead_left or angle > STRAIGHT_RAD
            ahead_right = ahead_right or angle < -STRAIGHT_RAD
            if abs(angle) <= STRAIGHT_RAD:
                ahead_left = ahead_right = True
    speed = parameters.strong_speed_m_s if own.role == 1 else parameters.speed_m_s
    left, right = left_front or left_back, right_front or right_back
    turn = 0.0
    if left_front and right_front:
        return Motion(Kind.STOP, math.nan, math.nan, BLOCKED)
    if left != right:
        rule = SIDESTEP
        turn = -SIDE if left else SIDE
    elif front:
        rule = SLOW
        speed /= parameters.factor
    elif left_back and right_back:
        rule = PRESSED
        speed *= parameters.factor
    elif left:
        rule = BOXED
    elif neutral:
        rule = NEUTRAL
    elif ahead_left or ahead_right:
        rule = ATTRACTION
        speed *= parameters.factor
        if ahead_left != ahead_right:
            turn = parameters.approach_rad if ahead_left else -parameters.approach_rad
    elif rear:
        rule = LEAD
        speed /= parameters.factor
    else:
        rule = ALONE
    return Motion(Kind.HEADING, wrap(course + turn), speed, rule)
