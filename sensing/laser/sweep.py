"""The laser's mirror turns while robots move: each beam at its own instant. Compiled."""

from __future__ import annotations

import math

from flocking.compilation import borrowing
from flocking.types import Floats, Ints
from sensing.laser.planar import BEAMS, STEPS_A_TURN, Mounting, Places, Shapes, cast_one, laser_pose

TURN_S = 0.1
"""P: the motor turns once in 100 ms (10 Hz)."""
BEAM_S = TURN_S / STEPS_A_TURN
"""D: from one beam to the next; the 682 beams take 66.5 ms."""
SWEEP_S = (BEAMS - 1) * BEAM_S


@borrowing
def poses_of_beams(times: Floats, states: Floats, end: float, poses: Floats) -> None:
    """Fill `poses` (B, F, 4): where each frame stood when each beam was read, the last one at `end`.

    Interpolates linearly between the remembered `states` (H, F, 4) at `times` (H,), which increase; before the
    first and after the last of them frames stand still.
    """
    last = len(times) - 1
    h = 0
    for i in range(BEAMS):
        now = end - (BEAMS - 1 - i) * BEAM_S
        while h < last and times[h + 1] <= now:
            h += 1
        after = min(h + 1, last)
        part = (now - times[h]) / (times[after] - times[h]) if after > h else 0.0
        part = max(part, 0.0)
        for f in range(states.shape[1]):
            for column in range(4):
                value = states[h, f, column]
                poses[i, f, column] = value + part * (states[after, f, column] - value)
            length = math.hypot(poses[i, f, 2], poses[i, f, 3])
            poses[i, f, 2] /= length
            poses[i, f, 3] /= length


@borrowing
def cast_sweep(
    mounting: Mounting, max_range_m: float, places: Places, shapes: Shapes, nearness: Floats, surfaces: Ints
) -> None:
    """As `planar.cast`, each beam at its own instant: `places` holds the frames' poses, the laser's are filled in."""
    for i in range(BEAMS):
        laser = laser_pose(places.poses[i], mounting)
        row = places.lasers[i]
        row[0], row[1], row[2], row[3] = laser.x, laser.y, laser.cosine, laser.sine
        nearness[i], surfaces[i] = cast_one(i, laser, mounting.own, max_range_m, places.poses[i], shapes)
