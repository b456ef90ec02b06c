"""What the publication's robots do not have (Hodgins and Brogan 1994, section 5): weak motors, noise and delay.

All are off by default. Noise is normal, without a bias, and new at each physics step.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from flocking.errors import InputError
from flocking.types import Floats


class Imperfections(NamedTuple):
    """Of the motors of a fleet, and of what its controllers read."""

    torque_n_m: float = math.inf
    """N m, the most that a motor of the hip gives."""
    velocity_m_s: float = 0.0
    """m/s, standard deviation of each component of the body's velocity."""
    angle_rad: float = 0.0
    """rad, of pitch, roll and heading, and of the hip's three angles."""
    rate_rad_s: float = 0.0
    """rad/s, of the body's turn rates, and of the hip's."""
    delay_s: float = 0.0
    """s, from the state that is read to the torques that answer it; a whole number of steps."""


def check(given: Imperfections, timestep_s: float, rng: np.random.Generator | None) -> None:
    """Raises `InputError` for negative numbers, a delay that is no whole number of steps, and noise without `rng`."""
    for name, value in given._asdict().items():
        if not value >= 0.0 or (name != "torque_n_m" and not math.isfinite(value)):
            raise InputError(f"{name} = {value!r}: expected a number of at least 0")
    steps = given.delay_s / timestep_s
    if abs(steps - round(steps)) > 1e-6:
        nearest = round(steps) * timestep_s
        raise InputError(f"delay_s = {given.delay_s:g}: expected a multiple of {timestep_s:g} s, such as {nearest:g}")
    if _noisy(given) and rng is None:
        raise InputError("noise without random numbers: expected a numpy.random.Generator as rng")


def _noisy(given: Imperfections) -> bool:
    return given.velocity_m_s > 0.0 or given.angle_rad > 0.0 or given.rate_rad_s > 0.0


class Senses:
    """What the controllers of a fleet read in place of the true state."""

    def __init__(self, given: Imperfections, each: Any, timestep_s: float, rng: np.random.Generator | None) -> None:
        """each (N,): with `root` and `joints` in qpos, `speed` and `rates` in qvel."""
        check(given, timestep_s, rng)
        self.given, self.rng, self.delay = given, rng, round(given.delay_s / timestep_s)
        self.acts = self.delay > 0 or _noisy(given)
        """Whether what is read differs from the true state."""
        self._past: list[tuple[Floats, Floats, Floats]] = []
        self._quaternions = each["root"][:, None] + np.arange(3, 7)
        self._velocities = each["speed"][:, None] + np.arange(3)
        self._turns = each["speed"][:, None] + np.arange(3, 6)
        self._hips, self._hip_rates = each["joints"][:, :3], each["rates"][:, :3]

    def read(self, qpos: Floats, qvel: Floats, pushed: Floats) -> tuple[Floats, Floats, Floats]:
        """Positions, velocities and forces of contacts, (nq,), (nv,), (nv,), as the controllers have them now."""
        self._past.append((qpos.copy(), qvel.copy(), pushed.copy()))
        if len(self._past) > self.delay + 1:
            self._past.pop(0)
        if not _noisy(self.given):
            return self._past[0]
        qpos, qvel = self._past[0][0].copy(), self._past[0][1].copy()
        assert self.rng is not None
        noise = self.rng.standard_normal((5, len(self._hips), 3))
        qvel[self._velocities] += self.given.velocity_m_s * noise[0]
        qvel[self._turns] += self.given.rate_rad_s * noise[1]
        qvel[self._hip_rates] += self.given.rate_rad_s * noise[2]
        qpos[self._hips] += self.given.angle_rad * noise[3]
        qpos[self._quaternions] = _turned(qpos[self._quaternions], self.given.angle_rad * noise[4])
        return qpos, qvel, self._past[0][2]


def _turned(quaternions: Floats, by: Floats) -> Floats:
    """(N, 4) unit quaternions, turned about the bodies' own axes by small angles (N, 3), rad."""
    w, v = quaternions[:, :1], quaternions[:, 1:]
    half = 0.5 * by
    turned = np.hstack([w - np.sum(v * half, axis=1, keepdims=True), v + w * half + np.cross(v, half)])
    unit: Floats = turned / np.linalg.norm(turned, axis=1, keepdims=True)
    return unit
