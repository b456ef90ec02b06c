"""Small worlds for lasers, built without robots/ or worlds/."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import mujoco
import numpy as np
import pytest

RADIUS = 0.15
HEIGHT = 0.18
RETRO = (0.3, 300.0)
WHITE = (0.8, 0.0)


class Arena(NamedTuple):
    """A compiled world with robots at given poses."""

    model: mujoco.MjModel
    data: mujoco.MjData
    sites: list[str]
    roots: list[int]

    def put(self, k: int, x: float, y: float, heading: float) -> None:
        """Robot k to a pose, without kinematics: nothing derived follows yet."""
        address = self.model.jnt_qposadr[self.model.body_jntadr[self.roots[k]]]
        self.data.qpos[address : address + 7] = [x, y, 0.0, np.cos(heading / 2), 0.0, 0.0, np.sin(heading / 2)]


def build(
    robots: Sequence[tuple[float, float, float]],
    walls: Sequence[tuple[float, float, float, float, float]] = (),
    mount: tuple[float, float, float] = (0.1, 0.0, 0.0),
    edit: Callable[[mujoco.MjSpec], None] | None = None,
) -> Arena:
    """Robots (x, y, heading) and walls (x, y, angle, half length, half thickness); `edit` may add to the spec."""
    spec = mujoco.MjSpec()
    spec.option.timestep = 0.01
    spec.nuser_geom = 2
    spec.worldbody.add_geom(name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[10, 10, 1])
    for j, (x, y, angle, length, thickness) in enumerate(walls):
        spec.worldbody.add_geom(
            name=f"wall-{j}", type=mujoco.mjtGeom.mjGEOM_BOX, pos=[x, y, 1.0], size=[length, thickness, 1.0],
            quat=[np.cos(angle / 2), 0, 0, np.sin(angle / 2)], userdata=WHITE,
        )  # fmt: skip
    for k in range(len(robots)):
        add_robot(spec, f"robot-{k}", mount)
    if edit is not None:
        edit(spec)
    model = spec.compile()
    sites = [f"robot-{k}/laser" for k in range(len(robots))]
    arena = Arena(model, mujoco.MjData(model), sites, [model.body(f"robot-{k}").id for k in range(len(robots))])
    for k, pose in enumerate(robots):
        arena.put(k, *pose)
    return arena


def add_robot(spec: mujoco.MjSpec, name: str, mount: tuple[float, float, float]) -> None:
    """A robot with a hull, two wheels and a reflective cylinder around its laser."""
    x, y, heading = mount
    base = spec.worldbody.add_body(name=name)
    base.add_freejoint()
    cylinder = mujoco.mjtGeom.mjGEOM_CYLINDER
    base.add_geom(name=f"{name}/hull", type=cylinder, size=[0.165, 0.04, 0], pos=[0, 0, 0.05], mass=3.0)
    base.add_geom(name=f"{name}/skin", type=cylinder, size=[RADIUS, 0.08, 0], pos=[0, 0, HEIGHT], userdata=RETRO)
    turn = [np.cos(heading / 2), 0, 0, np.sin(heading / 2)]
    base.add_site(name=f"{name}/laser", pos=[x, y, HEIGHT], quat=turn)
    for side in (-0.13, 0.13):
        wheel = base.add_body(pos=[0, side, 0.033])
        wheel.add_joint(axis=[0, 1, 0])
        wheel.add_geom(type=mujoco.mjtGeom.mjGEOM_ELLIPSOID, size=[0.033, 0.012, 0.033], mass=0.1)


@pytest.fixture(scope="session")
def arena() -> Callable[..., Arena]:
    """`arena(robots, walls=…, mount=…, edit=…)` builds an `Arena`."""
    return build
