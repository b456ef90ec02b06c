"""Walls that rise and vanish while a trial goes on: fences on bodies that are put where they are wanted.

A wall that does not stand is `AWAY_M` off, farther than any laser sees and any robot gets.
"""

from __future__ import annotations

import math

import mujoco
import numpy as np

from flocking.types import Bools, Floats
from worlds.walls import FENCE, HEIGHT, box_like

AWAY_M = 1e4


def add_standing(spec: mujoco.MjSpec, segments: Floats, reflectance: float) -> None:
    """Adds a body `standing-K` with the box of a fence for each segment (K, 4), m; none of them stands."""
    for number, (x0, y0, x1, y1) in enumerate(segments):
        body = spec.worldbody.add_body(name=_name(number), mocap=True, pos=[AWAY_M, number * 10.0, HEIGHT / 2])
        body.add_geom(
            name=_name(number),
            size=[math.hypot(x1 - x0, y1 - y0) / 2, FENCE / 2, HEIGHT / 2],
            **box_like(0.0, reflectance),
        )


class Standing:
    """The walls of one world that can stand or not."""

    def __init__(self, model: mujoco.MjModel, segments: Floats) -> None:
        self.segments = segments
        """(K, 4) x0, y0, x1, y1 where they stand, m."""
        self.up: Bools = np.zeros(len(segments), dtype=np.bool_)
        """(K,) which stand now."""
        self._mocap = [int(model.body_mocapid[model.body(_name(k)).id]) for k in range(len(segments))]

    def put(self, data: mujoco.MjData, number: int, up: bool) -> None:
        """Lets a wall, by its number from 0, stand or vanish."""
        self.up[number] = up
        x0, y0, x1, y1 = self.segments[number]
        turn, row = math.atan2(y1 - y0, x1 - x0) / 2, self._mocap[number]
        place = ((x0 + x1) / 2, (y0 + y1) / 2) if up else (AWAY_M, number * 10.0)
        data.mocap_pos[row, :2] = place
        data.mocap_quat[row] = math.cos(turn), 0.0, 0.0, math.sin(turn)


def _name(number: int) -> str:
    return f"standing-{number + 1}"
