"""The group that `herd validate` tries environments with: kinematic members or robots, by `--set members.…`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, NamedTuple

from flocking import obstacle_selection
from flocking.errors import InputError
from flocking.kinematic.bands import OBSTACLES
from flocking.parameters import Parameter, filled
from generation.group import Group
from generation.validation.kinematic import KinematicGroup, Members, kinematic
from generation.validation.starts import Starts

PREFIX = "members."
ROBOTS_OWN = ("pipeline", "selection", "step_units")
"""Of what robots are given, what is not in their setup."""


class Kinematic(NamedTuple):
    """What kinematic members can be given."""

    dt_s: Annotated[float, Parameter("s", "one iteration", low=1e-6)] = 1.0
    selection: Annotated[str, Parameter("", "Fine 2015, table 3.1")] = Members.selection
    speed_m_s: Annotated[float, Parameter("m/s", "ours: 2 units an iteration", low=1e-9)] = Members.speed_m_s
    max_speed_m_s: Annotated[float, Parameter("m/s", "ours", low=1e-9)] = Members.max_speed_m_s
    max_turn_rate_rad_s: Annotated[float, Parameter("rad/s", "ours", low=0.0)] = Members.max_turn_rate_rad_s
    radius_m: Annotated[float, Parameter("m", "0 = points", low=0.0)] = Members.radius_m
    obstacles: Annotated[str, Parameter("", "Fine 2015, figure 3.3", choices=OBSTACLES)] = Members.obstacles
    obstacle_selection: Annotated[str, Parameter("", "Fine 2015, figure 3.3", reads=obstacle_selection.parse)] = (
        Members.obstacle_selection
    )
    look_ahead_m: Annotated[float, Parameter("m", "of the shared avoidance", low=0.0)] = Members.look_ahead_m
    margin_m: Annotated[float, Parameter("m", "likewise", low=0.0)] = Members.margin_m
    sight_m: Annotated[float, Parameter("m", "range within which walls are seen", low=0.0)] = Members.sight_m
    goal_x_m: Annotated[float, Parameter("m", "of all members, for laws that read a goal")] = Members.goal_x_m
    goal_y_m: Annotated[float, Parameter("m", "likewise")] = Members.goal_y_m


def group(
    law: str,
    count: int,
    law_parameters: Mapping[str, Any],
    given: Mapping[str, Any],
    starts: Mapping[str, Any],
    body: str | None = None,
    scale: float | None = None,
    jobs: int = 1,
) -> tuple[Group, Starts]:
    """A group and how it starts; `given`: below `members.`, `starts`: below `starts.`. Raises `InputError`."""
    if body is None:
        if scale is not None:
            raise InputError(f"--scale {scale:g}: is of robots; expected --body too")
        filled(Kinematic, given, PREFIX)
        made: KinematicGroup = kinematic(law, count, law_parameters=law_parameters, **given)
        _ = made.bands  # refused before anything is tried
        return made, filled(Starts, starts, "starts.")
    return _robots(law, count, law_parameters, given, starts, body, scale, jobs)


def _robots(
    law: str,
    count: int,
    law_parameters: Mapping[str, Any],
    given: Mapping[str, Any],
    starts: Mapping[str, Any],
    body: str,
    scale: float | None,
    jobs: int,
) -> tuple[Group, Starts]:
    from trials.environments.robots import SCALE, checked, robots

    scale = SCALE if scale is None else scale
    if not 1e-4 <= scale <= 1e3:
        raise InputError(f"--scale {scale:g}: expected metres in a unit, from 0.0001 to 1000")
    setup = checked(given, PREFIX)
    own = {name: setup.pop(name) for name in ROBOTS_OWN if name in setup}
    made = robots(law, count, law_parameters=law_parameters, body=body, scale=scale, jobs=jobs, setup=setup, **own)
    least = {"apart_m": made.apart_units, "clear_m": made.apart_units / 2.0}
    return made, filled(Starts, {**least, **starts}, "starts.")
