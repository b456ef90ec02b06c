"""The Create's two bumper switches: which contacts of the ring press them, and how hard.

A switch feels the normal forces of all contacts of the ring that lie in its zone, a box in the robot's own frame: from
the axle forwards, on its side and a little over the middle. So would a touch sensor of MuJoCo on a site of that box
feel: a test holds the two equal. Reading the contacts that a step has found costs less than such sensors, each of
which goes through all contacts of the world.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from flocking.compilation import compiled
from flocking.types import Floats

FORCE = 0.5
"""N that press a bumper's switch; ?"""
BEYOND = 0.02
"""m by which the zones reach beyond the outline; ?: no contact of the ring lies farther out."""
HALF_HEIGHT = 0.03
"""m, half of the zones' height; ?"""


class Ring(NamedTuple):
    """The front ring of a robot and the zones of its switches, m."""

    reach: float
    """Of the zones, ahead and to the sides."""
    overlap: float
    """Of either zone over the middle."""
    height: float
    """Of the ring's middle above the floor."""
    half_height: float


RING_DTYPE = np.dtype([(name, np.float64) for name in Ring._fields])


class Zone(NamedTuple):
    """A box in the robot's frame, m."""

    centre: tuple[float, float, float]
    half_lengths: tuple[float, float, float]


def ring(radius: float, height: float, overlap: float) -> Ring:
    """The ring about an outline of that radius (m), and its zones."""
    return Ring(radius + BEYOND, overlap, height, HALF_HEIGHT)


def zone(ring: Ring, side: float) -> Zone:
    """Of the left (`side` = 1) or the right (−1) switch."""
    reach, overlap = ring.reach, ring.overlap
    return Zone(
        (reach / 2, side * (reach - overlap) / 2, ring.height), (reach / 2, (reach + overlap) / 2, ring.half_height)
    )


def recorded(ring: Ring) -> Any:
    """(1,) `ring` as an array of one record, which compiled code takes."""
    return np.array([tuple(ring)], dtype=RING_DTYPE)


@compiled
def add(force: float, point: Floats, ring: Any, centre: Floats, turn: Floats, pressing: Floats) -> None:
    """Adds the normal force (N) of a contact of the ring to what the left and the right switch feel, `pressing` (2,).

    point (3,): the contact's place; centre (3,) and turn (9,): the robot's place and rotation matrix at that moment,
    all in the world; ring: a record that `recorded` makes.
    """
    away_x, away_y, away_z = point[0] - centre[0], point[1] - centre[1], point[2] - centre[2]
    x = turn[0] * away_x + turn[3] * away_y + turn[6] * away_z
    y = turn[1] * away_x + turn[4] * away_y + turn[7] * away_z
    z = turn[2] * away_x + turn[5] * away_y + turn[8] * away_z
    if 0.0 <= x <= ring.reach and abs(z - ring.height) <= ring.half_height:
        if -ring.overlap <= y <= ring.reach:
            pressing[0] += force
        if -ring.reach <= y <= ring.overlap:
            pressing[1] += force
