"""Measures of a group's formation and motion, in plain NumPy and SciPy.

Shapes: N members; leading axes (…, usually T times) pass through: a formation (N, 2) gives a number, a motion
(T, N, 2) gives (T,). Lengths in metres (any one unit will do), angles in radians. A nan among the members
makes the measure nan.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from flocking.types import Floats, Ints


def polarization(headings: Floats) -> Floats:
    """Length of the mean of the unit vectors along `headings` (…, N): (…,) from 0 (cancelling) to 1 (one
    heading).

    One minus it is the circular variance. Source: Vicsek et al. 1995, the order parameter.
    """
    headings = np.asarray(headings, dtype=np.float64)
    return np.hypot(np.cos(headings).mean(axis=-1), np.sin(headings).mean(axis=-1))


def group_speed(velocities: Floats) -> Floats:
    """Speed of the group's centre: length of the mean of `velocities` (…, N, 2): (…,)."""
    mean = np.asarray(velocities, dtype=np.float64).mean(axis=-2)
    return np.hypot(mean[..., 0], mean[..., 1])


def mmd(positions: Floats) -> Floats:
    """Median distance of the members (…, N, 2) from the group's centre, their mean position: (…,).

    Source: Fine 2015, section 4.3 and table 4.1, after Viscido et al. 2002.
    """
    positions = np.asarray(positions, dtype=np.float64)
    from_centre = positions - positions.mean(axis=-2, keepdims=True)
    return np.median(np.hypot(from_centre[..., 0], from_centre[..., 1]), axis=-1)


def nearest_neighbour_distance(positions: Floats) -> Floats:
    """Distance of each member (…, N, 2) to the member nearest to it: (…, N); nan for a member alone.

    All pairs are formed: for formations of up to some hundred members.
    """
    positions = np.asarray(positions, dtype=np.float64)
    count = positions.shape[-2]
    if count < 2:
        return np.full(positions.shape[:-1], np.nan)
    gaps = positions[..., :, None, :] - positions[..., None, :, :]
    distances = np.hypot(gaps[..., 0], gaps[..., 1])
    distances[..., np.arange(count), np.arange(count)] = np.inf
    return distances.min(axis=-1)


def number_of_groups(positions: Floats, cut: float) -> Ints:
    """Number of groups among the members (…, N, 2): (…,).

    Single linkage: two members are of one group where a chain of members joins them, each link of which is at
    most `cut` long. A member alone is a group. Positions must be finite.
    """
    positions = np.asarray(positions, dtype=np.float64)
    shape, count = positions.shape[:-2], positions.shape[-2]
    flat = positions.reshape(-1, count, 2)
    frames = len(flat)
    if frames == 0 or count == 0:
        return np.zeros(shape, dtype=np.int64)
    # All formations at once: each stands in a plane of its own, farther from the next than any link.
    planes = np.broadcast_to((2.0 * cut + 1.0) * np.arange(frames)[:, None, None], (frames, count, 1))
    points = np.concatenate([flat, planes], axis=2).reshape(-1, 3)
    pairs = cKDTree(points).query_pairs(cut, output_type="ndarray")
    links = coo_array((np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])), shape=(len(points),) * 2)
    _, labels = connected_components(links, directed=False)
    _, firsts = np.unique(labels, return_index=True)
    return np.bincount(firsts // count, minlength=frames).astype(np.int64).reshape(shape)


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


def path_length(positions: Floats) -> Floats:
    """Length of the way through `positions` (T, …, 2), summed over the steps between the T times: (…,)."""
    steps = np.diff(np.asarray(positions, dtype=np.float64), axis=0)
    return np.hypot(steps[..., 0], steps[..., 1]).sum(axis=0)
