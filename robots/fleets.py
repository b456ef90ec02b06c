"""Robots of several kinds in one world: a fleet for each kind, and which robot is which of which fleet."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from flocking.types import Bools, Floats, Ints
from robots.body import Body, CanFall, Fleet


def fleet_of(model: mujoco.MjModel, bodies: Sequence[Body], prefixes: Sequence[str]) -> Fleet:
    """All robots of a compiled world, robot k of kind `bodies[k]` with its names prefixed by `prefixes[k]`.

    Where all are of one kind, this is that kind's own fleet.
    """
    members: dict[str, list[int]] = {}
    for number, body in enumerate(bodies):
        members.setdefault(body.name, []).append(number)
    fleets = [bodies[of[0]].fleet(model, [prefixes[number] for number in of]) for of in members.values()]
    if len(fleets) == 1:
        return fleets[0]
    return MixedFleet(fleets, [np.array(of, dtype=np.int64) for of in members.values()])


def fallen_at(fleet: Fleet) -> Floats | None:
    """(N,) s, when each robot fell; nan = it is upright. None where no robot of the fleet can fall."""
    if isinstance(fleet, CanFall):
        return fleet.fallen_at
    if not isinstance(fleet, MixedFleet) or not any(isinstance(part, CanFall) for part in fleet.fleets):
        return None
    fallen = np.full(len(fleet.root_bodies), np.nan)
    for part, of in zip(fleet.fleets, fleet.numbers, strict=True):
        if isinstance(part, CanFall):
            fallen[of] = part.fallen_at
    return fallen


def _rows(numbers: Ints) -> Ints | slice:
    """These rows of an array: as a slice where they follow one another, which NumPy fills in a third of the time."""
    first, count = int(numbers[0]), len(numbers)
    return slice(first, first + count) if (np.diff(numbers) == 1).all() else numbers


class MixedFleet:
    """Several fleets as one: robot `numbers[f][i]` of the world is robot i of fleet f."""

    def __init__(self, fleets: Sequence[Fleet], numbers: Sequence[Ints]) -> None:
        self.fleets, self.numbers = tuple(fleets), tuple(_rows(of) for of in numbers)
        count = sum(len(of) for of in numbers)
        self.root_bodies: Ints = np.zeros(count, dtype=np.int64)
        self._place: list[tuple[Fleet, int]] = [(fleets[0], 0)] * count
        for fleet, of in zip(fleets, numbers, strict=True):
            self.root_bodies[of] = fleet.root_bodies
            for index, number in enumerate(of.tolist()):
                self._place[number] = fleet, index

    def command(self, k: int, speed: float, turn_rate: float) -> None:
        fleet, index = self._place[k]
        fleet.command(index, speed, turn_rate)

    def before_step(self, data: mujoco.MjData) -> None:
        for fleet in self.fleets:
            fleet.before_step(data)

    def after_step(self, data: mujoco.MjData) -> bool:
        pressed = False
        for fleet in self.fleets:
            pressed |= fleet.after_step(data)
        return pressed

    def poses(self, data: mujoco.MjData) -> Floats:
        poses = np.empty((len(self._place), 3))
        for fleet, of in zip(self.fleets, self.numbers, strict=True):
            poses[of] = fleet.poses(data)
        return poses

    def velocities(self, data: mujoco.MjData) -> Floats:
        velocities = np.empty((len(self._place), 2))
        for fleet, of in zip(self.fleets, self.numbers, strict=True):
            velocities[of] = fleet.velocities(data)
        return velocities

    @property
    def odometry(self) -> Floats:
        odometry = np.empty((len(self._place), 3))
        for fleet, of in zip(self.fleets, self.numbers, strict=True):
            odometry[of] = fleet.odometry
        return odometry

    @property
    def bumpers(self) -> Bools:
        bumpers = np.empty((len(self._place), 2), dtype=np.bool_)
        for fleet, of in zip(self.fleets, self.numbers, strict=True):
            bumpers[of] = fleet.bumpers
        return bumpers

    def own(self, k: int, motion: Floats, contacts: Bools) -> None:
        fleet, index = self._place[k]
        fleet.own(index, motion, contacts)

    def meant(self, k: int, motion: Floats) -> None:
        fleet, index = self._place[k]
        fleet.meant(index, motion)

    def meant_pose(self, k: int) -> Floats:
        fleet, index = self._place[k]
        return fleet.meant_pose(index)

    def counted_pose(self, k: int) -> Floats:
        fleet, index = self._place[k]
        return fleet.counted_pose(index)
