"""One-legged robots on open ground, ready to be stepped: what the herd of Hodgins and Brogan 1994 needs of a world."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import mujoco
import numpy as np
from scipy.ndimage import gaussian_filter

from flocking.errors import InputError
from flocking.types import Floats
from robots.one_legged import model as one_legged
from robots.one_legged.control import Gains
from robots.one_legged.fleet import GAINS, NONE, Fleet
from robots.one_legged.imperfections import Imperfections
from robots.physics import FLOOR_MASK, bare, check_sound
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
        """The same for a time, s. Raises `DivergedError` where the physics end, as with gains far from the usual."""
        self.step(round(seconds / self.model.opt.timestep))
        check_sound(self.data)


def apply_options(spec: mujoco.MjSpec, timestep_s: float = one_legged.TIMESTEP) -> None:
    """Sets the solver's options: those of all worlds with robots, but for friction no stiffer than pressing.

    That stiffness (`physics.FRICTION_STIFFNESS`) is for tyres; without it a herd of 105 takes a quarter less time.
    """
    apply_all_options(spec, timestep_s)
    spec.option.impratio = 1.0


class Surface(NamedTuple):
    """What the robots run on; by default flat and rough."""

    friction: float = one_legged.FOOT_FRICTION
    """Of a foot on it."""
    uneven_m: float = 0.0
    """m, standard deviation of its heights; above 0 it is a height field of smooth bumps, at random."""
    bump_m: float = 2.0
    """m from bump to bump, about."""
    reach_m: float = 30.0
    """m from the origin to each side of the height field, beyond which there is nothing."""


FLAT = Surface()
_CELLS_A_BUMP = 5
_DEEPEST = 3.0
"""Times the standard deviation; what is further from the mean is cut off."""


def specification(
    poses_w: Floats,
    heights: Sequence[float] | Floats | None = None,
    timestep_s: float = one_legged.TIMESTEP,
    surface: Surface = FLAT,
    rng: np.random.Generator | None = None,
) -> mujoco.MjSpec:
    """Ground with a robot at each pose (N, 3): x, y (m), heading (rad); names are prefixed `0/`, `1/` and so on.

    `heights` (N,): of the soles above the ground (its highest place, where it is uneven), m. Robots let fall from
    different heights hop out of step. `rng`: of the bumps. Raises `InputError` for poses, heights and surfaces that
    cannot be.
    """
    poses_w = np.asarray(poses_w, dtype=np.float64)
    if poses_w.ndim != 2 or poses_w.shape[1] != 3 or not np.isfinite(poses_w).all():
        raise InputError(f"poses of shape {poses_w.shape}: expected finite ones of shape (N, 3)")
    above = np.zeros(len(poses_w)) if heights is None else np.asarray(heights, dtype=np.float64)
    if above.shape != (len(poses_w),) or not (above >= 0.0).all():
        raise InputError(f"heights of shape {above.shape}: expected {len(poses_w)} of at least 0 m")
    for name, value in surface._asdict().items():
        if not (0.0 <= value < math.inf) or (name in ("bump_m", "reach_m") and value == 0.0):
            raise InputError(f"surface {name} = {value!r}: expected a number above 0")
    spec = mujoco.MjSpec()
    spec.copy_during_attach = True
    apply_options(spec, timestep_s)
    if surface.uneven_m > 0.0:
        _add_bumps(spec, surface, rng)
        above = above + _DEEPEST * surface.uneven_m
    else:
        spec.worldbody.add_geom(
            name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=(0, 0, 1), contype=FLOOR_MASK, conaffinity=0
        )
    robot = bare(one_legged.spec())
    robot.geom("foot").friction[0] = surface.friction
    for k, ((x, y, heading), z) in enumerate(zip(poses_w.tolist(), above.tolist(), strict=True)):
        frame = spec.worldbody.add_frame(pos=(x, y, z), quat=(math.cos(heading / 2), 0.0, 0.0, math.sin(heading / 2)))
        spec.attach(robot, prefix=f"{k}/", frame=frame)
    return spec


def _add_bumps(spec: mujoco.MjSpec, surface: Surface, rng: np.random.Generator | None) -> None:
    """A height field about z = 0: white noise smoothed over a quarter of a bump."""
    if rng is None:
        raise InputError("uneven ground without random numbers: expected a numpy.random.Generator as rng")
    cell = surface.bump_m / _CELLS_A_BUMP
    count = max(round(2.0 * surface.reach_m / cell), 2)
    field = gaussian_filter(rng.standard_normal((count, count)), sigma=_CELLS_A_BUMP / 4)
    deep = _DEEPEST * surface.uneven_m
    field = np.clip(surface.uneven_m * field / field.std(), -deep, deep)
    spec.add_hfield(
        name="bumps", nrow=count, ncol=count, size=(surface.reach_m, surface.reach_m, 2.0 * deep, 1.0),
        userdata=((field + deep) / (2.0 * deep)).astype(np.float32).ravel(),
    )  # fmt: skip
    spec.worldbody.add_geom(
        name="floor", type=mujoco.mjtGeom.mjGEOM_HFIELD, hfieldname="bumps", pos=(0.0, 0.0, -deep), contype=FLOOR_MASK,
        conaffinity=0,
    )  # fmt: skip


def build(
    poses_w: Floats,
    heights: Sequence[float] | Floats | None = None,
    gains: Gains = GAINS,
    timestep_s: float = one_legged.TIMESTEP,
    surface: Surface = FLAT,
    imperfections: Imperfections = NONE,
    rng: np.random.Generator | None = None,
) -> Ground:
    """The robots of `specification`, compiled, with their fleet; all are told to hop on the spot.

    `rng`: of the bumps and of the imperfections' noise, one spawned for each.
    """
    bumps, noise = rng.spawn(2) if rng is not None else (None, None)
    model = specification(poses_w, heights, timestep_s, surface, bumps).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    prefixes = [f"{k}/" for k in range(len(poses_w))]
    return Ground(model, data, Fleet(model, prefixes, gains, imperfections, noise))
