"""Members that do exactly as one law says, uncompiled. For the tests of laws of physics."""

from __future__ import annotations

import importlib
import math
from types import ModuleType
from typing import Any

import numpy as np

from flocking.selection import parse_sets, resolved, select
from flocking.types import NO_OBSTACLES, Floats, Kind, Members, Motion, Own


def module(name: str) -> ModuleType:
    return importlib.import_module(f"flocking.laws.{name}")


class Swarm:
    """Members that do exactly as their law says, all at once; a body points where it moves."""

    def __init__(self, name: str, positions: Floats, headings: Floats, speed: float, dt: float, **given: Any) -> None:
        self.law = module(name)
        self.parameters = self.law.Parameters(**given)
        self.selections = parse_sets("all", self.law.SETS, self.parameters._fields)
        self.positions, self.headings = np.array(positions, dtype=float), np.array(headings, dtype=float)
        self.velocities = speed * directions(self.headings)
        self.dt = dt
        self.side = math.inf
        self.roles = np.zeros(len(headings), dtype=int)
        self.memory = np.zeros((len(headings), getattr(self.law, "MEMORY", 0)))
        self.rng = np.random.default_rng(5)

    def seen_by(self, i: int) -> Members:
        others = np.arange(len(self.positions)) != i
        gaps = self.positions[others] - self.positions[i]
        if math.isfinite(self.side):
            gaps -= self.side * np.round(gaps / self.side)
        positions = turned(gaps, -self.headings[i])
        return Members(
            np.ascontiguousarray(positions),
            np.arctan2(positions[:, 1], positions[:, 0]),
            self.headings[others] - self.headings[i],
            np.ascontiguousarray(turned(self.velocities[others], -self.headings[i])),
            np.flatnonzero(others),
        )

    def decide(self, i: int) -> Motion:
        members = self.seen_by(i)
        sets = np.array([select(resolved(steps, self.parameters._asdict()), members) for steps in self.selections])
        motion: Motion = self.law.law(
            own(turned(self.velocities[i], -self.headings[i]), self.dt, int(self.roles[i])),
            members,
            sets,
            NO_OBSTACLES,
            self.parameters,
            self.memory[i],
            self.rng.random(getattr(self.law, "DRAWS", 0)),
        )
        return motion

    def step(self) -> None:
        for i, motion in enumerate([self.decide(i) for i in range(len(self.positions))]):
            if motion.kind == Kind.HEADING:
                self.headings[i] += motion.x
                self.velocities[i] = motion.y * directions(self.headings[i])
                continue
            if motion.kind == Kind.HOLD:
                continue
            moved = turned(np.array([motion.x, motion.y]), self.headings[i])
            self.velocities[i] = moved if motion.kind == Kind.VELOCITY else self.velocities[i] + moved * self.dt
            self.headings[i] = math.atan2(self.velocities[i, 1], self.velocities[i, 0])
        self.positions = self.positions + self.velocities * self.dt

    def run(self, steps: int) -> None:
        for _ in range(steps):
            self.step()

    def order(self) -> float:
        return float(np.hypot(*directions(self.headings).mean(axis=0)))

    def mean_order(self, steps: int) -> float:
        total = 0.0
        for _ in range(steps):
            self.step()
            total += self.order()
        return total / steps

    def radius(self) -> float:
        """Root mean square distance from the middle, m."""
        return float(np.sqrt(((self.positions - self.positions.mean(axis=0)) ** 2).sum(axis=1).mean()))


def own(velocity: Floats, dt: float, role: int = 0) -> Own:
    return Own(np.array(velocity), math.nan, math.nan, np.full(2, math.nan), np.zeros(2, dtype=np.bool_), dt, 0, role)


def directions(angles: Any) -> Floats:
    return np.stack([np.cos(angles), np.sin(angles)], axis=-1)


def turned(vectors: Floats, angle: float) -> Floats:
    c, s = math.cos(angle), math.sin(angle)
    return vectors @ np.array([[c, s], [-s, c]])


def crowd(name: str, count: int, side: float, seed: int = 1, **given: Any) -> Swarm:
    """So many members with random headings in a square, in the publication's own units."""
    law, rng = module(name), np.random.default_rng(seed)
    positions, headings = rng.uniform(0.0, side, (count, 2)), rng.uniform(-math.pi, math.pi, count)
    return Swarm(name, positions, headings, law.HERD.speed_m_s, law.HERD.dt_s, **given)
