"""One-legged robots on open ground, ready to be stepped: what the herd of Hodgins and Brogan 1994 needs of a world."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from flocking.errors import InputError
from flocking.types import Floats
from robots.one_legged import model as one_legged
from robots.one_legged.control import Gains
from robots.one_legged.fleet import Fleet
from robots.physics import FLOOR_MASK, bare
from robots.physics import apply_options as apply_all_options


@dataclass
class Ground:
    """A compiled world of one-legged robots and nothing else."""

    model: mujoco.MjModel
    data: mujoco.MjData
    fleet: Fleet

    def step(self, count: int = 1) -> None:
        """Steps physics with the control in the loop, `model.opt.timestep` each."""
        for _ in range(count):
            self.fleet.before_step(self.data)
            mujoco.mj_step(self.model, self.data)
            self.fleet.after_step(self.data)

    def run(self, seconds: float) -> None:
        """The same for a time, s."""
        self.step(round(seconds / self.model.opt.timestep))


def apply_options(spec: mujoco.MjSpec, timestep_s: float = one_legged.TIMESTEP) -> None:
    """Sets the solver's options: those of all worlds with robots, but for friction no stiffer than pressing.

    That stiffness (`physics.FRICTION_STIFFNESS`) is for tyres; without it a herd of 105 takes a quarter less time.
    """
    apply_all_options(spec, timestep_s)
    spec.option.impratio = 1.0


def specification(
    poses_w: Floats, heights: Sequence[float] | Floats | None = None, timestep_s: float = one_legged.TIMESTEP
) -> mujoco.MjSpec:
    """A floor with a robot at each pose (N, 3): x, y (m), heading (rad); names are prefixed `0/`, `1/` and so on.

    `heights` (N,): of the soles above the floor, m. Robots let fall from different heights hop out of step.
    """
    poses_w = np.asarray(poses_w, dtype=np.float64)
    if poses_w.ndim != 2 or poses_w.shape[1] != 3 or not np.isfinite(poses_w).all():
        raise InputError(f"poses of shape {poses_w.shape}: expected finite ones of shape (N, 3)")
    spec = mujoco.MjSpec()
    spec.copy_during_attach = True
    apply_options(spec, timestep_s)
    spec.worldbody.add_geom(
        name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=(0, 0, 1), contype=FLOOR_MASK, conaffinity=0
    )
    robot = bare(one_legged.spec())
    above = np.zeros(len(poses_w)) if heights is None else np.asarray(heights, dtype=np.float64)
    for k, ((x, y, heading), z) in enumerate(zip(poses_w.tolist(), above.tolist(), strict=True)):
        frame = spec.worldbody.add_frame(pos=(x, y, z), quat=(math.cos(heading / 2), 0.0, 0.0, math.sin(heading / 2)))
        spec.attach(robot, prefix=f"{k}/", frame=frame)
    return spec


def build(
    poses_w: Floats,
    heights: Sequence[float] | Floats | None = None,
    gains: Gains | None = None,
    timestep_s: float = one_legged.TIMESTEP,
) -> Ground:
    """The robots of `specification`, compiled, with their fleet; all are told to hop on the spot."""
    model = specification(poses_w, heights, timestep_s).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return Ground(model, data, Fleet(model, [f"{k}/" for k in range(len(poses_w))], gains))
