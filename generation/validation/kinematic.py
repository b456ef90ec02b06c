"""A group of the kinematic herd: any law of the project, or several, compiled; thousands of environments a minute.

Laws and kernel are those of `flocking.kinematic`. Motion models that avoid nothing are given the avoidance that all
laws share: the plus of RM+ and SNN+ (Fine 2015, section 6.3.3). Walls hide what is behind them, so that a construct
outside of a corridor does nothing to who is in it. Metres and seconds; one unit of Fine 2015 is 1 m, one iteration
`dt_s`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from flocking import avoidance, lawentry, lawsource
from flocking.kinematic.bands import Band
from flocking.kinematic.many import Start, positions_of
from flocking.types import Floats
from generation.group import Job

LOOK_AHEAD_STEPS = 4.0
"""Of the avoidance, in steps at full speed: a turn of half a radian a step needs three to turn off a wall. A choice."""
MARGIN_STEPS = 1.0
"""Distance kept from walls, likewise. A choice."""


@dataclass(frozen=True)
class Members:
    """Members that run one law. Text and numbers only, so that a process can be sent it."""

    law: str
    """A law's name, or the path of a user's own file."""
    count: int
    law_parameters: Mapping[str, Any] = field(default_factory=dict)
    selection: str = "all"
    speed_m_s: float = 2.0
    """At the start, along their headings, and towards way-points."""
    max_speed_m_s: float = math.inf
    max_turn_rate_rad_s: float = 0.5
    radius_m: float = 0.0
    """0 = points, which walls stop and nothing else does."""
    obstacles: str = "avoid"
    """`as-law`, `avoid` or `virtual-members`, as in `flocking.kinematic.Band`."""
    obstacle_selection: str = "all"
    look_ahead_m: float = math.nan
    """Of the shared avoidance; nan = `LOOK_AHEAD_STEPS` at the speed."""
    margin_m: float = math.nan
    """Likewise; nan = `MARGIN_STEPS` at the speed, and the radius."""
    sight_m: float = math.nan
    """Range within which walls are seen; nan = as far as the shared avoidance looks, and without limit where the law
    or virtual members see them."""
    goal_x_m: float = math.nan
    """Of all members, for the laws that read a goal: far away it is a preferred direction; nan = none."""
    goal_y_m: float = math.nan
    """Likewise."""
    law_source: str = ""
    """Text of the user's own law file."""

    def band(self, dt_s: float) -> Band:
        """As the kinematic herd takes them. Raises `InputError`."""
        law = lawentry.load(self.law, self.law_source)
        step_m = self.speed_m_s * dt_s
        look = LOOK_AHEAD_STEPS * step_m if math.isnan(self.look_ahead_m) else self.look_ahead_m
        margin = MARGIN_STEPS * step_m + self.radius_m if math.isnan(self.margin_m) else self.margin_m
        shared = avoidance.Parameters(look_ahead_m=look, margin_m=margin)
        sight = self.sight_m
        if math.isnan(sight):
            only_avoids = self.obstacles == "avoid" and "obstacles" not in law.needs
            sight = max(look, step_m) + margin if only_avoids else math.inf
        return Band(
            law,
            self.count,
            dict(self.law_parameters),
            selection=self.selection,
            cruise_m_s=self.speed_m_s,
            max_speed_m_s=self.max_speed_m_s,
            max_turn_rate_rad_s=self.max_turn_rate_rad_s,
            radius_m=self.radius_m,
            goals_w=np.tile([self.goal_x_m, self.goal_y_m], (self.count, 1)),
            sight_m=sight,
            sight_lines=True,
            obstacle_selection=self.obstacle_selection,
            obstacles=self.obstacles,
            avoidance=shared,
        ).checked()


@dataclass(frozen=True)
class KinematicGroup:
    """Kinematic members of one law or of several, band after band: a `generation.group.Group`."""

    members: tuple[Members, ...]
    dt_s: float = 1.0

    @property
    def count(self) -> int:
        """Number of members."""
        return sum(each.count for each in self.members)

    def __getstate__(self) -> dict[str, Any]:
        """Without the compiled bands, which each process makes for itself."""
        return {"members": self.members, "dt_s": self.dt_s}

    @cached_property
    def bands(self) -> list[Band]:
        """Its bands, compiled. Raises `InputError`."""
        made = [each.band(self.dt_s) for each in self.members]
        for band in made:  # refused before anything is simulated
            band.stages()
            band.rows()
        return made

    def trajectories(self, jobs: Sequence[Job], iterations: int) -> Iterator[Floats]:
        """For each job, in their order, the positions (iterations + 1, N, 2) of its members, m, from the start on.

        Raises `InputError` for what does not fit, and `LawFailedError` if a law fails.
        """
        speeds = np.repeat([each.speed_m_s for each in self.members], [each.count for each in self.members])
        walls = {id(job.environment): job.environment.walls() for job in jobs}
        starts = [Start(job.poses_w, walls[id(job.environment)], job.seed) for job in jobs]
        return positions_of(self.bands, starts, self.dt_s, iterations, speeds)


def kinematic(law: str, count: int, dt_s: float = 1.0, **given: Any) -> KinematicGroup:
    """A group of one law; `given`: fields of `Members`. The text of a user's own law file is read. `InputError`."""
    source = lawsource.read_source(law) if lawentry.is_path(law) else ""
    return KinematicGroup((Members(law, count, law_source=source, **given),), dt_s)
