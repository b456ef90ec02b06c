"""Stage 2 of one member of the kinematic herd: what it detects of the others, in its own frame. Compiled.

Only `scratch` makes arrays: all that a member sees is written into the one `Scratch` that the whole herd uses in turn.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from flocking.angles import turn_between
from flocking.compilation import borrowing, compiled, inlined
from flocking.kinematic import detection
from flocking.kinematic.arrays import BEARINGS, BELOW, LEAST, Bodies, Stages
from flocking.kinematic.cells import FEWEST_MEMBERS, Cells, nearby
from flocking.kinematic.walls import shortest
from flocking.lawentry import OWN_SIZE
from flocking.perception import ARGUMENTS, Step
from flocking.types import Bools, Floats, Ints

AT_ONCE = 4
"""Members that are turned at a time: so many numbers are in a register of most processors, and FEWEST_MEMBERS is a
multiple of it."""


class Crowd(NamedTuple):
    """Everybody as seen from outside, in the order of the cells: what is near in space is near in memory."""

    positions: Floats
    """(N, 2)."""
    headings: Floats
    velocities: Floats
    ids: Ints
    """(N,) which member each row is."""


class Focal(NamedTuple):
    """The member that sees and decides; world frame."""

    id: int
    x: float
    y: float
    heading: float
    cosine: float
    """Of its heading."""
    sine: float
    """Likewise."""


class Between(NamedTuple):
    """The selection of the most laws, by distance alone: done while the inputs are written, instead of afterwards."""

    only: bool
    """Whether it is the whole of stage 3."""
    least: float
    """Square of the distance from which on members are selected, as `flocking.perception.squared_bound` makes it."""
    below: float
    """Likewise, of that below which they are."""


class Scratch(NamedTuple):
    """Room for what one member sees and decides; M inputs, S sets."""

    own: Floats
    """What it knows of itself, as `flocking.lawentry.packed_own` packs it."""
    near: Ints
    """(18,) pieces of the cells' list, as `flocking.kinematic.cells.nearby` writes them."""
    candidates: Ints
    """(N,) rows of the crowd that are within reach."""
    seen: Floats
    """(N, 2) where they are from it; world axes, then body axes."""
    positions: Floats
    """(M, 2) of the inputs, body frame; the next four likewise."""
    bearings: Floats
    headings: Floats
    velocities: Floats
    ids: Ints
    sources: Ints
    """(M,) the row of the crowd that each input is of."""
    sets: Bools
    """(S · M,) the masks of all sets, one after the other."""
    linked: Bools
    """(M,) whether the graph joins it to the input's member."""
    tessellated: Bools
    """(M,) whether its Voronoi cell touches that of the input's member."""
    given: Floats
    """(ARGUMENTS,) numbers of the step of a selection that is at work."""
    obstacles: Floats
    """(W, 2) nearest points of the walls, body frame."""
    virtual_velocities: Floats
    """(W, 2) of the virtual members, body frame."""
    ranges: Floats
    """(BEAMS,) readings of its laser; (0,) where detection is perfect."""
    owners: Ints
    """(BEAMS,) the candidate that each reading falls on, -1 = none."""
    motion: Floats
    """(4,) kind, x, y and rule of what its law decided."""
    flat_positions: Floats
    """(2 · M,) the same memory as `positions`, and the next as `velocities`: so an index costs no multiplication."""
    flat_velocities: Floats
    columns: Floats
    """(8 · FEWEST_MEMBERS,) x, y, vx, vy of all members, world frame, then in that of the body, one column after the
    other; (0,) where members are looked at one by one."""
    within: Ints
    """(FEWEST_MEMBERS,) which members are within reach, as `turn_columns` writes it; (0,) likewise."""
    between: Between
    walls: Floats
    """(5, W) all walls, as `flocking.kinematic.obstacles` lays them out."""
    near_walls: Floats
    """(8, W) those that anybody may see, likewise, and then where the member sees them."""
    ways: Floats
    """(2, W) room for `flocking.avoidance.avoid_in`."""


@compiled
def scratch(count: int, stages: Stages, walls: int, period: float) -> Scratch:
    """Room for what members with these stages see in a herd of `count` members, among so many walls."""
    sets, beams = stages.steps.shape[0], 0
    if stages.detection != detection.Detection.PERFECT:
        beams = detection.BEAMS
    room = max(count, beams) + walls
    plain = beams == 0 and stages.velocities and not stages.headings and count < FEWEST_MEMBERS
    between = Between(False, 0.0, 0.0)
    if plain and stages.steps.size == 1 and stages.steps[0, 0] == Step.DISTANCE_BASED and not stages.varied:
        given = stages.given[0, 0]
        # what is put elsewhere, or comes as an obstacle, is selected by where it then is
        moved = stages.virtual or stages.information == BEARINGS or period > 0.0
        between = Between(not moved, given[LEAST], given[BELOW])
    flat_positions, flat_velocities = np.empty(2 * room), np.full(2 * room, np.nan)
    return Scratch(
        np.zeros(OWN_SIZE),
        np.empty(18, np.int64),
        np.empty(count, np.int64),
        np.empty((count, 2)),
        flat_positions.reshape(room, 2),
        np.empty(room),
        np.full(room, np.nan),
        flat_velocities.reshape(room, 2),
        np.empty(room, np.int64),
        np.empty(room, np.int64),
        np.empty(room * max(1, sets), np.bool_),
        np.zeros(room, np.bool_),
        np.zeros(room, np.bool_),
        np.empty(ARGUMENTS),
        np.empty((walls, 2)),
        np.empty((walls, 2)),
        np.empty(beams),
        np.empty(beams, np.int64),
        np.empty(4),
        flat_positions,
        flat_velocities,
        np.zeros(8 * FEWEST_MEMBERS if plain else 0),
        np.empty(FEWEST_MEMBERS if plain else 0, np.int64),
        between,
        np.empty((5, walls)),
        np.empty((8, walls)),
        np.empty((2, walls)),
    )


@borrowing
def assemble(bodies: Bodies, cells: Cells, crowd: Crowd) -> None:
    """Writes the crowd in the order of the cells."""
    members, ids = cells.members, crowd.ids
    positions, all_positions = crowd.positions, bodies.positions
    headings, all_headings = crowd.headings, bodies.headings
    velocities, all_velocities = crowd.velocities, bodies.velocities
    for k in range(len(members)):
        j = members[k]
        ids[k] = j
        positions[k, 0], positions[k, 1] = all_positions[j, 0], all_positions[j, 1]
        headings[k] = all_headings[j]
        velocities[k, 0], velocities[k, 1] = all_velocities[j, 0], all_velocities[j, 1]


@inlined
def of_all(focal: Focal, crowd: Crowd, period: float, squared: float, found: Ints, seen: Floats) -> int:
    """What `candidates` does, where there are no cells; `squared` is the reach, squared."""
    i, x, y = focal.id, focal.x, focal.y
    positions, who = crowd.positions, crowd.ids
    count = 0
    if period == 0.0:
        for j in range(len(positions)):
            dx, dy = positions[j, 0] - x, positions[j, 1] - y
            found[count] = j
            seen[count, 0], seen[count, 1] = dx, dy
            count += (dx * dx + dy * dy <= squared) & (who[j] != i)
        return count
    for j in range(len(positions)):
        dx, dy = shortest(positions[j, 0] - x, period), shortest(positions[j, 1] - y, period)
        found[count] = j
        seen[count, 0], seen[count, 1] = dx, dy
        count += (dx * dx + dy * dy <= squared) & (who[j] != i)
    return count


@inlined
def candidates(
    focal: Focal, crowd: Crowd, cells: Cells, period: float, reach: float, room: Scratch, found: Ints
) -> int:
    """Writes which rows of the crowd are within reach of member i, and where from it (world axes); returns how many."""
    # without a branch, which a processor would often guess wrong: each is written, and counted if it is within reach
    squared, count = reach * reach, 0
    if cells.columns == 0:
        return of_all(focal, crowd, period, squared, found, room.seen)
    i, x, y = focal.id, focal.x, focal.y
    positions, who, members, near, seen = crowd.positions, crowd.ids, cells.members, room.near, room.seen
    pieces = nearby(cells, x, y, near)
    for p in range(0, pieces, 2):
        for k in range(near[p], near[p + 1]):
            j = members[k]
            dx = shortest(positions[j, 0] - x, period)
            dy = shortest(positions[j, 1] - y, period)
            found[count] = j
            seen[count, 0], seen[count, 1] = dx, dy
            count += (dx * dx + dy * dy <= squared) & (who[j] != i)
    return count


@borrowing
def turn_all(vectors: Floats, count: int, c: float, s: float, out: Floats) -> None:
    """Writes the first `count` vectors (world axes) in the axes of a body whose heading has that cosine and sine."""
    for k in range(count):
        dx, dy = vectors[k, 0], vectors[k, 1]
        out[k, 0], out[k, 1] = c * dx + s * dy, c * dy - s * dx


@inlined
def describe(focal: Focal, found: int, stages: Stages, crowd: Crowd, room: Scratch) -> None:
    """Writes heading, velocity (body axes) and id of each input from its member; what is not read stays nan."""
    c, s, sources = focal.cosine, focal.sine, room.sources
    all_headings, all_velocities, all_ids = crowd.headings, crowd.velocities, crowd.ids
    headings, velocities, ids = room.headings, room.velocities, room.ids
    for k in range(found):
        ids[k] = all_ids[sources[k]]
    if stages.headings:
        for k in range(found):
            headings[k] = turn_between(focal.heading, all_headings[sources[k]])
    elif stages.virtual:  # where virtual members were
        headings[:found] = math.nan
    if stages.velocities:
        for k in range(found):
            j = sources[k]
            vx, vy = all_velocities[j, 0], all_velocities[j, 1]
            velocities[k, 0], velocities[k, 1] = c * vx + s * vy, c * vy - s * vx
    elif stages.virtual:
        velocities[:found] = math.nan


@borrowing
def in_columns(bodies: Bodies, columns: Floats) -> None:
    """Writes x, y, vx and vy of all members into the first four columns."""
    for j in range(len(bodies.positions)):
        columns[j], columns[FEWEST_MEMBERS + j] = bodies.positions[j, 0], bodies.positions[j, 1]
        columns[2 * FEWEST_MEMBERS + j], columns[3 * FEWEST_MEMBERS + j] = (
            bodies.velocities[j, 0],
            bodies.velocities[j, 1],
        )


@borrowing
def turn_columns(focal: Focal, count: int, squared: float, between: Between, columns: Floats, near: Ints) -> None:
    """Writes where all members are and how they move, body frame, into the last four columns.

    `near` (count or more,) of a member is 0 beyond reach, 1 within, and 3 if it is also selected. Nothing in the loop
    depends on the member before, and the columns lie at fixed distances, so that a processor does several members at a
    time; it does as many as are a multiple of that, for those left over would take as long one by one.
    """
    x, y, c, s = focal.x, focal.y, focal.cosine, focal.sine
    for j in range((count + AT_ONCE - 1) // AT_ONCE * AT_ONCE):
        dx, dy = columns[j] - x, columns[FEWEST_MEMBERS + j] - y
        vx, vy = columns[2 * FEWEST_MEMBERS + j], columns[3 * FEWEST_MEMBERS + j]
        to_x, to_y = c * dx + s * dy, c * dy - s * dx
        columns[4 * FEWEST_MEMBERS + j], columns[5 * FEWEST_MEMBERS + j] = to_x, to_y
        columns[6 * FEWEST_MEMBERS + j], columns[7 * FEWEST_MEMBERS + j] = c * vx + s * vy, c * vy - s * vx
        away = to_x * to_x + to_y * to_y
        selected = (between.least <= away) & (away < between.below)
        near[j] = np.int64(dx * dx + dy * dy <= squared) * (1 + 2 * np.int64(selected))
    near[focal.id] = 0


@borrowing
def pack_columns(
    members: int, columns: Floats, near: Ints, positions: Floats, velocities: Floats, ids: Ints, selected: Bools
) -> np.int64:
    """Writes those within reach one after the other as inputs, whose flat rows these are; returns how many."""
    count, one = np.uint64(0), np.uint64(1)  # unsigned: no index is looked at for being negative
    for j in range(members):
        at, now = count + count, near[j]
        positions[at] = columns[4 * FEWEST_MEMBERS + j]
        positions[at + one] = columns[5 * FEWEST_MEMBERS + j]
        velocities[at] = columns[6 * FEWEST_MEMBERS + j]
        velocities[at + one] = columns[7 * FEWEST_MEMBERS + j]
        ids[count] = j
        selected[count] = now > 1
        count += np.uint64(now & 1)
    return np.int64(count)


@borrowing
def at_distance(positions: Floats, count: int, distance: float) -> None:
    """Puts the first `count` positions at that distance, each at its bearing."""
    for k in range(count):
        d = math.hypot(positions[k, 0], positions[k, 1])
        if d > 0.0:
            positions[k, 0] *= distance / d
            positions[k, 1] *= distance / d


@borrowing
def take_bearings(positions: Floats, count: int, bearings: Floats) -> None:
    """Writes the bearing of the first `count` positions."""
    for k in range(count):
        bearings[k] = math.atan2(positions[k, 1], positions[k, 0])


@borrowing
def owners_of(found: int, candidates_: Ints, sources: Ints) -> None:
    """Turns the numbers of candidates in `sources` into their rows of the crowd."""
    for k in range(found):
        sources[k] = candidates_[sources[k]]


@inlined
def detected(focal: Focal, stages: Stages, crowd: Crowd, cells: Cells, period: float, room: Scratch) -> int:
    """Stage 2: writes the set D of the focal member in its body frame; returns its size."""
    perfect = stages.detection == detection.Detection.PERFECT
    if len(room.columns) > 0 and period == 0.0 and cells.columns == 0:
        columns, near, members = room.columns, room.within, len(crowd.positions)
        turn_columns(focal, members, stages.reach * stages.reach, room.between, columns, near)
        found = pack_columns(members, columns, near, room.flat_positions, room.flat_velocities, room.ids, room.sets)
        if stages.information == BEARINGS:
            at_distance(room.positions, found, stages.assumed_distance)
        if stages.bearings:
            take_bearings(room.positions, found, room.bearings)
        return found
    sources = room.sources if perfect else room.candidates
    found = candidates(focal, crowd, cells, period, stages.reach, room, sources)
    c, s = focal.cosine, focal.sine
    if perfect:
        turn_all(room.seen, found, c, s, room.positions)
    else:
        turn_all(room.seen, found, c, s, room.seen)
        found = detection.inputs(
            stages.detection,
            room.seen,
            found,
            stages.silhouette,
            stages.sight,
            room.ranges,
            room.owners,
            room.positions,
            room.sources,
        )
        owners_of(found, room.candidates, room.sources)
    describe(focal, found, stages, crowd, room)
    if stages.information == BEARINGS:
        at_distance(room.positions, found, stages.assumed_distance)
    if stages.bearings:
        take_bearings(room.positions, found, room.bearings)
    return found
