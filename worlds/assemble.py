"""Walls and robots made into one MuJoCo model."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import mujoco
import numpy as np

from flocking.parameters import filled
from flocking.types import Floats, Ints
from robots import body, physics, touching
from robots.body import Body, Fleet
from robots.fleets import fleet_of
from worlds import known
from worlds.standing import Standing, add_standing
from worlds.walls import Walls, add_walls, walls_of

NEVER = -(10**9)
"""Tick of the last touch of a pair that has not touched yet."""
_NEW_CONTACTS = 256
NONE_STANDING: Floats = np.empty((0, 4))
FEW_WALLS = 16
"""Up to so many boxes each robot is held against each; more are kept in MuJoCo's tree of bounding boxes. A choice: with
742 boxes the tree takes a third of the time."""


@dataclass
class World:
    """A compiled world with its robots; the only mutable thing in a trial besides the robots' minds."""

    model: mujoco.MjModel
    """What is stepped: robots without their looks."""
    data: mujoco.MjData
    fleet: Fleet
    """All robots, of one kind or of several."""
    bodies: tuple[Body, ...]
    """Of each robot."""
    walls: Walls
    names: tuple[str, ...]
    free_length: float
    """How far from the origin a robot may get along x before it could meet an end, m."""
    _owners: Ints
    _last_touch: Ints
    _began: Floats
    _release: int
    _poses_w: Floats
    """(N, 3) at the start."""
    standing: Standing
    """The walls that can stand or not."""
    contacts: list[tuple[float, ...]] = field(default_factory=list)
    """One row for each touch that began: time, robot, other (−1 = a wall), x, y."""
    observers: list[Callable[[mujoco.MjData], None]] = field(default_factory=list)
    """Called after every step: sensors that need to know how the robots moved."""
    tick: int = 0

    @cached_property
    def whole(self) -> mujoco.MjModel:
        """The model with all that can be seen, for lasers and viewers.

        Bodies, joints and actuators have the numbers that they have in `model`, so that places in `data.qpos` are the
        same; geoms and sites have not.
        """
        return self.seen()

    def seen(self) -> mujoco.MjModel:
        """The same, made anew, for cameras, which change it."""
        return specification(
            self.walls, self.bodies, self.names, self._poses_w, self.model.opt.timestep, self.standing.segments
        ).compile()

    @property
    def standing_w(self) -> Floats:
        """(W, 4) all walls that stand now: segments x0, y0, x1, y1, m."""
        up = self.standing.up
        stand = len(up) > 0 and up.any()
        return np.concatenate([self.walls.all, self.standing.segments[up]]) if stand else self.walls.all

    def advance(self, to: int) -> None:
        """Steps physics until tick `to`: wheel ramps before every step, encoders and contacts after it."""
        model, data, fleet, step = self.model, self.data, self.fleet, mujoco.mj_step
        while self.tick < to:
            fleet.before_step(data)
            step(model, data)
            pressed = fleet.after_step(data)
            self.tick += 1
            if pressed:
                self._note_touches()
            for observe in self.observers:
                observe(data)

    def _note_touches(self) -> None:
        contact, data = self.data.contact, self.data
        count = touching.begun(
            contact.geom, contact.pos, contact.efc_address, data.efc_force, self._owners, self._last_touch,
            self.tick, self._release, self._began,
        )  # fmt: skip
        if count:
            self.contacts += [(data.time, *row) for row in self._began[:count].tolist()]


def build(
    world: str,
    world_parameters: Mapping[str, Any],
    bodies: Sequence[str],
    names: Sequence[str],
    poses_w: Floats,
    timestep_s: float,
    world_text: str = "",
    standing_w: Floats = NONE_STANDING,
) -> World:
    """The world of that name with a robot of the body `bodies[k]`, called `names[k]`, at each pose (N, 3).

    `world_text`: of the file of a world of the user's own, whose name is then its path; read there if it is not given.
    `standing_w`: (K, 4) walls that can rise and vanish; none of them stands. Raises `InputError` for an unknown world,
    body or parameter.
    """
    kinds = tuple(body.load(name) for name in bodies)
    its = known.load(world, world_text)
    parameters = filled(its.parameters, world_parameters, prefix="world.")
    walls = walls_of(its.environment(parameters))
    model = specification(walls, kinds, names, poses_w, timestep_s, standing_w, looks=False).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    fleet = fleet_of(model, kinds, [prefix(name) for name in names])
    return World(
        model=model,
        data=data,
        fleet=fleet,
        bodies=kinds,
        walls=walls,
        names=tuple(names),
        free_length=its.free_length(parameters, max(kind.radius for kind in kinds)),
        _owners=_geom_owners(model, fleet.root_bodies),
        _last_touch=np.full((len(names), len(names) + 1), NEVER, dtype=np.int64),
        _began=np.empty((_NEW_CONTACTS, 4)),
        _release=round(touching.APART_S / timestep_s),
        _poses_w=poses_w.copy(),
        standing=Standing(model, standing_w),
    )


def prefix(name: str) -> str:
    """What stands before the names of a robot's parts in the model."""
    return f"{name}/"


def specification(
    walls: Walls,
    kinds: Sequence[Body],
    names: Sequence[str],
    poses_w: Floats,
    timestep_s: float,
    standing_w: Floats = NONE_STANDING,
    looks: bool = True,
) -> mujoco.MjSpec:
    """Floor, walls and robots as an editable specification; without `looks` only what physics needs of the robots."""
    spec = mujoco.MjSpec()
    spec.copy_during_attach = True
    spec.modelname = "herd"
    physics.apply_options(spec, timestep_s)
    spec.worldbody.add_light(pos=[0.0, 0.0, 6.0], dir=[0.0, 0.0, -1.0])
    spec.worldbody.add_geom(
        name="floor",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[0.0, 0.0, 1.0],
        contype=physics.FLOOR_MASK,
        conaffinity=0,
        rgba=[0.92, 0.92, 0.9, 1.0],
    )
    add_walls(spec, walls)
    add_standing(spec, standing_w, walls.reflectance)
    if len(walls.all) > FEW_WALLS:
        spec.option.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_MIDPHASE)
    robots = {name: kind.spec() for name, kind in {kind.name: kind for kind in kinds}.items()}
    if not looks:
        robots = {name: physics.bare(robot) for name, robot in robots.items()}
    for kind, name, (x, y, heading) in zip(kinds, names, poses_w, strict=True):
        frame = spec.worldbody.add_frame(pos=[x, y, 0.0], quat=[math.cos(heading / 2), 0.0, 0.0, math.sin(heading / 2)])
        spec.attach(robots[kind.name], prefix=prefix(name), frame=frame)
    physics.take_servos_implicitly(spec)
    return spec


def _geom_owners(model: mujoco.MjModel, roots: Ints) -> Ints:
    """For each geom the robot that it is the hull of, the number of robots for walls, else `UNOWNED`."""
    owners = np.full(model.ngeom, touching.UNOWNED, dtype=np.int64)
    robots = {int(root): k for k, root in enumerate(roots)}
    for geom in range(model.ngeom):
        if not (model.geom_contype[geom] | model.geom_conaffinity[geom]) & physics.HULL_MASK:
            continue
        root = int(model.body_rootid[model.geom_bodyid[geom]])
        owners[geom] = robots.get(root, len(robots))
    return owners
