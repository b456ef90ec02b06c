"""How robots would like to move, which no sensor shows: their desired velocities, and laws that are told of these.

Source: Hodgins and Brogan 1994, section 3.2: the herding algorithm reads its neighbours' desired velocities.
"""

from __future__ import annotations

import math

import numpy as np

from flocking.types import Floats, Kind, Motion
from sensing.types import Detection, WorldTruth

ACTUAL, DESIRED = VELOCITIES = ("actual", "desired")
"""What a law is told as velocities."""


def desired_w(motion: Motion, command: tuple[float, float], heading: float, before: Floats) -> Floats:
    """(2,) how a robot that has decided on this motion would like to move, m/s in the world.

    Of a velocity that itself; of hold what was desired `before`; of any other motion the speed that is commanded
    (`command`: m/s and rad/s), straight ahead. `heading`: where it looks, rad.
    """
    if motion.kind == Kind.HOLD:
        return before
    x, y = (motion.x, motion.y) if motion.kind == Kind.VELOCITY else (command[0], 0.0)
    return turned(np.array([x, y]), heading)


def turned(vectors: Floats, heading: float) -> Floats:
    """(…, 2) vectors in the axes of a robot that looks along `heading` (rad), in those of the world."""
    c, s = math.cos(heading), math.sin(heading)
    found: Floats = vectors @ np.array([[c, s], [-s, c]])
    return found


def shift(detection: Detection, truth: WorldTruth) -> Floats:
    """(2,) what is added to actual velocities, its own likewise, so that a robot is told of desired ones; m/s, in its
    own axes.

    As in the herds of `trials.simulations.running`: the mean of the neighbours' velocities becomes that of the desired
    ones, and what the damper knows of them relative to oneself stays actual.
    """
    ids = detection.members.ids
    assert truth.desired_w is not None
    if len(ids) == 0:
        return np.zeros(2)
    by_w = (truth.desired_w[ids] - truth.velocities_w[ids]).mean(axis=0)
    return turned(by_w, -float(truth.poses_w[truth.focal, 2]))
