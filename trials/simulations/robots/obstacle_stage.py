"""What a robot does about obstacles in addition to its law: their selection, virtual members, added avoidance.

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
"""Name of the rule by which the added avoidance turned a motion."""


class ObstacleStage:
    """The obstacle selection, virtual members and avoidance of one group."""

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
        """The selected obstacles, and the members, followed by virtual ones where the group has them.

        The virtual members of a robot at rest stand still. They then have no heading, and are left out where the law
        needs one.
        """
        obstacles = obstacle_selection.select(self.steps, detection.obstacles)
        members = detection.members
        if self.virtual and len(obstacles.points):
            members = avoidance.with_virtual_members(members, obstacles, velocity, self.parameters.virtual_range_m)
            if self._needs_headings:
                detected = np.arange(len(members.ids)) < len(detection.members.ids)
                members = only(members, np.flatnonzero(detected | ~np.isnan(members.headings)))
        return Detection(members, obstacles, detection.beams)

    def avoided(self, motion: Motion, velocity: Floats, dt: float, obstacles: Obstacles, rule: int) -> Motion:
        """The motion, turned where an obstacle is in its way; its rule is then `rule`."""
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
