"""What a robot does about obstacles beside what its law does: their selection, virtual members, added avoidance.

Fine 2015, section 3.6.1 with figure 3.3: obstacles are selected in parallel with neighbours; virtual members join the
set D before neighbours are selected.
"""

from __future__ import annotations

import numpy as np

from flocking import avoidance, obstacle_selection
from flocking.types import Floats, Motion, Obstacles, only
from sensing.types import Detection
from trials.simulations.robots.fields import AVOID, VIRTUAL
from trials.simulations.robots.resolved import Resolved

AVOIDING = "avoiding"
"""Name of the rule that speaks where the added avoidance turned a motion."""


class ObstacleStage:
    """Of one group."""

    def __init__(self, resolved: Resolved) -> None:
        """Raises `InputError`."""
        given, needs = resolved.given, resolved.wanted.needs
        self.steps = obstacle_selection.parse(given.obstacle_selection)
        self.parameters = resolved.avoidance
        self.avoids = given.obstacles == AVOID
        self.virtual = given.obstacles == VIRTUAL
        self.acts = self.virtual or bool(self.steps)
        self._needs_headings = "headings" in needs

    def heeded(self, detection: Detection, velocity: Floats) -> Detection:
        """The obstacles that are selected, and after the members the virtual ones, if there are to be any.

        A virtual member stands still while the robot does: then it has no heading, and is left out where one is needed.
        """
        obstacles = obstacle_selection.select(self.steps, detection.obstacles)
        members = detection.members
        if self.virtual and len(obstacles.points):
            members = avoidance.with_virtual_members(members, obstacles, velocity, self.parameters.virtual_range_m)
            if self._needs_headings:
                members = only(members, np.flatnonzero(~np.isnan(members.headings)))
        return Detection(members, obstacles, detection.beams)

    def avoided(self, motion: Motion, velocity: Floats, dt: float, obstacles: Obstacles, rule: int) -> Motion:
        """The motion, turned where an obstacle stands in its way; then `rule` speaks."""
        kind, x, y, turned = avoidance.avoid(
            motion.kind,
            motion.x,
            motion.y,
            velocity[0],
            velocity[1],
            dt,
            obstacles.points,
            self.parameters.look_ahead_m,
            self.parameters.margin_m,
        )
        return Motion(int(kind), x, y, rule) if turned else motion
