"""What a robot makes of its echoes: obstacles, but for what it takes for the echoes of flockmates.

A flockmate is no obstacle, but a sonar cannot tell one from the other; the cameras can. A cone that is seen explains an
echo where the flockmate under it may have thrown it back: where the arc on which the sonar has it (at its range, within
`HALF_WIDTH_RAD` of its axis) comes as near to the cone's place as the farthest part of such a body that a sonar hears
(`Echoes.mate_m`). So no flockmate of the own kind whose cone is seen in its place is an obstacle, and neither is what
stands within that distance of it. One outside of the cameras' view, or whose cone is hidden or missed, is an obstacle.
"""

from __future__ import annotations

import numpy as np

from flocking.types import Bools, Floats, Obstacles
from sensing.sonar import HALF_WIDTH_RAD
from sensing.types import Echoes

NOWHERE: Floats = np.empty((0, 2))


def explained(echoes: Echoes, cones: Floats) -> Bools:
    """(S,) which sonars' echoes come from a flockmate under one of the cones seen (M, 2), m, body frame.

    What heard nothing has none, and nothing is explained where `mate_m` is nan.
    """
    heading = echoes.ring[:, 2]
    away = cones[None] - echoes.ring[:, None, :2]
    distance = np.hypot(away[..., 0], away[..., 1])
    aside = np.arctan2(away[..., 1], away[..., 0]) - heading[:, None]
    aside = np.abs(np.arctan2(np.sin(aside), np.cos(aside)))
    beyond = np.maximum(aside - HALF_WIDTH_RAD, 0.0)
    ranges = np.where(np.isfinite(echoes.ranges), echoes.ranges, 0.0)[:, None]
    squared = distance**2 + ranges**2 - 2.0 * distance * ranges * np.cos(beyond)
    near = squared <= echoes.mate_m**2
    return np.asarray(near.any(axis=1) & np.isfinite(echoes.ranges))


def obstacles(echoes: Echoes, cones: Floats = NOWHERE) -> Obstacles:
    """A point on the axis of each sonar that heard something which no cone seen (M, 2) explains, body frame, m.

    The echo may have come from anywhere in the sonar's cone: at 1 m up to 0.26 m aside of the point.
    """
    taken = np.isfinite(echoes.ranges)
    if len(cones):
        taken &= ~explained(echoes, cones)
    x, y, heading = echoes.ring[taken].T
    way = echoes.ranges[taken]
    return Obstacles(np.column_stack([x + way * np.cos(heading), y + way * np.sin(heading)]))
