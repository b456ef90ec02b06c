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

from flocking.compilation import borrowing, compiled_for
from flocking.kinematic import arrays
from flocking.kinematic.arrays import Bodies, HerdArrays, Stages, Tracks
from flocking.kinematic.cells import binned, cells_of
from flocking.kinematic.mind import decide
from flocking.kinematic.motion import move
from flocking.kinematic.sight import Crowd, assemble, scratch
from flocking.kinematic.walls import shortest
from flocking.lawentry import ENTRY_SIGNATURE
from flocking.types import Floats, Ints

PAD = 0.25
"""Part of the reach that an asynchronous member may move before all are binned anew."""

PARTS = 8
"""An asynchronous step bins its members anew after each of so many parts. Neighbours come in the order of their cells,
and the order of a sum decides its rounding: with fixed parts the numbers are the same wherever a step is cut."""


@borrowing
def record(bodies: Bodies, row: Floats) -> None:
    """Writes x, y, heading and velocity of all members into `row` (N, 5)."""
    for i in range(len(bodies.positions)):
        row[i, 0], row[i, 1] = bodies.positions[i, 0], bodies.positions[i, 1]
        row[i, 2] = bodies.headings[i]
        row[i, 3], row[i, 4] = bodies.velocities[i, 0], bodies.velocities[i, 1]


@borrowing
def keep_step(bodies: Bodies, tracks: Tracks, step: int) -> None:
    """Records the step of that number (from 0) of a piece of work, if it is one of those that are kept."""
    done = tracks.before + step + 1
    if done % tracks.every == 0:
        record(bodies, tracks.rows[done // tracks.every - 1])


_LAW = types.FunctionType(sigutils._parse_signature_string(ENTRY_SIGNATURE))
_STAGES, _HERD, _TRACKS = (
    numba.typeof(example()) for example in (arrays.example_stages, arrays.example_herd, arrays.example_tracks)
)
_F, _I = types.float64, types.int64


@compiled_for(types.void(_HERD))
def move_all(herd: HerdArrays) -> None:
    """Moves everybody as decided: the second half of a synchronous step."""
    others = herd.bodies.positions.copy()
    for i in range(len(others)):
        move(i, herd, others)


@compiled_for(_I(_LAW, _STAGES, _HERD, _I[::1], _F[:, :, ::1], _TRACKS, _I[::1], _I))
def synchronous(
    law: Callable[..., None],
    stages: Stages,
    herd: HerdArrays,
    who: Ints,
    draws: Floats,
    tracks: Tracks,
    turn: Ints,
    decides_only: int,
) -> int:
    """Steps in which all members decide on the same state and then move; returns 0, or 1 if a law failed.

    `who` (n,) are the members that run the law; `draws` (steps, n, DRAWS). With `decides_only` nobody moves and nothing
    is recorded (herds with several laws, or a step in parts). `turn` (2,) holds the step and the member at work, both
    from 0: they tell whose law failed or raised an error.
    """
    bodies, motions = herd.bodies, herd.motions
    count = len(bodies.positions)
    room = scratch(count, stages, len(herd.place.walls))
    everybody, rows = np.arange(count), np.arange(count)
    unsorted = Crowd(bodies.positions, bodies.headings, bodies.velocities, everybody)
    sorted_ = Crowd(np.empty((count, 2)), np.empty(count), np.empty((count, 2)), everybody.copy())
    for step in range(len(draws)):
        cells = binned(bodies.positions, stages.reach, herd.place.period)
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
            sound = decide(law, i, row, stages, herd, crowd, cells, draws[step, at], room)
            motions[i] = room.motion
            if not sound:
                return 1
        if decides_only == 0:
            move_all(herd)
            keep_step(bodies, tracks, step)
    return 0


@borrowing
def part_of(count: int, reach: float) -> int:
    """Members after which asynchronous ones are binned anew in any case: a step may be done in multiples of it."""
    return (count + PARTS - 1) // PARTS if reach < math.inf else 1


@compiled_for(_I(_LAW, _STAGES, _HERD, _I[:, ::1], _F[:, :, ::1], _TRACKS, _I[::1]))
def asynchronous(
    law: Callable[..., None],
    stages: Stages,
    herd: HerdArrays,
    order: Ints,
    draws: Floats,
    tracks: Tracks,
    turn: Ints,
) -> int:
    """Steps in which the members decide and move one after the other; returns 0, or 1 if a law failed.

    `order` (steps, n): who comes when; `draws` (steps, n, DRAWS) in that order. The rest as in `synchronous`.
    """
    bodies, motions, place = herd.bodies, herd.motions, herd.place
    count = len(bodies.positions)
    room = scratch(count, stages, len(place.walls))
    pad = PAD * stages.reach
    block = part_of(count, stages.reach)
    crowd = Crowd(bodies.positions, bodies.headings, bodies.velocities, np.arange(count))
    for step in range(len(order)):
        cells = binned(bodies.positions, stages.reach + 2.0 * pad, place.period)
        at = bodies.positions.copy()
        for k in range(order.shape[1]):
            i = order[step, k]
            turn[0], turn[1] = step, i
            sound = decide(law, i, i, stages, herd, crowd, cells, draws[step, k], room)
            motions[i] = room.motion
            if not sound:
                return 1
            move(i, herd, bodies.positions)
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
        keep_step(bodies, tracks, step)
    return 0
