"""The kinematic herd's inner loop: any law, handed in as a function pointer, for each member in turn. Compiled.

The kernel is compiled once for all laws: it takes a law through the one signature that they share
(`flocking.lawentry.ENTRY_SIGNATURE`).
"""

from __future__ import annotations

from collections.abc import Callable

import numba
import numpy as np
from numba.core import sigutils, types

from flocking.compilation import borrowing
from flocking.kinematic import arrays, detection
from flocking.kinematic.arrays import Bodies, Limits, Minds, Place, Stages
from flocking.kinematic.cells import binned
from flocking.kinematic.mind import decide, scratch
from flocking.kinematic.motion import move
from flocking.kinematic.walls import shortest
from flocking.lawentry import ENTRY_SIGNATURE
from flocking.types import Floats, Ints

PAD = 0.25
"""Of the reach: how far a member may move before asynchronous members are binned anew."""


@borrowing
def record(bodies: Bodies, track: Floats) -> None:
    """Writes x, y, heading and velocity of all members into `track` (N, 5)."""
    for i in range(len(bodies.positions)):
        track[i, 0], track[i, 1] = bodies.positions[i, 0], bodies.positions[i, 1]
        track[i, 2] = bodies.headings[i]
        track[i, 3], track[i, 4] = bodies.velocities[i, 0], bodies.velocities[i, 1]


_LAW = types.FunctionType(sigutils._parse_signature_string(ENTRY_SIGNATURE))
_SHARED = tuple(
    numba.typeof(value)
    for value in (
        arrays.example_stages(),
        arrays.example_bodies(),
        arrays.example_limits(),
        arrays.example_minds(),
        arrays.example_place(),
    )
)
_F, _I = types.float64, types.int64


@numba.njit(
    _I(_LAW, *_SHARED, _I[::1], _F[:, :, ::1], _F, _F[:, ::1], _F[:, :, ::1], _I, _I),
    cache=True,
    error_model="numpy",
)
def synchronous(
    law: Callable[..., None],
    stages: Stages,
    bodies: Bodies,
    limits: Limits,
    minds: Minds,
    place: Place,
    who: Ints,
    draws: Floats,
    dt: float,
    motions: Floats,
    tracks: Floats,
    every: int,
    decides_only: int,
) -> int:
    """Steps in which all members decide on the same state and then move; returns −1, or who failed.

    `who` (n,) are the members that run the law; `draws` (steps, n, DRAWS); `motions` (N, 4) is written to. With
    `decides_only` nobody moves (groups with several laws). Every `every`-th step is recorded in `tracks` (T, N, 5).
    A failure is returned as step · N + member.
    """
    count = len(bodies.positions)
    beams = 0 if stages.detection == detection.Detection.PERFECT else detection.BEAMS
    room = scratch(count, stages.steps.shape[0], len(place.walls), beams)
    others = np.empty((count, 2))
    for step in range(len(draws)):
        cells = binned(bodies.positions, stages.reach, place.period)
        for k in range(len(who)):
            # cell by cell, so that what is near in space is near in memory
            at = cells.members[k] if cells.columns > 0 and len(who) == count else k
            i = who[at]
            if not decide(law, i, stages, bodies, minds, cells, place, draws[step, at], dt, room):
                motions[i] = room.motion
                return step * count + i
            motions[i] = room.motion
        if decides_only == 0:
            others[:] = bodies.positions
            for i in range(count):
                move(i, int(motions[i, 0]), motions[i, 1], motions[i, 2], bodies, others, limits, place, dt)
            if (step + 1) % every == 0:
                record(bodies, tracks[(step + 1) // every - 1])
    return -1


@numba.njit(
    _I(_LAW, *_SHARED, _I[:, ::1], _F[:, :, ::1], _F, _F[:, ::1], _F[:, :, ::1], _I),
    cache=True,
    error_model="numpy",
)
def asynchronous(
    law: Callable[..., None],
    stages: Stages,
    bodies: Bodies,
    limits: Limits,
    minds: Minds,
    place: Place,
    order: Ints,
    draws: Floats,
    dt: float,
    motions: Floats,
    tracks: Floats,
    every: int,
) -> int:
    """Steps in which the members decide and move one after the other; returns −1, or who failed.

    `order` (steps, n): who comes when; `draws` (steps, n, DRAWS) in that order. The rest as in `synchronous`.
    """
    count = len(bodies.positions)
    beams = 0 if stages.detection == detection.Detection.PERFECT else detection.BEAMS
    room = scratch(count, stages.steps.shape[0], len(place.walls), beams)
    pad = PAD * stages.reach
    for step in range(len(order)):
        cells = binned(bodies.positions, stages.reach + 2.0 * pad, place.period)
        at = bodies.positions.copy()
        for k in range(order.shape[1]):
            i = order[step, k]
            if not decide(law, i, stages, bodies, minds, cells, place, draws[step, k], dt, room):
                motions[i] = room.motion
                return step * count + i
            motions[i] = room.motion
            move(i, int(motions[i, 0]), motions[i, 1], motions[i, 2], bodies, bodies.positions, limits, place, dt)
            if cells.columns > 0:
                dx = shortest(bodies.positions[i, 0] - at[i, 0], place.period)
                dy = shortest(bodies.positions[i, 1] - at[i, 1], place.period)
                if dx * dx + dy * dy > pad * pad:
                    cells = binned(bodies.positions, stages.reach + 2.0 * pad, place.period)
                    at[:] = bodies.positions
        if (step + 1) % every == 0:
            record(bodies, tracks[(step + 1) // every - 1])
    return -1


@numba.njit(types.void(*_SHARED[1:3], _SHARED[4], _F, _F[:, ::1]), cache=True, error_model="numpy")
def move_all(bodies: Bodies, limits: Limits, place: Place, dt: float, motions: Floats) -> None:
    """Moves everybody as decided: the second half of a synchronous step of groups with several laws."""
    others = bodies.positions.copy()
    for i in range(len(bodies.positions)):
        move(i, int(motions[i, 0]), motions[i, 1], motions[i, 2], bodies, others, limits, place, dt)
