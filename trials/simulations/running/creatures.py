"""The creatures of a running herd, point masses and bodies with legs, each driven step by step by the same law.

Metres, seconds; world frame.
"""

from __future__ import annotations

from typing import Any, Protocol

import mujoco
import numpy as np

from flocking.herding import HerdMind, MovingHerd
from flocking.herding.loop import Touching
from flocking.types import Bools, Floats
from robots.physics import DivergedError, check_sound
from trials.simulations.running.disturbances import Pushes

NOTED_EVERY_S = 0.02
"""From one look at who touches whom to the next: two that pass at 2 m/s come 4 cm nearer. A choice."""


class Creatures(Protocol):
    """N of them, at work."""

    @property
    def mind(self) -> HerdMind:
        """Theirs."""

    def advance(self, first: int, draws: Floats, touching: Touching) -> None:
        """Steps from the one of that number on, from 0; `draws` (steps, N, DRAWS).

        Raises `LawFailedError` and `DivergedError`.
        """

    def poses(self) -> Floats:
        """(N, 3) x, y and heading now."""

    @property
    def fallen_at(self) -> Floats:
        """(N,) s when each fell; nan = it did not."""

    @property
    def causes(self) -> tuple[str, ...]:
        """(N,) why it did; empty = it did not."""


class Particles:
    """Point masses: the desired velocity is theirs from the next step on, and nothing makes them fall."""

    def __init__(self, mind: MovingHerd, dt: float) -> None:
        self.mind, self._moving, self.dt = mind, mind, dt

    def advance(self, first: int, draws: Floats, touching: Touching) -> None:
        """See `Creatures`."""
        self._moving.advance(draws, first, self.dt, touching, max(1, round(NOTED_EVERY_S / self.dt)))

    def poses(self) -> Floats:
        """See `Creatures`."""
        return np.column_stack([self.mind.herd.positions, self.mind.herd.headings])

    @property
    def fallen_at(self) -> Floats:
        """See `Creatures`."""
        return np.full(len(self.mind.there), np.nan)

    @property
    def causes(self) -> tuple[str, ...]:
        """See `Creatures`."""
        return ("",) * len(self.mind.there)


class Legged:
    """Bodies with legs in one MuJoCo world: the law runs for each in flight, and its desired velocity is its command.

    Who has fallen lies where it fell, decides nothing and is not seen.
    """

    def __init__(self, mind: HerdMind, built: Any, dt: float, pushes: Pushes) -> None:
        """`built`: the robots on their ground, as its `build` makes them. Actual velocities are those last seen in
        flight."""
        self.mind, self.dt, self.pushes, self._pushed = mind, dt, pushes, 0
        self.model, self.data, self.fleet = built.model, built.data, built.fleet
        roots = self.fleet.root_bodies
        joints = self.model.body_jntadr[roots]
        self._places = self.model.jnt_qposadr[joints][:, None] + np.arange(2)
        self.data.qvel[self.model.jnt_dofadr[joints][:, None] + np.arange(2)] = mind.herd.desired
        mujoco.mj_forward(self.model, self.data)
        self._flying: Bools = np.zeros(len(mind.there), np.bool_)
        self._noted_every = max(1, round(NOTED_EVERY_S / dt))
        self.fleet.desire_all(mind.herd.desired)

    def advance(self, first: int, draws: Floats, touching: Touching) -> None:
        """See `Creatures`."""
        mind, fleet, data, model = self.mind, self.fleet, self.data, self.model
        herd = mind.herd
        for step in range(first, first + len(draws)):
            fleet.look(data, herd.positions, herd.actual, self._flying)
            mind.decide(self._flying, draws[step - first], self.dt, step)
            fleet.desire_limited(herd.desired)
            if self._pushed < len(self.pushes.steps):
                self._push(step)
            fleet.before_step(data)
            mujoco.mj_step(model, data)
            fleet.after_step(data)
            if step % self._noted_every == 0:
                mind.there[:] = fleet.upright
                mind.touches(touching, step * self.dt)
        herd.positions[:] = data.qpos[self._places]
        try:
            check_sound(data)
        except DivergedError:  # its clock may have begun anew
            at = (first + len(draws)) * self.dt
            raise DivergedError(f"the physics of the creatures diverged before {at:g} s") from None

    def _push(self, step: int) -> None:
        """Pushes whom this step's pushes are for."""
        while self._pushed < len(self.pushes.steps) and self.pushes.steps[self._pushed] <= step:
            self.fleet.push(self.data, int(self.pushes.robots[self._pushed]), self.pushes.impulses_w[self._pushed])
            self._pushed += 1

    def poses(self) -> Floats:
        """See `Creatures`."""
        found: Floats = self.fleet.poses(self.data)
        return found

    @property
    def fallen_at(self) -> Floats:
        """See `Creatures`."""
        found: Floats = self.fleet.fallen_at
        return found

    @property
    def causes(self) -> tuple[str, ...]:
        """See `Creatures`."""
        found: tuple[str, ...] = self.fleet.causes
        return found
