"""A floor with Creates and walls, for tests that drive."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import pytest
from hypothesis import settings

from robots import physics
from robots.create import model as create
from robots.create.fleet import Fleet

settings.register_profile("compiled", deadline=None)  # the first call compiles
settings.load_profile("compiled")


@dataclass
class Arena:
    """A compiled world, its state and its Creates."""

    model: mujoco.MjModel
    data: mujoco.MjData
    fleet: Fleet

    def run(self, seconds: float, watch: Callable[[], None] | None = None) -> None:
        for _ in range(round(seconds / self.model.opt.timestep)):
            self.fleet.before_step(self.data)
            mujoco.mj_step(self.model, self.data)
            self.fleet.after_step(self.data)
            if watch is not None:
                watch()
        assert self.data.warning.number.sum() == 0, "MuJoCo warned"

    def pose(self, k: int = 0) -> np.ndarray:
        return self.fleet.poses(self.data)[k]


def arena(
    *starts: tuple[float, float, float],
    walls: Sequence[tuple[float, float, float, float]] = (),
    timestep_s: float = physics.TIMESTEP,
    change: Callable[[mujoco.MjSpec], None] | None = None,
) -> Arena:
    """Creates at `starts` (x, y, heading), boxes `walls` (centre x, y, half-lengths)."""
    spec = mujoco.MjSpec()
    physics.apply_options(spec, timestep_s)
    plane, box = mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_BOX
    spec.worldbody.add_geom(name="floor", type=plane, size=(0, 0, 1), contype=physics.FLOOR_MASK, conaffinity=0)
    for x, y, half_x, half_y in walls:
        mask = {"contype": physics.HULL_MASK, "conaffinity": physics.HULL_MASK}
        spec.worldbody.add_geom(type=box, size=(half_x, half_y, 0.25), pos=(x, y, 0.25), **mask)
    starts = starts or ((0.0, 0.0, 0.0),)
    for k, (x, y, heading) in enumerate(starts):
        quat = (math.cos(heading / 2), 0, 0, math.sin(heading / 2))
        frame = spec.worldbody.add_frame(pos=(x, y, 0), quat=quat)
        spec.attach(create.spec(), prefix=f"{k}/", frame=frame)
    if change is not None:
        change(spec)
    physics.take_servos_implicitly(spec)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return Arena(model, data, Fleet(model, [f"{k}/" for k in range(len(starts))]))


@pytest.fixture
def build() -> Callable[..., Arena]:
    return arena
