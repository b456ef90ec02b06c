"""The kinematic herd's inner loop: any law, handed in as a function pointer, for each member in turn. Compiled.

The kernel is compiled once for all laws: it takes a law through the one signature that they share
(`flocking.lawentry.ENTRY_SIGNATURE`).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numba
import numpy as np
from numba.core import sigutils, types

from flocking.compilation import borrowing
from flocking.kinematic import arrays, detection
from flocking.kinematic.arrays import Bodies, Limits, Minds, Place, Stages
from flocking.kinematic.cells import binned, cells_of
from flocking.kinematic.mind import decide
from flocking.kinematic.motion import move
from flocking.kinematic.sight import Crowd, assemble, scratch
from flocking.kinematic.walls import shortest
from flocking.lawentry import ENTRY_SIGNATURE
from flocking.types import Floats, Ints

PAD = 0.25
"""Of the reach: how far a member may move before asynchronous members are binned anew."""

PARTS = 8
"""In which a step of asynchronous members may be done; neighbours come in the order of their cells, and the order of a
sum is its rounding: the same parts, the same numbers."""


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
    _I(_LAW, *_SHARED, _I[::1], _F[:, :, ::1], _F, _F[:, ::1], _F[:, :, ::1], _I, _I, _I[::1], _I),
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
    before: int,
    turn: Ints,
    decides_only: int,
) -> int:
    """Steps in which all members decide on the same state and then move; returns 0, or 1 if a law failed.

    `who` (n,) are the members that run the law; `draws` (steps, n, DRAWS); `motions` (N, 4) is written to. With
    `decides_only` nobody moves (groups with several laws, or a step in parts). Every `every`-th step is recorded in
    `tracks` (T, N, 5), `before` steps having been done since the last record before it. `turn` (2,) is kept at the step
    and the member at work, so that one knows whose law failed, or raised an error.
    """
    count = len(bodies.positions)
    beams = 0 if stages.detection == detection.Detection.PERFECT else detection.BEAMS
    room = scratch(count, stages.steps.shape[0], len(place.walls), beams)
    others = np.empty((count, 2))
    everybody, rows = np.arange(count), np.arange(count)
    unsorted = Crowd(bodies.positions, bodies.headings, bodies.velocities, everybody)
    sorted_ = Crowd(np.empty((count, 2)), np.empty(count), np.empty((count, 2)), everybody.copy())
    for step in range(len(draws)):
        cells = binned(bodies.positions, stages.reach, place.period)
        order = cells.members
        crowd = unsorted
        if cells.columns > 0:
            assemble(bodies, cells, sorted_)
            crowd = sorted_
            cells = cells_of(cells, everybody)
        by_cells = cells.columns > 0 and len(who) == count
        for k in range(0 if by_cells else count):
            rows[order[k] if cells.columns > 0 else k] = k
        for k in range(len(who)):
            at = order[k] if by_cells else k
            i = who[at]
            row = k if by_cells else rows[i]
            turn[0], turn[1] = step, i
            if not decide(law, i, row, stages, bodies, minds, crowd, cells, place, draws[step, at], dt, room):
                motions[i] = room.motion
                return 1
            motions[i] = room.motion
        if decides_only == 0:
            others[:] = bodies.positions
            for i in range(count):
                move(i, int(motions[i, 0]), motions[i, 1], motions[i, 2], bodies, others, limits, place, dt)
            if (before + step + 1) % every == 0:
                record(bodies, tracks[(before + step + 1) // every - 1])
    return 0


@borrowing
def part_of(count: int, reach: float) -> int:
    """Members after which asynchronous ones are binned anew in any case: a step may be done in multiples of it."""
    return (count + PARTS - 1) // PARTS if reach < math.inf else 1


@numba.njit(
    _I(_LAW, *_SHARED, _I[:, ::1], _F[:, :, ::1], _F, _F[:, ::1], _F[:, :, ::1], _I, _I, _I[::1]),
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
    before: int,
    turn: Ints,
) -> int:
    """Steps in which the members decide and move one after the other; returns 0, or 1 if a law failed.

    `order` (steps, n): who comes when; `draws` (steps, n, DRAWS) in that order. The rest as in `synchronous`.
    """
    count = len(bodies.positions)
    beams = 0 if stages.detection == detection.Detection.PERFECT else detection.BEAMS
    room = scratch(count, stages.steps.shape[0], len(place.walls), beams)
    pad = PAD * stages.reach
    block = part_of(count, stages.reach)
    crowd = Crowd(bodies.positions, bodies.headings, bodies.velocities, np.arange(count))
    for step in range(len(order)):
        cells = binned(bodies.positions, stages.reach + 2.0 * pad, place.period)
        at = bodies.positions.copy()
        for k in range(order.shape[1]):
            i = order[step, k]
            turn[0], turn[1] = step, i
            if not decide(law, i, i, stages, bodies, minds, crowd, cells, place, draws[step, k], dt, room):
                motions[i] = room.motion
                return 1
            motions[i] = room.motion
            move(i, int(motions[i, 0]), motions[i, 1], motions[i, 2], bodies, bodies.positions, limits, place, dt)
            if stages.reach < np.inf and (k + 1) % block == 0:
                # whether there are cells now or not: a step done in parts begins anew here
                cells = binned(bodies.positions, stages.reach + 2.0 * pad, place.period)
                at[:] = bodies.positions
            elif cells.columns > 0:
                dx = shortest(bodies.positions[i, 0] - at[i, 0], place.period)
                dy = shortest(bodies.positions[i, 1] - at[i, 1], place.period)
                if dx * dx + dy * dy > pad * pad:
                    cells = binned(bodies.positions, stages.reach + 2.0 * pad, place.period)
                    at[:] = bodies.positions
        if (before + step + 1) % every == 0:
            record(bodies, tracks[(before + step + 1) // every - 1])
    return 0


@numba.njit(types.void(*_SHARED[1:3], _SHARED[4], _F, _F[:, ::1]), cache=True, error_model="numpy")
def move_all(bodies: Bodies, limits: Limits, place: Place, dt: float, motions: Floats) -> None:
    """Moves everybody as decided: the second half of a synchronous step of groups with several laws."""
    others = bodies.positions.copy()
    for i in range(len(bodies.positions)):
        move(i, int(motions[i, 0]), motions[i, 1], motions[i, 2], bodies, others, limits, place, dt)
