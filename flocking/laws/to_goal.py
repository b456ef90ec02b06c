"""To a goal: straight to the place that a robot is told, and no farther.

Source: ours, for robots that are sent: the pilots of a herd (Fine 2015, section 8.2), whose formation and ways are
planned for them. Whoever tells the goal sees to it that the way there is free.

Reads its goal alone. Without one it stands.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation
from flocking.types import Bools, Floats, Kind, Members, Motion, Obstacles, Own

NEEDS = frozenset({"goal"})
RULES = ("stand", "go")
SETS = {"nobody": "all"}
TAXONOMY = Taxonomy("homogeneous", "constrained", "continuous", "-", False, False, False, False)
VALIDATION = Validation("P", False, "-", "-", "-", "bounded obstacles")
NO_ROW = "the pilots of section 8.2, which the tables leave out"
FILLED = (Filled("motion computation", "how a piloting robot drives to its place", "straight, by way-points"),)
CREATE: dict[str, float] = {}
HERD = Herd(spacing_m=4.0, speed_m_s=1.0, dt_s=1.0)


class Parameters(NamedTuple):
    """Of a robot that is sent; its speed is its group's."""

    arrived_m: Annotated[float, Parameter("m", "our choice: a third of a Create's radius", low=0.0)] = 0.05
    """A goal nearer than this is reached."""


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Way-point: the goal."""
    x, y = own.goal[0], own.goal[1]
    if not x * x + y * y > parameters.arrived_m * parameters.arrived_m:  # nan: no goal
        return Motion(Kind.STOP, 0.0, 0.0, 0)
    return Motion(Kind.WAY_POINT, x, y, 1)
