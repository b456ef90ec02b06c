"""Nearest-neighbour averaging of headings, with leaders that keep theirs.

Source: Jadbabaie, Lin and Morse 2003 (conference 2002), "Coordination of groups of mobile autonomous agents using
nearest neighbor rules"; Fine 2015, table A.1 (leader-follower). Metres and seconds; the publication's units are free.

A follower's new heading is the plain average of its own and those of the n members within range, leaders among them:
own heading + the sum of the differences / (1 + n). A leader (role 1) keeps its heading. The speed is constant.
Followers that are linked to a leader, over others and often enough, all take up its heading.

Needs headings; the selection needs positions. A member does not tell leaders from followers among its neighbours. No
neighbours: the heading stays and the member moves on. Differences of heading are wrapped, and
members of a kinematic herd move by the old velocity, as in `jadbabaie`.
"""

from __future__ import annotations

from typing import NamedTuple

from flocking.laws.jadbabaie import WRAPPED, RangeM, SpeedMS, heading_differences
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

LEADER = 1

NEEDS = frozenset({"headings"})
RULES = ("alone", "average", "lead")
SETS = {"neighbours": "distance-based(0, range_m)"}
TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "-", False, True, False, True)
VALIDATION = Validation("M", True, "global", "constant", "global", "-")
FILLED = (
    Filled(
        "neighbour selection",
        "table A.1 intersects the neighbours with the fixed set of leaders, so that followers would not see each other",
        "all members within range, leaders among them, as in the original",
        misprint=True,
    ),
    WRAPPED,
    Filled(
        "motion computation",
        "table 3.2 counts the group as homogeneous, although leaders do not average",
        "the row is given as printed; a leader is a member of role 1, and there may be several",
    ),
)
HERD = Herd(spacing_m=0.5, speed_m_s=0.03, dt_s=1.0, space="periodic", leaders=1, updating="forward")
CREATE = {"range_m": 2.5, "speed_m_s": 0.25}


class Parameters(NamedTuple):
    """Of Jadbabaie's law with leaders."""

    range_m: RangeM = 1.0
    speed_m_s: SpeedMS = 0.03


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Heading: the average, or the leader's own."""
    if own.role == LEADER:
        return Motion(Kind.HEADING, 0.0, parameters.speed_m_s, 2)
    found, total = heading_differences(members.headings, sets[0])
    if found == 0:
        return Motion(Kind.HEADING, 0.0, parameters.speed_m_s, 0)
    return Motion(Kind.HEADING, total / (found + 1.0), parameters.speed_m_s, 1)
