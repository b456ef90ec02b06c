"""What a run of orange pixels tells of a cone: equations 3.3 to 3.7, 3.15 and 3.16 of Kirchner 2006, in SI units.

The misprints, mended: 3.15 divides by 5.12 pixels a degree; the centre of a run (3.16) is half its start and end. The
equations take the cone for a sphere of its base's radius, and |d| is the distance to its near side: 3.5 is exact for
the tangent of the angle, and the true tangent lines make |d| short by D − sqrt(D² − r²), D to the axis (4 % at
half a foot, 0.04 % at six feet).

Bearings here are left positive; the thesis's are right positive (it subtracts 47.5 degrees for the left camera).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from flocking.types import Floats
from sensing.camera.lens import PIXELS_PER_DEGREE, Lens, pixels_per_degree, places

RADIUS_M = 2 * 0.0254
"""Of the cone's base. Published: section 3.6.6."""
NEAREST_M = 1e-3
"""A cone that seems nearer than this (3.5 is negative beyond 90 degrees) is this far away."""


class Run(NamedTuple):
    """A run of one image: columns `start` to `end`, both orange."""

    start: int
    end: int

    @property
    def length_px(self) -> int:
        """Run_max of 3.15."""
        return self.end - self.start + 1


def subtended_rad(length_px: float, per_degree: float = PIXELS_PER_DEGREE) -> float:
    """Equation 3.15: the angle α that so many columns cover, where all are the same angle apart."""
    return math.radians(length_px / per_degree)


def bearing_rad(run: Run, lens: Lens) -> float:
    """Equation 3.16: the bearing β of a run's centre in the camera's frame, left positive, for equal angles.

    The camera's centre is that of its columns, (W − 1) / 2, so that a run in the middle is straight ahead.
    """
    centre, middle = (run.start + run.end) / 2.0, (lens.width_px - 1) / 2.0
    return math.radians((middle - centre) / pixels_per_degree(lens))


def distance_m(subtended: float, radius_m: float = RADIUS_M) -> float:
    """Equation 3.5: |d| from the camera to the near side of a sphere that covers the angle α (rad)."""
    return max(radius_m / math.tan(subtended / 2.0) - radius_m, NEAREST_M)


def angle_of(distance: float, radius_m: float = RADIUS_M) -> float:
    """Equation 3.3, the inverse: the angle α (rad) that belongs to |d|."""
    return 2.0 * math.atan(radius_m / (distance + radius_m))


def closure_rate_m_s(distance: float, last: float, dt: float) -> float:
    """Equation 3.6 per second, not per image: negative when the cone comes nearer; nan where `last` is unknown (nan).

    `dt` > 0 is the time between the two images, s.
    """
    return (distance - last) / dt


def time_to_impact_s(distance: float, closure_rate: float) -> float:
    """Equation 3.7: τ = −|d| / (d|d|/dt). Negative when the cone moves away; inf when it keeps its distance."""
    return -distance / closure_rate if closure_rate != 0.0 else math.inf


def run_of_disc(lens: Lens, distance: float, bearing: float, radius_m: float = RADIUS_M) -> float:
    """Columns (not rounded) that a disc covers, the near side of which is at this distance (m) and bearing (rad).

    Its edges are the tangents, asin(r / D) either side of its axis, D = distance + radius.
    """
    half = math.asin(radius_m / (distance + radius_m))
    left, right = places(lens, np.array([bearing + half, bearing - half]))
    return float(right - left)


def distance_read(lens: Lens, distance: float, bearing: float, radius_m: float = RADIUS_M) -> float:
    """The distance (m) that 3.15 and 3.5 read of that disc, taking 5.12 px a degree (W / FOV) for the whole image."""
    length = run_of_disc(lens, distance, bearing, radius_m)
    return distance_m(subtended_rad(length, pixels_per_degree(lens)), radius_m)


def edges_of(angles: Floats) -> Floats:
    """(W + 1,) the bearings of the columns' borders from those of their middles (W,): half-way, and as far outside."""
    if len(angles) == 1:
        return np.array([angles[0], angles[0]])
    between = (angles[:-1] + angles[1:]) / 2.0
    return np.concatenate([[2.0 * angles[0] - between[0]], between, [2.0 * angles[-1] - between[-1]]])
