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

from flocking.compilation import borrowing, compiled_for, inlined
from flocking.kinematic import arrays
from flocking.kinematic.arrays import Bodies, HerdArrays, Place, Stages, Tracks
from flocking.kinematic.cells import FEWEST_MEMBERS, Cells, binned, cells_of, no_cells
from flocking.kinematic.mind import decide
from flocking.kinematic.motion import move
from flocking.kinematic.obstacles import keep_near, lay_out
from flocking.kinematic.sight import Crowd, Scratch, assemble, in_columns, scratch
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


@compiled_for(types.void(_HERD, _F[:, ::1]), _nrt=False)
def move_all(herd: HerdArrays, room: Floats) -> None:
    """Moves everybody as decided: the second half of a synchronous step. `room` (N, 2): for where they are before."""
    positions = herd.bodies.positions
    for i in range(len(positions)):
        room[i, 0], room[i, 1] = positions[i, 0], positions[i, 1]
    for i in range(len(positions)):
        move(i, herd, room)


@inlined
def decide_all(
    law: Callable[..., None],
    step: int,
    stages: Stages,
    herd: HerdArrays,
    who: Ints,
    rows: Ints,
    crowd: Crowd,
    cells: Cells,
    draws: Floats,
    room: Scratch,
    turn: Ints,
) -> bool:
    """Has the members `who` decide in turn, the first half of a synchronous step. False if the law failed.

    All of them do so in the order of the cells, if there are any. `rows` (N,) is room for the members' rows of the
    crowd; the rest as in `synchronous`.
    """
    bodies, place, motions, motion = herd.bodies, herd.place, herd.motions, room.motion
    by_cells = cells.columns > 0 and len(who) == len(rows)
    if len(room.columns) > 0:
        in_columns(bodies, room.columns)
    near_walls = 0
    if stages.obstacles or stages.avoids or stages.virtual:
        sight = stages.sight if place.period == 0.0 else math.inf
        near_walls = keep_near(bodies.positions, place.walls, room.walls, sight, room.near_walls)
    for k in range(0 if by_cells else len(rows)):
        rows[crowd.ids[k]] = k
    for k in range(len(who)):
        at = crowd.ids[k] if by_cells else k
        i = who[at]
        row = k if by_cells else rows[i]
        turn[0], turn[1] = step, i
        sound = decide(law, i, row, stages, herd, crowd, cells, near_walls, draws[step, at], room)
        motions[i, 0], motions[i, 1], motions[i, 2], motions[i, 3] = motion[0], motion[1], motion[2], motion[3]
        if not sound:
            return False
    return True


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
    bodies, period = herd.bodies, herd.place.period
    count = len(bodies.positions)
    room = scratch(count, stages, len(herd.place.walls), period)
    lay_out(herd.place.walls, room.walls)
    everybody, rows, before = np.arange(count), np.arange(count), np.empty((count, 2))
    unsorted = Crowd(bodies.positions, bodies.headings, bodies.velocities, everybody)
    sorted_ = Crowd(np.empty((count, 2)), np.empty(count), np.empty((count, 2)), everybody.copy())
    cells, crowd = no_cells(), unsorted
    for step in range(len(draws)):
        if count >= FEWEST_MEMBERS:
            cells, crowd = binned(bodies.positions, stages.reach, period), unsorted
            if cells.columns > 0:
                assemble(bodies, cells, sorted_)
                cells, crowd = cells_of(cells, everybody), sorted_
        if not decide_all(law, step, stages, herd, who, rows, crowd, cells, draws, room, turn):
            return 1
        if decides_only == 0:
            move_all(herd, before)
            keep_step(bodies, tracks, step)
    return 0


@compiled_for(
    _I(
        _LAW,
        _STAGES,
        _HERD,
        _F[:, :, ::1],
        _F[:, :, ::1],
        _F[:, ::1],
        _I[::1],
        _F[::1],
        _F[:, :, :, ::1],
        _F[:, :, :, ::1],
        _I[::1],
    )
)
def many(
    law: Callable[..., None],
    stages: Stages,
    herd: HerdArrays,
    poses: Floats,
    velocities: Floats,
    walls: Floats,
    ends: Ints,
    clearances: Floats,
    draws: Floats,
    positions: Floats,
    turn: Ints,
) -> int:
    """Herds of one band, one after the other, synchronous, from their start on; returns 0, or 1 if a law failed.

    `herd` is set up for one of them and holds each in turn. Of J herds of N members: `poses` (J, N, 3), `velocities`
    (J, N, 2), `walls` (W, 4) of all, those of herd j in the rows `ends[j]` to `ends[j + 1]`, `clearances` (J,), `draws`
    (J, steps, N, DRAWS). Writes `positions` (J, steps + 1, N, 2). `turn` (3,): the herd, step and member at work.
    """
    bodies, limits, minds, place, dt, motions, forward, axes = herd
    count, steps = len(bodies.positions), draws.shape[1]
    who, rows = np.arange(count), np.empty((steps, count, 5))
    for j in range(len(poses)):
        turn[0] = j
        bodies.positions[:] = poses[j, :, :2]
        bodies.headings[:] = poses[j, :, 2]
        bodies.velocities[:] = velocities[j]
        bodies.turn_rates[:] = 0.0
        bodies.contacts[:] = False
        bodies.memory[:] = 0.0
        axes[:] = math.nan
        here = Place(place.period, walls[ends[j] : ends[j + 1]], clearances[j], place.graph, place.tessellated)
        one = HerdArrays(bodies, limits, minds, here, dt, motions, forward, axes)
        positions[j, 0] = bodies.positions
        if synchronous(law, stages, one, who, draws[j], Tracks(rows, 1, 0), turn[1:], 0) != 0:
            return 1
        positions[j, 1:] = rows[:, :, :2]
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
    room = scratch(count, stages, len(place.walls), place.period)
    lay_out(place.walls, room.walls)
    keep_near(bodies.positions, place.walls, room.walls, math.inf, room.near_walls)
    pad = PAD * stages.reach
    block = part_of(count, stages.reach)
    crowd = Crowd(bodies.positions, bodies.headings, bodies.velocities, np.arange(count))
    for step in range(len(order)):
        cells = binned(bodies.positions, stages.reach + 2.0 * pad, place.period)
        at = bodies.positions.copy()
        for k in range(order.shape[1]):
            i = order[step, k]
            turn[0], turn[1] = step, i
            if len(room.columns) > 0:
                in_columns(bodies, room.columns)
            sound = decide(law, i, i, stages, herd, crowd, cells, len(place.walls), draws[step, k], room)
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
