"""What a member knows and what it decides: the types between the five stages.

All are immutable tuples of float64 arrays and numbers, so that the same values pass through plain Python and
through compiled code. Units: metres, seconds, radians. Frame: the focal member's body, x forward, y left, angles
counter-clockwise. Missing is nan.
"""

from __future__ import annotations

from enum import IntEnum
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

ANONYMOUS = -1
"""The id of a member of which nobody knows which one it is."""


class Kind(IntEnum):
    """What the two numbers of a `Motion` mean."""

    HOLD = 0
    """Keep the command as it is; x, y are nan."""
    STOP = 1
    """Stand still; x, y are nan."""
    WAY_POINT = 2
    """Go to (x, y), metres."""
    VELOCITY = 3
    """Move with velocity (x, y), m/s."""
    HEADING = 4
    """Turn to bearing x (rad) and move at speed y (m/s)."""
    ACCELERATION = 5
    """Accelerate by (x, y), m/s²."""


class Own(NamedTuple):
    """What a member knows of itself."""

    velocity: Floats
    """(2,) over ground, m/s, as far as it knows it."""
    turn_rate: float
    """rad/s, likewise."""
    compass: float
    """Heading in the world, rad; nan where the law is given none."""
    goal: Floats
    """(2,) position of its goal, m; nan where it has none."""
    contacts: Bools
    """(2,) left and right bumper pressed since the last update; compiled laws get a pair."""
    dt: float
    """Time since its last update, s."""
    id: int
    role: int
    """0 = ordinary member."""


class Members(NamedTuple):
    """The set D of detected members; M = 0 is legal everywhere."""

    positions: Floats
    """(M, 2) m; nan for a member of which only the bearing is known."""
    bearings: Floats
    """(M,) rad."""
    headings: Floats
    """(M,) rad; nan = unknown."""
    velocities: Floats
    """(M, 2) over ground, in the focal body's axes, m/s; nan = unknown."""
    ids: Ints
    """(M,) −1 = anonymous."""


class Obstacles(NamedTuple):
    """What stands in the way and is no member."""

    points: Floats
    """(K, 2) nearest point of each surface seen, m."""


class Motion(NamedTuple):
    """What a law decides."""

    kind: int
    """A `Kind`."""
    x: float
    y: float
    rule: int
    """Index into the law's `RULES`: which of them spoke."""


@cache
def unknown(count: int) -> tuple[Floats, Floats, Ints]:
    """Headings (M,), velocities (M, 2) and ids (M,) of so many members of which none is known.

    The same arrays each time: nobody may write to them, as to no `Members`.
    """
    return np.full(count, np.nan), np.full((count, 2), np.nan), np.full(count, ANONYMOUS, dtype=np.int64)


def members_at(positions: Floats) -> Members:
    """Anonymous members of which only the positions (M, 2) are known."""
    positions = np.ascontiguousarray(positions, dtype=np.float64).reshape(-1, 2)
    return Members(positions, np.arctan2(positions[:, 1], positions[:, 0]), *unknown(len(positions)))


def only(members: Members, rows: Ints) -> Members:
    """The members in these rows, in this order."""
    positions, bearings, headings, velocities, ids = members
    return Members(positions[rows], bearings[rows], headings[rows], velocities[rows], ids[rows])


NO_MEMBERS = members_at(np.empty((0, 2)))
NO_OBSTACLES = Obstacles(np.empty((0, 2)))
