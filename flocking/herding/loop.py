"""The inner loops: each member of a herd decides by those whom it sees; point masses do what they decide. Compiled."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numba
import numpy as np
from numba.core import types

from flocking.compilation import allocating, borrowing, compiled_for
from flocking.herding.pointer import at_address
from flocking.kinematic.motion import wanted
from flocking.kinematic.views import first, folded
from flocking.lawentry import OWN_SIZE
from flocking.types import Bools, Floats, Ints


class Mood(NamedTuple):
    """What each member's law is given beside what it sees; N rows."""

    parameters: Floats
    """(N, P) of its law."""
    roles: Ints
    """(N,)."""
    ways: Floats
    """(N, 2) towards its goal, m, world axes; nan = none."""
    memory: Floats
    """(N, MEMORY)."""


class Herd(NamedTuple):
    """A herd of N members; world frame."""

    positions: Floats
    """(N, 2)."""
    actual: Floats
    """(N, 2) velocity of each as all see it, itself too."""
    desired: Floats
    """(N, 2) velocity that it decided on last; of point masses the same array."""
    headings: Floats
    """(N,) direction of that velocity: its body frame; kept while it stands."""
    axes: Floats
    """(N, 3) a heading, its cosine and its sine, as in `flocking.kinematic.arrays.HerdArrays`."""
    motions: Floats
    """(N, 4) kind, x, y and rule of what it decided last; body frame."""
    mood: Mood
    seen: Ints
    """(N, N) whom it sees: the first `counts` of its row."""
    counts: Ints
    """(N,)."""
    place_errors: Floats
    """(N, N, 2) as in `flocking.herding.sight.look`."""
    velocity_errors: Floats
    """(N, N, 2), m/s, likewise, or (0, 0, 2)."""
    discs: Floats
    """(K, 3) x, y and radius of what stands in the way."""
    sight_m: float
    """Range of that."""
    bearings: bool
    """Whether the law reads bearings, which are else of no use."""
    headed: bool
    """Whether it reads headings, likewise."""
    tells: bool
    """Whether a member is told of its neighbours' desired velocities: `actual` ones are then shifted, its own too, so
    that their mean over those it sees is that of the desired ones. What one is relative to another stays as it is."""


RELEASE = 1.25
"""Times the distance within which two touch, beyond which they no longer do: two that tremble about it touch once. A
choice."""


class Touching(NamedTuple):
    """Pairs that have come within a distance of each other and are not apart yet, and a list of when that began."""

    distance_m: float
    now: Bools
    """(N, N), the upper triangle."""
    times: Floats
    """(C,) of the pairs that came within it: room for so many."""
    pairs: Ints
    """(C, 2)."""
    places: Floats
    """(C, 2) halfway between the two, m."""
    found: Ints
    """(1,) how many pairs came within it; beyond C they are only counted."""
    closest: Floats
    """(1,) smallest distance so far, m."""


def example_herd() -> Herd:
    """A herd of the right types, for the signatures."""
    mood = Mood(np.empty((0, 0)), np.empty(0, np.int64), np.empty((0, 2)), np.empty((0, 0)))
    pairs = np.empty((0, 2))
    return Herd(
        pairs,
        pairs,
        pairs,
        np.empty(0),
        np.empty((0, 3)),
        np.empty((0, 4)),
        mood,
        np.empty((0, 0), np.int64),
        np.empty(0, np.int64),
        np.empty((0, 0, 2)),
        np.empty((0, 0, 2)),
        np.empty((0, 3)),
        0.0,
        False,
        False,
        False,
    )


def no_touching(count: int, distance_m: float, room: int = 0) -> Touching:
    """Nobody touches anybody yet, of `count` members; room for so many touches."""
    return Touching(
        distance_m,
        np.zeros((count, count), np.bool_),
        np.zeros(room),
        np.zeros((room, 2), np.int64),
        np.zeros((room, 2)),
        np.zeros(1, np.int64),
        np.full(1, math.inf),
    )


_HERD, _TOUCHING = numba.typeof(example_herd()), numba.typeof(no_touching(0, 0.0))
_F, _I, _B = types.float64, types.int64, types.boolean


@borrowing
def shift_of(i: int, herd: Herd) -> tuple[float, float]:
    """By how much the mean desired velocity of those whom member i sees differs from their mean actual one."""
    found, x, y = herd.counts[i], 0.0, 0.0
    if not herd.tells or found == 0:
        return 0.0, 0.0
    for k in range(found):
        j = herd.seen[i, k]
        x += herd.desired[j, 0] - herd.actual[j, 0]
        y += herd.desired[j, 1] - herd.actual[j, 1]
    return x / found, y / found


@borrowing
def know_oneself(i: int, herd: Herd, c: float, s: float, shift: tuple[float, float], dt: float, own: Floats) -> None:
    """Writes what member i knows of itself, as `flocking.lawentry.packed_own` packs it."""
    vx, vy, gx, gy = herd.actual[i, 0], herd.actual[i, 1], herd.mood.ways[i, 0], herd.mood.ways[i, 1]
    vx, vy = vx + shift[0], vy + shift[1]
    own[0], own[1], own[2], own[3] = c * vx + s * vy, c * vy - s * vx, 0.0, herd.headings[i]
    own[4], own[5] = c * gx + s * gy, c * gy - s * gx
    own[6] = own[7] = 0.0
    own[8], own[9], own[10] = dt, i, herd.mood.roles[i]


@borrowing
def nearest_points(i: int, herd: Herd, c: float, s: float, points: Floats) -> int:
    """Writes the nearest point of each disc within sight of member i, body frame; returns how many there are."""
    count = 0
    for k in range(len(herd.discs)):
        dx, dy = herd.discs[k, 0] - herd.positions[i, 0], herd.discs[k, 1] - herd.positions[i, 1]
        distance = math.hypot(dx, dy)
        away = distance - herd.discs[k, 2]
        if away > 0.0 and away <= herd.sight_m:
            dx, dy = dx * away / distance, dy * away / distance
            points[count, 0], points[count, 1] = c * dx + s * dy, c * dy - s * dx
            count += 1
    return count


@allocating
def decide_all(law: Callable[..., None], herd: Herd, who: Bools, draws: Floats, dt: float, turn: Ints) -> int:
    """Has the members `who` (N,) decide on the same state; they then have new desired velocities and headings.

    `draws` (N, DRAWS). Returns 0, or 1 if the law gave no valid motion; `turn` (2,) holds the member at work.
    """
    count = len(herd.positions)
    own, near, bearings = np.empty(OWN_SIZE), np.empty((count, 2)), np.empty(count)
    headings, velocities, ids = np.full(count, math.nan), np.empty((count, 2)), np.empty(count, np.int64)
    sets, points = np.ones(count, np.bool_), np.empty((len(herd.discs), 2))
    # velocities change once all have decided: actual and desired ones may be the same array
    for i in range(count):
        if not who[i]:
            continue
        turn[1] = i
        heading = herd.headings[i]
        if herd.axes[i, 0] != heading:
            herd.axes[i, 0], herd.axes[i, 1], herd.axes[i, 2] = heading, math.cos(heading), math.sin(heading)
        c, s = herd.axes[i, 1], herd.axes[i, 2]
        shift = shift_of(i, herd)
        know_oneself(i, herd, c, s, shift, dt, own)
        x, y, found = herd.positions[i, 0], herd.positions[i, 1], herd.counts[i]
        for k in range(found):
            j = herd.seen[i, k]
            dx, dy = herd.positions[j, 0] - x, herd.positions[j, 1] - y
            vx, vy = herd.actual[j, 0] + shift[0], herd.actual[j, 1] + shift[1]
            if len(herd.place_errors) > 0:
                dx, dy = dx + herd.place_errors[i, j, 0], dy + herd.place_errors[i, j, 1]
            if len(herd.velocity_errors) > 0:
                vx, vy = vx + herd.velocity_errors[i, j, 0], vy + herd.velocity_errors[i, j, 1]
            near[k, 0], near[k, 1] = c * dx + s * dy, c * dy - s * dx
            velocities[k, 0], velocities[k, 1] = c * vx + s * vy, c * vy - s * vx
            if herd.headed:
                headings[k] = herd.headings[j] - heading
            if herd.bearings:
                bearings[k] = math.atan2(near[k, 1], near[k, 0])
            ids[k] = j
        seen = nearest_points(i, herd, c, s, points)
        motion = herd.motions[i]
        law(
            own,
            first(near, found),
            first(bearings, found),
            first(headings, found),
            first(velocities, found),
            first(ids, found),
            folded(sets, 1, found),
            first(points, seen),
            herd.mood.parameters[i],
            herd.mood.memory[i],
            draws[i],
            motion,
        )
        kind = int(motion[0])
        if not (0 <= kind <= 1 or (2 <= kind <= 5 and abs(motion[1]) + abs(motion[2]) < math.inf)):
            return 1
    for i in range(count):
        if who[i]:
            kind, x, y = int(herd.motions[i, 0]), herd.motions[i, 1], herd.motions[i, 2]
            vx, vy, heading = wanted(
                i, kind, x, y, herd.desired[i, 0], herd.desired[i, 1], herd.headings[i], herd.axes, math.inf, dt
            )
            herd.desired[i, 0], herd.desired[i, 1], herd.headings[i] = vx, vy, heading
    return 0


@borrowing
def note_touches(herd: Herd, there: Bools, touching: Touching, time: float) -> None:
    """Notes which pairs of those who are `there` (N,) have come within the distance of each other."""
    positions, now, squared = herd.positions, touching.now, touching.distance_m * touching.distance_m
    released = squared * RELEASE * RELEASE
    closest = touching.closest[0] * touching.closest[0]
    for i in range(len(positions)):
        if not there[i]:
            continue
        x, y = positions[i, 0], positions[i, 1]
        for j in range(i + 1, len(positions)):
            dx, dy = positions[j, 0] - x, positions[j, 1] - y
            away = dx * dx + dy * dy
            near = away < squared
            if not (near or now[i, j]) and away >= closest:
                continue
            if not there[j]:
                now[i, j] = False
                continue
            closest = min(closest, away)
            if near and not now[i, j]:
                found = touching.found[0]
                if found < len(touching.times):
                    touching.times[found] = time
                    touching.pairs[found, 0], touching.pairs[found, 1] = i, j
                    touching.places[found, 0], touching.places[found, 1] = x + 0.5 * dx, y + 0.5 * dy
                touching.found[0] += 1
            now[i, j] = near or (now[i, j] and away < released)
    touching.closest[0] = math.sqrt(closest)


@compiled_for(_I(_I, _HERD, _B[::1], _F[:, ::1], _F, _I[::1]))
def decide(law: int, herd: Herd, who: Bools, draws: Floats, dt: float, turn: Ints) -> int:
    """See `decide_all`; `law` is the address of the law's entry."""
    return decide_all(at_address(law), herd, who, draws, dt, turn)


@compiled_for(types.void(_HERD, _B[::1], _TOUCHING, _F))
def touches(herd: Herd, there: Bools, touching: Touching, time: float) -> None:
    """See `note_touches`."""
    note_touches(herd, there, touching, time)


@compiled_for(_I(_I, _HERD, _F[:, :, ::1], _I, _I, _F, _TOUCHING, _I[::1]))
def advance(
    law: int, herd: Herd, draws: Floats, before: int, noted_every: int, dt: float, touching: Touching, turn: Ints
) -> int:
    """Steps of point masses, after so many `before`: all decide on the same state and then move by what they decided.

    `law` is the address of the law's entry. Touches are noted after every so many steps.

    `draws` (steps, N, DRAWS). Returns 0, or 1 if the law gave no valid motion; `turn` (2,): step and member at work.
    """
    everybody = np.ones(len(herd.positions), np.bool_)
    for step in range(len(draws)):
        turn[0] = step
        if decide_all(at_address(law), herd, everybody, draws[step], dt, turn) != 0:
            return 1
        for i in range(len(herd.positions)):
            herd.positions[i, 0] += herd.desired[i, 0] * dt
            herd.positions[i, 1] += herd.desired[i, 1] * dt
        done = before + step + 1
        if done % noted_every == 0:
            note_touches(herd, everybody, touching, done * dt)
    return 0
