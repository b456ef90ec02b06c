"""Whose Voronoi cells touch, by SciPy's Delaunay triangulation; what rounding decides there is decided here instead."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import Delaunay, KDTree, QhullError

from flocking.types import Bools, Floats, Ints

NEGLIGIBLE = 1e-9
"""In units of the herd's width: members nearer than this share their cell, cells that share a shorter edge do not
touch, and a herd that is narrower is a line."""
FAR = 1e6
"""In the same units: cells that meet only beyond it do not touch."""


def tessellated(positions: Floats, period_m: float = 0.0) -> Bools:
    """(N, N): whose Voronoi cells touch, of members at `positions` (N, 2); in periodic space if `period_m` is not 0.

    Cells that meet in a point only, as across the squares of a lattice, do not touch. Members on one line touch the
    next ones; coincident ones share their cells, and members at positions that are not finite have none.
    """
    count = len(positions)
    points = positions
    if period_m > 0.0:
        shifts = period_m * np.array([(x, y) for x in (0.0, 1.0, -1.0) for y in (0.0, 1.0, -1.0)])
        points = (positions[None] + shifts[:, None]).reshape(-1, 2)
    touching = np.zeros((count, count), dtype=np.bool_)
    finite = np.flatnonzero(np.isfinite(points).all(axis=1))
    if len(finite) == 0:
        return touching
    points = points[finite] - points[finite].mean(axis=0)
    points = points / max(float(np.ptp(points, axis=0).max()), 1e-300)
    places = _places(points)
    _, first = np.unique(places, return_index=True)
    edges = np.vstack([_edges(points[first]), np.tile(np.arange(len(first))[:, None], 2)])
    among = coo_array((np.ones(len(edges)), edges.T), shape=(len(first), len(first))).tocsr()
    at = coo_array((np.ones(len(places)), (np.arange(len(places)), places))).tocsr()
    pairs = (at @ (among + among.T) @ at.T).tocoo()
    one, other = finite[pairs.row], finite[pairs.col]
    own = (one < count) | (other < count)  # of two images elsewhere nothing follows
    touching[one[own] % count, other[own] % count] = True
    np.fill_diagonal(touching, False)
    return touching


def _places(points: Floats) -> Ints:
    """(N,) number of the place at which each point lies; points that coincide share one."""
    pairs = KDTree(points).query_pairs(NEGLIGIBLE, output_type="ndarray")
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(points), len(points)))
    return np.asarray(connected_components(links, directed=False)[1], dtype=np.int64)


def _edges(points: Floats) -> Ints:
    """(E, 2) pairs of different points, of unit width, whose cells share an edge."""
    spread, axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[1:]
    if len(points) >= 3 and spread[1] > NEGLIGIBLE * spread[0]:
        try:
            return _shared(points, Delaunay(points).simplices.astype(np.int64))
        except QhullError:
            pass  # flatter than Qhull can tell
    order = np.argsort(points @ axes[0])
    return np.stack([order[:-1], order[1:]], axis=1)


def _shared(points: Floats, triangles: Ints) -> Ints:
    """The edges of the triangles whose cells share more than a point, and not far away.

    The cells of an edge's ends share what lies between the centres of the circles about its triangles. From the middle
    of an edge of length a, opposite to the angle C, the centre lies a/2 · cot C inwards.
    """
    length, keys = [], []
    for k in range(3):
        a, b, c = triangles[:, k], triangles[:, (k + 1) % 3], triangles[:, (k + 2) % 3]
        to_a, to_b = points[a] - points[c], points[b] - points[c]
        across = np.maximum(np.abs(to_a[:, 0] * to_b[:, 1] - to_a[:, 1] * to_b[:, 0]), 1e-300)
        half = np.hypot(*(points[a] - points[b]).T) / 2.0
        length.append(half * np.clip((to_a * to_b).sum(axis=1) / across, -1e30, 1e30))
        keys.append(np.minimum(a, b) * len(points) + np.maximum(a, b))
    edges, which, triangles_of = np.unique(np.concatenate(keys), return_inverse=True, return_counts=True)
    total = np.bincount(which, weights=np.concatenate(length))
    kept = edges[np.where(triangles_of > 1, total > NEGLIGIBLE, total > -FAR)]
    return np.stack(np.divmod(kept, len(points)), axis=1)
