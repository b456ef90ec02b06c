"""Drive: a script of up to six legs, each a time at a speed and a turn rate, for robots that are driven by hand.

Source: ours, for the robots of Kirchner 2006 that nobody steers by sight: the lead robot of section 4.1, which a person
drove from a keyboard, and the robots of appendices B and C, which went a distance and turned through an angle by their
own odometry. Metres, seconds, radians, body frame.

A leg of a speed above zero is driven as it stands: at that speed, on the arc of that turn rate, without a look at where
it leads. (A body's steering may fade near rest: Creates and Pioneers turn less than asked below 0.05 m/s.) A leg
without a speed turns in place: its aim swings at the turn rate, the robot follows its aim by its own odometry, and the
leg ends when it has caught up with it, at most 5 s after its time. A leg of no time is left out. After the last one,
or as soon as its own odometry says that `stop_m` is driven or `stop_rad` turned (0: never), it stands for good.

`radius_error` is the part by which the robot takes its wheels' radius too large (negative: too small): what it believes
to have driven and turned is longer by it. Legs are timed, so that it matters to turns in place and to stopping alone.

Reads its own motion alone: neighbours do not matter, and nothing is avoided.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS: frozenset[str] = frozenset()
RULES = ("stand", "drive", "turn in place")
SETS = {"nobody": "all"}
CHIRAL = True
STAND, GO, TURN = range(3)
MEMORY = 6
LEG, IN_LEG, SPEED, DISTANCE, TURNED, TURNED_IN_LEG = range(6)
LEGS = 6
CAUGHT_UP = 0.03
"""rad: a turn in place within this of its angle is done; above what a body's steering leaves. A choice."""
PATIENCE_S = 5.0
"""After its time a turn in place is given up after this. A choice."""
MOST_AHEAD = 1.5
"""rad: how far an aim lies ahead at the most, so that it never comes to lie behind. A choice."""
OVER_S = 1e-6
"""A time of which less than this is left is over."""

OURS = "our choice: the text gives no script"


class Parameters(NamedTuple):
    """Of a robot that is driven."""

    leg_1_s: Annotated[float, Parameter("s", OURS, low=0.0)] = 10.0
    leg_1_m_s: Annotated[float, Parameter("m/s", f"{OURS}; the Create's cruising speed", low=0.0)] = 0.25
    leg_1_rad_s: Annotated[float, Parameter("rad/s", OURS, low=-2.0, high=2.0)] = 0.0
    leg_2_s: Annotated[float, Parameter("s", OURS, low=0.0)] = 0.0
    leg_2_m_s: Annotated[float, Parameter("m/s", OURS, low=0.0)] = 0.0
    leg_2_rad_s: Annotated[float, Parameter("rad/s", OURS, low=-2.0, high=2.0)] = 0.0
    leg_3_s: Annotated[float, Parameter("s", OURS, low=0.0)] = 0.0
    leg_3_m_s: Annotated[float, Parameter("m/s", OURS, low=0.0)] = 0.0
    leg_3_rad_s: Annotated[float, Parameter("rad/s", OURS, low=-2.0, high=2.0)] = 0.0
    leg_4_s: Annotated[float, Parameter("s", OURS, low=0.0)] = 0.0
    leg_4_m_s: Annotated[float, Parameter("m/s", OURS, low=0.0)] = 0.0
    leg_4_rad_s: Annotated[float, Parameter("rad/s", OURS, low=-2.0, high=2.0)] = 0.0
    leg_5_s: Annotated[float, Parameter("s", OURS, low=0.0)] = 0.0
    leg_5_m_s: Annotated[float, Parameter("m/s", OURS, low=0.0)] = 0.0
    leg_5_rad_s: Annotated[float, Parameter("rad/s", OURS, low=-2.0, high=2.0)] = 0.0
    leg_6_s: Annotated[float, Parameter("s", OURS, low=0.0)] = 0.0
    leg_6_m_s: Annotated[float, Parameter("m/s", OURS, low=0.0)] = 0.0
    leg_6_rad_s: Annotated[float, Parameter("rad/s", OURS, low=-2.0, high=2.0)] = 0.0
    stop_m: Annotated[float, Parameter("m", f"{OURS}; by its own odometry, 0: never", low=0.0)] = 0.0
    stop_rad: Annotated[float, Parameter("rad", f"{OURS}; by its own odometry, 0: never", low=0.0)] = 0.0
    radius_error: Annotated[
        float, Parameter("", "our choice: the part by which it takes its wheels too large", low=-0.5, high=0.5)
    ] = 0.0


TAXONOMY = Taxonomy("homogeneous", "constrained", "continuous", "-", False, False, False, False)
VALIDATION = Validation("P", False, "-", "-", "-", "bounded free")
NO_ROW = "a robot that is driven by hand flocks with nobody"
FILLED = (
    Filled("motion computation", "the path of a lead robot that a person drives", "legs, each a straight or an arc"),
    Filled("motion computation", "when a robot that is told a distance or an angle stops", "when its odometry says so"),
)
HERD = Herd(spacing_m=4.0, speed_m_s=0.25, dt_s=0.1)
CREATE: dict[str, float] = {}


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """The leg of now: an acceleration to its speed and turn rate, or the heading of a turn in place."""
    p = parameters
    seconds = (p.leg_1_s, p.leg_2_s, p.leg_3_s, p.leg_4_s, p.leg_5_s, p.leg_6_s)
    speeds = (p.leg_1_m_s, p.leg_2_m_s, p.leg_3_m_s, p.leg_4_m_s, p.leg_5_m_s, p.leg_6_m_s)
    rates = (p.leg_1_rad_s, p.leg_2_rad_s, p.leg_3_rad_s, p.leg_4_rad_s, p.leg_5_rad_s, p.leg_6_rad_s)
    believed = (1.0 + p.radius_error) * own.dt
    memory[DISTANCE] += own.velocity[0] * believed
    memory[TURNED] += own.turn_rate * believed
    memory[TURNED_IN_LEG] += own.turn_rate * believed
    if 0.0 < p.stop_m <= memory[DISTANCE] or 0.0 < p.stop_rad <= abs(memory[TURNED]):
        memory[LEG] = LEGS
    while memory[LEG] < LEGS:
        leg = int(memory[LEG])
        left_s = seconds[leg] - memory[IN_LEG]
        in_place = seconds[leg] > OVER_S and speeds[leg] == 0.0 and rates[leg] != 0.0
        behind = abs(rates[leg] * seconds[leg] - memory[TURNED_IN_LEG]) > CAUGHT_UP
        if left_s > OVER_S or (in_place and behind and left_s > -PATIENCE_S):
            break
        memory[LEG] += 1.0
        memory[IN_LEG], memory[TURNED_IN_LEG] = 0.0, 0.0
    if memory[LEG] >= LEGS:
        memory[SPEED] = 0.0
        return Motion(Kind.STOP, math.nan, math.nan, STAND)
    leg = int(memory[LEG])
    speed, rate = speeds[leg], rates[leg]
    memory[IN_LEG] += own.dt
    if speed > 0.0:
        turn = rate * own.dt
        x = (speed * math.cos(turn) - memory[SPEED]) / own.dt
        memory[SPEED] = speed
        return Motion(Kind.ACCELERATION, x, speed * math.sin(turn) / own.dt, GO)
    memory[SPEED] = 0.0
    if rate == 0.0:
        return Motion(Kind.STOP, math.nan, math.nan, STAND)
    aim = rate * min(memory[IN_LEG], seconds[leg]) - memory[TURNED_IN_LEG]
    return Motion(Kind.HEADING, min(max(aim, -MOST_AHEAD), MOST_AHEAD), 0.0, TURN)
