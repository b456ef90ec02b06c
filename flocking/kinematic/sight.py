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
from flocking.kinematic.arrays import BEARINGS, Bodies, Stages
from flocking.kinematic.cells import Cells, nearby
from flocking.kinematic.walls import shortest
from flocking.lawentry import OWN_SIZE
from flocking.perception import ARGUMENTS
from flocking.types import Bools, Floats, Ints


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
    near_walls: Ints
    """(W,) the walls that anybody may see, those first that `near_walls_of` counts."""


@compiled
def scratch(count: int, stages: Stages, walls: int) -> Scratch:
    """Room for what members with these stages see in a herd of `count` members, among so many walls."""
    sets, beams = stages.steps.shape[0], 0
    if stages.detection != detection.Detection.PERFECT:
        beams = detection.BEAMS
    room = max(count, beams) + walls
    return Scratch(
        np.zeros(OWN_SIZE),
        np.empty(18, np.int64),
        np.empty(count, np.int64),
        np.empty((count, 2)),
        np.empty((room, 2)),
        np.empty(room),
        np.full(room, np.nan),
        np.full((room, 2), np.nan),
        np.empty(room, np.int64),
        np.empty(room, np.int64),
        np.empty(room * sets, np.bool_),
        np.zeros(room, np.bool_),
        np.zeros(room, np.bool_),
        np.empty(ARGUMENTS),
        np.empty((walls, 2)),
        np.empty((walls, 2)),
        np.empty(beams),
        np.empty(beams, np.int64),
        np.empty(4),
        np.arange(walls),
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
    """Writes heading, velocity (body axes) and id of each input from the member that it is of; nan for what is not read."""
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


@inlined
def of_all_at_once(focal: Focal, reach: float, crowd: Crowd, room: Scratch) -> int:
    """What `detected` does where all members are looked at, perfectly, in space without period, and no heading is read.

    One pass over the members: each is written, and counted if it is within reach.
    """
    i, x, y, c, s = focal.id, focal.x, focal.y, focal.cosine, focal.sine
    all_positions, all_velocities, all_ids = crowd.positions, crowd.velocities, crowd.ids
    positions, velocities, ids, sources = room.positions, room.velocities, room.ids, room.sources
    squared, count = reach * reach, 0
    for j in range(len(all_positions)):
        dx, dy = all_positions[j, 0] - x, all_positions[j, 1] - y
        vx, vy = all_velocities[j, 0], all_velocities[j, 1]
        positions[count, 0], positions[count, 1] = c * dx + s * dy, c * dy - s * dx
        velocities[count, 0], velocities[count, 1] = c * vx + s * vy, c * vy - s * vx
        ids[count] = all_ids[j]
        sources[count] = j
        count += (dx * dx + dy * dy <= squared) & (all_ids[j] != i)
    return count


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
    if perfect and period == 0.0 and cells.columns == 0 and stages.velocities and not stages.headings:
        found = of_all_at_once(focal, stages.reach, crowd, room)
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
