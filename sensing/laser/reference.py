"""The same beams through MuJoCo's own rays: slow, without assumptions, the measure of the planar laser."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

import mujoco
import numpy as np

from flocking.errors import InputError
from flocking.types import Floats, Ints
from sensing.laser.hokuyo import ANGLES, BEAMS, MAX_RANGE_M, Lasers
from sensing.laser.slice import geom_name, owner_of

HIDDEN_GROUP = 5
"""Geom group that takes the robot's own geoms out of the rays' sight while a scan is cast."""
DISTANT_M = 0.01
"""A beam that differs by more is counted by `compare`."""


class Rays:
    """Lasers through `mj_multiRay`, in the true (leaning) plane of each; same arguments as `hokuyo.Lasers`.

    `bodyexclude` of MuJoCo takes out one body only, so a robot's own wheels would still be hit: instead all geoms
    beneath its root change into a group of geoms that the rays ignore, for the duration of a cast. One thread only.
    """

    def __init__(self, model: mujoco.MjModel, sites: Sequence[str], roots: Sequence[int]) -> None:
        """Raises InputError where a geom already stands in the group that hides."""
        self._model = model
        for geom in np.flatnonzero(model.geom_group == HIDDEN_GROUP):
            raise InputError(
                f"{geom_name(model, int(geom))} is in geom group {HIDDEN_GROUP}: expected a group of 0 to 4"
            )
        self._sites = [int(model.site(name).id) for name in sites]
        bodies = [owner_of(model, body, roots) for body in range(model.nbody)]
        owners = np.array(bodies)[model.geom_bodyid]
        self._own = [np.flatnonzero(owners == k) for k in range(len(roots))]
        self._groups = np.array([1, 1, 1, 1, 1, 0], dtype=np.uint8)
        self._local = np.stack([np.cos(ANGLES), np.sin(ANGLES), np.zeros(BEAMS)], axis=1)
        self._distances = np.empty(BEAMS)
        self._geoms = np.empty(BEAMS, dtype=np.int32)
        self._normals = np.empty(3 * BEAMS)

    @contextmanager
    def _hidden(self, k: int) -> Iterator[None]:
        """Robot k's own geoms are not hit inside this context."""
        own = self._own[k]
        before = self._model.geom_group[own].copy()
        self._model.geom_group[own] = HIDDEN_GROUP
        try:
            yield
        finally:
            self._model.geom_group[own] = before

    def cast(self, data: mujoco.MjData, k: int) -> tuple[Floats, Ints]:
        """Distances (B,) of laser k's beams, m, inf = nothing within 5.6 m, and the id of the geom hit, −1 = none.

        A laser inside a geom is covered by it: distance 0. Bodies stand where `data.qpos` puts them.
        """
        mujoco.mj_kinematics(self._model, data)
        site = self._sites[k]
        directions = self._local @ np.asarray(data.site_xmat[site]).reshape(3, 3).T
        with self._hidden(k):
            mujoco.mj_multiRay(
                self._model, data, data.site_xpos[site], directions.ravel(), self._groups, True, -1,
                self._geoms, self._distances, self._normals, BEAMS, MAX_RANGE_M,
            )  # fmt: skip
        distances, geoms = self._distances.copy(), self._geoms.astype(np.int64)
        leaving = np.einsum("ij,ij->i", directions, self._normals.reshape(-1, 3)) > 0.0
        distances[leaving & (geoms >= 0)] = 0.0
        lost = (geoms < 0) | (distances > MAX_RANGE_M)
        distances[lost], geoms[lost] = math.inf, -1
        return distances, geoms


class Comparison(NamedTuple):
    """The planar laser against MuJoCo's rays, over all lasers of one model in one pose."""

    beams: int
    distant: int
    """Beams that differ by more than 1 cm, or of which only one hits something."""
    largest_m: float
    """Largest difference where both hit."""


def difference(planar: Floats, rays: Floats) -> Floats:
    """(B,) absolute difference of two scans' distances, m; 0 where neither hits, inf where only one does."""
    both = np.isfinite(planar) & np.isfinite(rays)
    out = np.where(np.isfinite(planar) == np.isfinite(rays), 0.0, math.inf)
    out[both] = abs(planar[both] - rays[both])
    return out


def compare(lasers: Lasers, rays: Rays, data: mujoco.MjData) -> Comparison:
    """Cast every laser both ways and compare the distances."""
    joined = np.concatenate(
        [difference(lasers.cast(data, k)[0], rays.cast(data, k)[0]) for k in range(len(lasers.roots))]
    )
    finite = joined[np.isfinite(joined)]
    return Comparison(
        beams=len(joined), distant=int(np.sum(joined > DISTANT_M)), largest_m=float(finite.max(initial=0.0))
    )
