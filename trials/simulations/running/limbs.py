"""The limbs of bodies with legs at the kept moments of a finished trial, for recordings and pictures.

Where they were is not kept with a trial: it is run again, which gives the same.
"""

from __future__ import annotations

from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from flocking.herding.loop import no_touching
from flocking.types import Floats
from robots import body as bodies
from trials.simulations.running import fields, loop
from trials.simulations.running.creatures import Legged
from trials.types import Trial


class Limb(NamedTuple):
    """A visible part of a body."""

    name: str
    kind: int
    """`mujoco.mjtGeom`: a sphere, capsule or cylinder."""
    radius: float
    length: float
    """m, of a capsule without its ends; 0 of a sphere."""
    rgba: NDArray[np.float32]
    link: str
    """Name of the MuJoCo body that it belongs to."""
    place: Floats
    """(3,) m in the axes of that body."""
    turn: Floats
    """(4,) likewise, a quaternion w, x, y, z."""


def limbs_of(body: str) -> list[Limb]:
    """The visible spheres, capsules and cylinders of a body."""
    model = bodies.load(body).spec().compile()
    found = []
    for g in range(model.ngeom):
        kind, (radius, half, _) = int(model.geom_type[g]), model.geom_size[g].tolist()
        if model.geom_rgba[g, 3] == 0.0 or kind not in (
            mujoco.mjtGeom.mjGEOM_SPHERE,
            mujoco.mjtGeom.mjGEOM_CAPSULE,
            mujoco.mjtGeom.mjGEOM_CYLINDER,
        ):
            continue
        found.append(
            Limb(
                model.geom(g).name,
                kind,
                radius,
                0.0 if kind == mujoco.mjtGeom.mjGEOM_SPHERE else 2.0 * half,
                model.geom_rgba[g].copy(),
                model.body(int(model.geom_bodyid[g])).name,
                model.geom_pos[g].copy(),
                model.geom_quat[g].copy(),
            )
        )
    return found


def replayed(trial: Trial, limbs: list[Limb]) -> NDArray[np.float32]:
    """(T, L, N, 7) place (m) and quaternion x, y, z, w of each limb of each creature at each kept moment."""
    creatures = loop.built(trial)
    assert isinstance(creatures, Legged)
    model, data, count = creatures.model, creatures.data, fields.group_of(trial).count
    links = np.array([[model.body(f"{k}/{limb.link}").id for k in range(count)] for limb in limbs])
    places, turns = np.array([limb.place for limb in limbs]), np.array([limb.turn for limb in limbs])
    kept: list[NDArray[np.float32]] = []

    def keep() -> None:
        mujoco.mj_kinematics(model, data)
        turn = data.xquat[links]
        centres = data.xpos[links] + _turned(turn, places[:, None])
        w, x, y, z = np.moveaxis(_product(turn, turns[:, None]), -1, 0)
        kept.append(np.concatenate([centres, np.stack([x, y, z, w], axis=-1)], axis=-1).astype(np.float32))

    loop.run(trial, creatures, no_touching(count, fields.of_trial(trial).collision_m), keep)
    return np.array(kept)


def _product(first: Floats, second: Floats) -> Floats:
    """(…, 4) the product of quaternions w, x, y, z."""
    w, v, u, t = first[..., :1], first[..., 1:], second[..., :1], second[..., 1:]
    real = w * u - (v * t).sum(axis=-1, keepdims=True)
    return np.concatenate([real, w * t + u * v + np.cross(v, t)], axis=-1)


def _turned(turn: Floats, vector: Floats) -> Floats:
    """(…, 3) a vector turned by a quaternion w, x, y, z."""
    w, v = turn[..., :1], turn[..., 1:]
    vector = np.broadcast_to(vector, v.shape)
    return vector + 2.0 * np.cross(v, np.cross(v, vector) + w * vector)
