"""Stage 2 of one member of the kinematic herd: what it detects of the others, in its own frame. Compiled.

Nothing here makes arrays but the room itself: all that a member sees is written into the herd's one `Scratch`.
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
    """Room for what one member sees."""

    own: Floats
    near: Ints
    """(18,) pieces of the cells' list."""
    candidates: Ints
    """(N,) members within reach."""
    seen: Floats
    """(N, 2) where they are, body frame."""
    positions: Floats
    bearings: Floats
    headings: Floats
    velocities: Floats
    ids: Ints
    sources: Ints
    """Which row of the crowd each input is of."""
    sets: Bools
    """Flat: (S · M,) is reshaped."""
    linked: Bools
    tessellated: Bools
    given: Floats
    obstacles: Floats
    virtual_velocities: Floats
    ranges: Floats
    owners: Ints
    motion: Floats


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
        np.empty(room),
        np.empty((room, 2)),
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
    # each is written where the next found one goes: no branch that a processor could guess wrong
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
def describe(focal: Focal, found: int, crowd: Crowd, room: Scratch) -> None:
    """Writes heading, velocity (body axes) and id of each input from the member that it is of."""
    c, s, sources = focal.cosine, focal.sine, room.sources
    all_headings, all_velocities, all_ids = crowd.headings, crowd.velocities, crowd.ids
    headings, velocities, ids = room.headings, room.velocities, room.ids
    for k in range(found):
        j = sources[k]
        headings[k] = turn_between(focal.heading, all_headings[j])
        vx, vy = all_velocities[j, 0], all_velocities[j, 1]
        velocities[k, 0], velocities[k, 1] = c * vx + s * vy, c * vy - s * vx
        ids[k] = all_ids[j]


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
    """Turns rows of the candidates into members."""
    for k in range(found):
        sources[k] = candidates_[sources[k]]


@inlined
def detected(focal: Focal, stages: Stages, crowd: Crowd, cells: Cells, period: float, room: Scratch) -> int:
    """Stage 2: writes the set D of the focal member in its body frame; returns its size."""
    perfect = stages.detection == detection.Detection.PERFECT
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
    describe(focal, found, crowd, room)
    if stages.information == BEARINGS:
        at_distance(room.positions, found, stages.assumed_distance)
    if stages.bearings:
        take_bearings(room.positions, found, room.bearings)
    return found
