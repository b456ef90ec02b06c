"""Where robots on free joints stand on a level floor. Compiled."""

from __future__ import annotations

import math
from typing import Any

from flocking.compilation import compiled
from flocking.types import Floats


@compiled
def write_poses(each: Any, qpos: Floats, poses: Floats) -> None:
    """Fills poses (N, 3) with x, y (m) and heading (rad, in (−π, π]); `each` (N,): records with a `root`, where the
    free joint stands in `qpos`."""
    for k in range(len(each)):
        at = each[k].root
        w, x, y, z = qpos[at + 3], qpos[at + 4], qpos[at + 5], qpos[at + 6]
        poses[k, 0], poses[k, 1] = qpos[at], qpos[at + 1]
        poses[k, 2] = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
