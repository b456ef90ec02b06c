"""Members under one law, uncompiled, in a body frame of their own. For the tests of laws from control and robotics."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from flocking import lawentry, selection
from flocking.types import NO_OBSTACLES, Bools, Floats, Kind, Members, Motion, Own

ROUNDING = 1e-9
"""Sums of up to a hundred terms of size 1 to 100, each right to 1e-16, over up to a thousand steps."""


def rotation(angle: float) -> Floats:
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


class Flock:
    """Members under one law, uncompiled and synchronous; body frames point where `headings` say."""

    def __init__(self, name: str, positions: Any, *, dt: float = 0.01, linked: Bools | None = None, **set_to: float):
        self.module = lawentry.module_of(name)
        self.parameters = self.module.Parameters(**set_to)
        values = self.parameters._asdict()
        steps = selection.parse_sets("all", self.module.SETS, values)
        self.steps = [selection.resolved(each, values) for each in steps]
        self.positions = np.array(positions, dtype=np.float64)
        self.count = len(self.positions)
        self.velocities = np.zeros((self.count, 2))
        self.headings = np.random.default_rng(self.count).uniform(-3.0, 3.0, self.count)
        self.goals = np.full((self.count, 2), np.nan)
        self.roles = np.zeros(self.count, dtype=np.int64)
        self.linked = np.ones((self.count, self.count), dtype=np.bool_) if linked is None else linked
        self.dt = dt
        self.obstacles = NO_OBSTACLES

    def decide(self, i: int, u: float | Floats = 0.5) -> Motion:
        others = np.arange(self.count) != i
        to_body = rotation(self.headings[i])
        near = (self.positions[others] - self.positions[i]) @ to_body
        members = Members(
            near,
            np.arctan2(near[:, 1], near[:, 0]),
            self.headings[others] - self.headings[i],
            self.velocities[others] @ to_body,
            np.flatnonzero(others),
        )
        goal = (self.goals[i] - self.positions[i]) @ to_body
        velocity, heading, role = self.velocities[i] @ to_body, float(self.headings[i]), int(self.roles[i])
        own = Own(velocity, 0.0, heading, goal, np.zeros(2, dtype=np.bool_), self.dt, i, role)
        sets = np.array([selection.select(each, members, self.linked[i][others]) for each in self.steps])
        return self.module.law(own, members, sets, self.obstacles, self.parameters, np.zeros(0), np.atleast_1d(u))

    def world(self, i: int, motion: Motion) -> Floats:
        return rotation(self.headings[i]) @ np.array([motion.x, motion.y])

    def step(self, rng: np.random.Generator | None = None) -> None:
        draws = max(1, getattr(self.module, "DRAWS", 0))
        motions = [self.decide(i, np.full(draws, 0.5) if rng is None else rng.random(draws)) for i in range(self.count)]
        for i, motion in enumerate(motions):
            if motion.kind == Kind.ACCELERATION:
                self.velocities[i] += self.world(i, motion) * self.dt
            elif motion.kind == Kind.VELOCITY:
                self.velocities[i] = self.world(i, motion)
            elif motion.kind == Kind.HEADING:
                self.headings[i] += motion.x
                self.velocities[i] = motion.y * rotation(self.headings[i])[:, 0]
        self.positions += self.velocities * self.dt

    def run(self, steps: int, rng: np.random.Generator | None = None) -> None:
        for _ in range(steps):
            self.step(rng)

    def gaps(self) -> Floats:
        i, j = np.triu_indices(self.count, 1)
        return np.hypot(*(self.positions[i] - self.positions[j]).T)

    def polarization(self) -> float:
        return float(np.hypot(np.cos(self.headings).mean(), np.sin(self.headings).mean()))


def scattered(count: int, least_gap: float, side: float, seed: int) -> Floats:
    """Points in a square, none closer to another than `least_gap`."""
    rng = np.random.default_rng(seed)
    points: list[Floats] = []
    for point in rng.uniform(0.0, side, (10_000, 2)):
        if all(np.hypot(*(point - other)) > least_gap for other in points):
            points.append(point)
    assert len(points) >= count
    return np.array(points[:count])


def spread(vectors: Floats) -> float:
    return float(np.max(np.hypot(*(vectors - vectors.mean(axis=0)).T)))
