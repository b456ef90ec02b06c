"""What a robot knows of itself: how it moves, its heading in the world, where its goal is.

It knows its pose at the start. From there on it reckons its motion from one of three sources:

- `commands`: the drive commands and the wheels' acceleration limit. They show neither slip nor contacts.
- `odometry`: what its body counts of its wheels; a Create counts whole millimetres and degrees, and so reads no turn
  slower than 67 degrees/s.
- `true`: global knowledge, for ideal cases.

In the detection case study (six robots, 60 s, extended Hamilton's rule) one update of 0.1 s turns a robot by 0.5
degrees in the mean; `commands` errs by 0.2 degrees (rms) and after the minute by 0 to 45 degrees, most where robots
touch; `odometry` errs by 1.0 degrees and after the minute by 18 to 137 degrees.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from flocking.angles import wrap
from flocking.types import Floats
from robots.body import Fleet
from sensing.types import WorldTruth

COMMANDS, ODOMETRY, TRUE = SOURCES = ("commands", "odometry", "true")
TURN_RATE, COMPASS, GOAL = 2, 3, slice(4, 6)
"""Their places in a law's row of numbers about itself (`flocking.lawentry.OWN_SIZE`); the velocity comes first."""


class Knowledge:
    """What one robot knows of itself, brought up to date at each of its updates."""

    def __init__(
        self, fleet: Fleet, index: int, source: str, start_w: Floats, goal_w: Floats | None, follows_pose: bool
    ) -> None:
        """`start_w` (3,): its pose at the start. `follows_pose`: whether `pose_w` is needed."""
        self.fleet, self.index, self.source = fleet, index, source
        self.start_w, self.goal_w, self.follows_pose = start_w, goal_w, follows_pose
        self.pose_w = start_w.copy()
        """(3,) x, y and heading in the world, as far as it knows."""
        self._true_heading = float(start_w[2])

    def tell(self, data: Any, elapsed: float, row: Floats, truth: WorldTruth | None = None) -> None:
        """Fills in a law's row of numbers about itself, which holds the encoders' motion; brings `pose_w` up to date.

        `elapsed`: time since this was last called, s. `truth`: of now, where somebody has asked for it already.
        """
        if self.source == COMMANDS:
            self.fleet.meant(self.index, row)
        elif self.source == TRUE:
            self._truly(data, elapsed, row, truth)
        if not self.follows_pose:
            return
        if self.source != TRUE:
            way = self.fleet.meant_pose(self.index) if self.source == COMMANDS else self.fleet.counted_pose(self.index)
            self.pose_w = composed(self.start_w, way)
        x, y, heading = self.pose_w.tolist()
        row[COMPASS] = wrap(heading)
        if self.goal_w is not None:
            to_x, to_y = self.goal_w[0] - x, self.goal_w[1] - y
            c, s = math.cos(heading), math.sin(heading)
            row[GOAL] = c * to_x + s * to_y, c * to_y - s * to_x

    def _truly(self, data: Any, elapsed: float, row: Floats, truth: WorldTruth | None) -> None:
        poses_w = self.fleet.poses(data) if truth is None else truth.poses_w
        velocities_w = self.fleet.velocities(data) if truth is None else truth.velocities_w
        self.pose_w = poses_w[self.index].copy()
        heading = float(self.pose_w[2])
        vx, vy = velocities_w[self.index].tolist()
        c, s = math.cos(heading), math.sin(heading)
        row[0], row[1] = c * vx + s * vy, c * vy - s * vx
        row[TURN_RATE] = wrap(heading - self._true_heading) / elapsed if elapsed > 0.0 else 0.0
        self._true_heading = heading


def composed(first: Floats, second: Floats) -> Floats:
    """(3,) the pose that lies at `second` in the frame of the pose `first`."""
    c, s = math.cos(first[2]), math.sin(first[2])
    return np.array(
        [
            first[0] + c * second[0] - s * second[1],
            first[1] + s * second[0] + c * second[1],
            first[2] + second[2],
        ]
    )
