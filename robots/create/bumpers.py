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
from flocking.types import Floats, Ints
from robots.touching import UNOWNED

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
def felt(
    rings: Any, roots: Ints, hulls: Ints, pairs: Ints, points: Floats, forces: Floats, xpos: Floats, xmat: Floats,
    pressing: Floats,
) -> None:  # fmt: skip
    """Fills `pressing` (N, 2) with what each switch feels, left and right, N.

    roots (N,): the robots' root bodies; hulls (ngeom,): whose hull a geom is, or `UNOWNED`; pairs (C, 2), points
    (C, 3), forces (C,): geoms, places in the world and normal forces of the contacts that the step has found; xpos
    (nbody, 3), xmat (nbody, 9): of that same moment.
    """
    ring = rings[0]
    pressing[:] = 0.0
    for c in range(len(pairs)):
        if forces[c] <= 0.0:
            continue
        for end in range(2):
            k = hulls[pairs[c, end]]
            if k == UNOWNED:
                continue
            root = roots[k]
            away = points[c] - xpos[root]
            turn = xmat[root]
            x = turn[0] * away[0] + turn[3] * away[1] + turn[6] * away[2]
            y = turn[1] * away[0] + turn[4] * away[1] + turn[7] * away[2]
            z = turn[2] * away[0] + turn[5] * away[1] + turn[8] * away[2]
            if 0.0 <= x <= ring.reach and abs(z - ring.height) <= ring.half_height:
                if -ring.overlap <= y <= ring.reach:
                    pressing[k, 0] += forces[c]
                if -ring.reach <= y <= ring.overlap:
                    pressing[k, 1] += forces[c]
