"""Measures of a group's formation and motion, in plain NumPy and SciPy.

Shapes: N members; leading axes (…, usually T times) pass through: a formation (N, 2) gives a number, a motion
(T, N, 2) gives (T,). Lengths in metres (any one unit will do), angles in radians. A nan among the members
makes the measure nan. `period_m`: the side of a periodic square, None in unbounded space.

Groups and mixing are in `groups`, hulls in `hull`, links in `links`, beside this file.
"""

from __future__ import annotations

import numpy as np

from flocking.measures.groups import group_labels
from flocking.measures.space import centre, from_centre, nearest_neighbours, unwrapped
from flocking.types import Floats, Ints


def polarization(headings: Floats) -> Floats:
    """Length of the mean of the unit vectors along `headings` (…, N): (…,) from 0 (cancelling) to 1 (one
    heading).

    One minus it is the circular variance. Source: Vicsek et al. 1995, the order parameter.
    """
    headings = np.asarray(headings, dtype=np.float64)
    return np.hypot(np.cos(headings).mean(axis=-1), np.sin(headings).mean(axis=-1))


def velocity_order(velocities: Floats) -> Floats:
    """Length of the mean of the unit vectors along `velocities` (…, N, 2): (…,).

    The polarization of members that are known by their velocities. A member at rest has no direction: it counts as
    a member that adds nothing.
    """
    velocities = np.asarray(velocities, dtype=np.float64)
    speeds = np.hypot(velocities[..., 0], velocities[..., 1])[..., None]
    mean = (velocities / np.where(speeds > 0.0, speeds, 1.0)).mean(axis=-2)
    return np.hypot(mean[..., 0], mean[..., 1])


def settled_mean(series: Floats, share: float = 0.5) -> Floats:
    """Mean over the last `share` of the times of a measure (T, …), at least one of them: (…,)."""
    series = np.asarray(series, dtype=np.float64)
    last = max(1, round(share * len(series)))
    return series[len(series) - last :].mean(axis=0)


def group_speed(velocities: Floats) -> Floats:
    """Speed of the group's centre: length of the mean of `velocities` (…, N, 2): (…,)."""
    mean = np.asarray(velocities, dtype=np.float64).mean(axis=-2)
    return np.hypot(mean[..., 0], mean[..., 1])


def mmd(positions: Floats, period_m: float | None = None) -> Floats:
    """Median distance of the members (…, N, 2) from the group's centre, their mean position: (…,).

    Source: Fine 2015, section 4.3 and table 4.1, after Viscido et al. 2002.
    """
    offsets = from_centre(positions, period_m)
    return np.median(np.hypot(offsets[..., 0], offsets[..., 1]), axis=-1)


def nearest_neighbour_distance(positions: Floats, period_m: float | None = None) -> Floats:
    """Distance of each member (…, N, 2) to the member nearest to it: (…, N); nan for a member alone."""
    positions = np.asarray(positions, dtype=np.float64)
    if positions.shape[-2] < 2:
        return np.full(positions.shape[:-1], np.nan)
    return nearest_neighbours(positions, 1, period_m)[0][..., 0]


def number_of_groups(positions: Floats, cut: float, period_m: float | None = None) -> Ints:
    """Number of groups among the members (…, N, 2): (…,).

    Single linkage: two members are of one group where a chain of members joins them, each link of which is at
    most `cut` long. A member alone is a group. Positions must be finite.
    """
    return group_labels(positions, cut, period_m).max(axis=-1, initial=-1) + 1


def straightness(positions: Floats) -> Floats:
    """How near the members (…, N, 2) stand to one straight line: (…,) from 0 (alike in all directions) to 1
    (a line).

    One minus the ratio of the root-mean-square spread across the formation's principal axis to that along it
    (square roots of the eigenvalues of the positions' covariance). It knows neither the formation's size nor
    its heading. Two members always stand on a line; members that all stand on one point have no axis: nan.
    """
    positions = np.asarray(positions, dtype=np.float64)
    offsets = positions - positions.mean(axis=-2, keepdims=True)
    xx = (offsets[..., 0] ** 2).mean(axis=-1)
    yy = (offsets[..., 1] ** 2).mean(axis=-1)
    xy = (offsets[..., 0] * offsets[..., 1]).mean(axis=-1)
    middle, reach = (xx + yy) / 2.0, np.hypot((xx - yy) / 2.0, xy)
    major = middle + reach
    # determinant / major: the smaller eigenvalue without the cancellation of middle - reach
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.maximum(xx * yy - xy**2, 0.0) / (major * major)
    return np.where(major > 0.0, 1.0 - np.sqrt(ratio), np.nan)


def path_length(positions: Floats, period_m: float | None = None) -> Floats:
    """Length of the way through `positions` (T, …, 2), summed over the steps between the T times: (…,)."""
    steps = np.diff(unwrapped(positions, period_m), axis=0)
    return np.hypot(steps[..., 0], steps[..., 1]).sum(axis=0)


def net_displacement(positions: Floats, period_m: float | None = None) -> Floats:
    """How far the group's centre is from where it was at first, of (T, N, 2): (T,).

    The directional motion of Fine 2015, section 4.2.1, as a number; the centre's drift, not its way.
    """
    centres = centre(unwrapped(positions, period_m))
    moved = centres - centres[:1]
    return np.hypot(moved[..., 0], moved[..., 1])


def directedness(positions: Floats, period_m: float | None = None) -> float:
    """Net displacement of the group's centre over the mean length of its members' ways, of (T, N, 2).

    0: the centre ends where it began; 1: all go straight the same way. Nan where nobody moved.
    """
    way = float(path_length(positions, period_m).mean())
    return float(net_displacement(positions, period_m)[-1]) / way if way != 0.0 else np.nan


def mean_square_displacement(positions: Floats, period_m: float | None = None) -> Floats:
    """Mean over the members of the squared distance from where each was at first, of (T, N, 2): (T,), m²."""
    way = unwrapped(positions, period_m)
    return ((way - way[:1]) ** 2).sum(axis=-1).mean(axis=-1)
