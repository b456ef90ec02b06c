"""Robots that hop, on open ground, for the tests beside this file."""

from __future__ import annotations

import numpy as np

from robots.one_legged.ground import Ground, build

SPEEDS = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0])
"""m/s, commanded along x, a robot each."""
RUN_UP_S, RUN_S = 20.0, 40.0


def lined_up(count: int, heading: float = 0.0, apart: float = 3.0) -> np.ndarray:
    """(N, 3) poses side by side."""
    return np.column_stack([np.zeros(count), apart * np.arange(count), np.full(count, heading)])


def heights(count: int) -> np.ndarray:
    """(N,) m, from which robots are let fall so that they hop out of step."""
    return np.linspace(0.0, 0.15, count)


class Steady:
    """A minute of robots that run straight on."""

    def __init__(self) -> None:
        self.ground: Ground = build(lined_up(len(SPEEDS)), heights(len(SPEEDS)))
        fleet, data = self.ground.fleet, self.ground.data
        fleet.desire_all(np.column_stack([SPEEDS, np.zeros_like(SPEEDS)]))
        self.ground.run(RUN_UP_S)
        start, hops = fleet.poses(data), fleet.hops
        self.lowest, self.forces = np.inf, np.zeros(4)
        for _ in range(round(RUN_S / self.ground.model.opt.timestep)):
            self.ground.step()
            self.lowest = min(self.lowest, data.qpos[2::11].min())
            self.forces = np.maximum(self.forces, np.abs(data.ctrl.reshape(-1, 4)).max(axis=0))
        self.way = fleet.poses(data) - start
        self.hops = fleet.hops - hops
