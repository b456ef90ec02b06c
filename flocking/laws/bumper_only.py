"""A law that knows nothing but its bumper: straight ahead, and after a contact wait, back off and turn.

Source: our reading of a question of Fine 2015, section 3.6.1: whether direct contact alone can make members flock.
Metres and seconds, body frame.

After a contact the member stands for the waiting time, backs off for a while and turns by a drawn angle away from the
side that was pressed (a drawn side if both were), then goes straight ahead again. A new contact counts from then on.

Two ways in which contact could make a group, each a parameter: waiting makes members gather where they meet, for one
that waits is met by others; and two that turn away by less than the angle at which they met part at a smaller one. With
`turn_with` true the turn is towards the pressed side: two that brush against each other push. A wall cannot be told
from a member.

Reads the contacts and, to know when it has turned, its own turn rate. Neighbours do not matter.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"contacts"})
RULES = ("straight ahead", "wait", "back off", "turn")
STRAIGHT, WAITING, BACKING, TURNING = range(4)
MEMORY = 4
WAIT_LEFT, BACK_LEFT, TURN_LEFT, PATIENCE = range(4)
DRAWS = 2
RELATIONS = ("turn_least_rad at most turn_most_rad",)

OURS = "our choice: the question has no numbers"
ENOUGH_RAD = 1e-6
"""A turn within this of its angle is done."""
OVER_S = 1e-6
"""A time of which less than this is left is over."""


class Parameters(NamedTuple):
    """Of a member that feels its way."""

    speed_m_s: Annotated[float, Parameter("m/s", f"{OURS}; the Create's cruising speed", low=0.0)] = 0.25
    wait_s: Annotated[float, Parameter("s", OURS, low=0.0)] = 1.0
    back_s: Annotated[float, Parameter("s", OURS, low=0.0)] = 0.3
    back_speed_m_s: Annotated[float, Parameter("m/s", OURS, low=0.0)] = 0.1
    turn_least_rad: Annotated[float, Parameter("rad", OURS, low=0.0, high=math.pi)] = 0.3
    turn_most_rad: Annotated[float, Parameter("rad", OURS, low=0.0, high=math.pi)] = 1.2
    turn_with: Annotated[bool, Parameter("", f"{OURS}; true: towards the side that was pressed")] = False
    patience_s: Annotated[
        float, Parameter("s", f"{OURS}; a turn that something blocks is given up after this", low=0.0)
    ] = 3.0


TAXONOMY = Taxonomy("homogeneous", "constrained", "continuous", "all", False, False, False, False)
VALIDATION = Validation("-", False, "-", "-", "-", "-")
NO_ROW = "our reading of a question of section 3.6.1, from no publication; nobody has validated it"
FILLED = (
    Filled(
        "motion computation",
        "the document asks for flocking by contact alone and proposes no rule",
        "straight ahead; after a contact wait, back off and turn by a drawn angle",
    ),
    Filled("member detection", "a contact with a wall and one with a member", "are not told apart"),
    Filled("motion computation", "both sides pressed at once", "the side to turn to is drawn"),
)
HERD = Herd(0.8, 0.25, 0.1, "bounded")
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
    """What comes next after the last contact."""
    left, right = own.contacts[0], own.contacts[1]
    idle = max(memory[WAIT_LEFT], memory[BACK_LEFT], memory[PATIENCE]) <= OVER_S
    if idle and (left or right):
        spread = parameters.turn_most_rad - parameters.turn_least_rad
        turn = parameters.turn_least_rad + spread * abs(2.0 * u[0] - 1.0)
        to_the_right = (left and not right) or (left and right and u[1] < 0.5)
        if to_the_right != parameters.turn_with:
            turn = -turn
        memory[WAIT_LEFT], memory[BACK_LEFT] = parameters.wait_s, parameters.back_s
        memory[TURN_LEFT], memory[PATIENCE] = turn, parameters.patience_s
    elif max(memory[WAIT_LEFT], memory[BACK_LEFT]) <= OVER_S and memory[PATIENCE] < parameters.patience_s:
        memory[TURN_LEFT] -= own.turn_rate * own.dt
    if memory[WAIT_LEFT] > OVER_S:
        memory[WAIT_LEFT] -= own.dt
        return Motion(Kind.STOP, math.nan, math.nan, WAITING)
    if memory[BACK_LEFT] > OVER_S:
        memory[BACK_LEFT] -= own.dt
        return Motion(Kind.HEADING, 0.0, -parameters.back_speed_m_s, BACKING)
    if memory[PATIENCE] > OVER_S and abs(memory[TURN_LEFT]) > ENOUGH_RAD:
        memory[PATIENCE] -= own.dt
        return Motion(Kind.HEADING, memory[TURN_LEFT], 0.0, TURNING)
    memory[PATIENCE] = 0.0
    return Motion(Kind.HEADING, 0.0, parameters.speed_m_s, STRAIGHT)
