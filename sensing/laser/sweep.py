"""The laser's mirror turns while robots move: each beam at its own instant. Compiled."""

from __future__ import annotations

import math

from flocking.compilation import compiled
from flocking.types import Floats, Ints
from sensing.laser.planar import BEAMS, STEPS_A_TURN, cast_one, laser_pose

TURN_S = 0.1
"""P: the motor turns once in 100 ms (10 Hz)."""
BEAM_S = TURN_S / STEPS_A_TURN
"""D: from one beam to the next; the 682 beams take 66.5 ms."""
SWEEP_S = (BEAMS - 1) * BEAM_S


@compiled
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


@compiled
def cast_sweep(
    mount_frame: int,
    mount: Floats,
    own: int,
    max_range_m: float,
    poses: Floats,
    shapes: Floats,
    rectangles: int,
    frames: Ints,
    owners: Ints,
    beams: Floats,
    lasers: Floats,
    nearness: Floats,
    surfaces: Ints,
) -> None:
    """As `planar.cast`, with `poses` (B, F, 4) for each beam; fills `lasers` (B, 4), the laser's poses, as well."""
    for i in range(BEAMS):
        laser = laser_pose(poses[i], mount_frame, mount)
        lasers[i, 0], lasers[i, 1], lasers[i, 2], lasers[i, 3] = laser
        nearness[i], surfaces[i] = cast_one(
            i, laser, own, max_range_m, poses[i], shapes, rectangles, frames, owners, beams
        )
