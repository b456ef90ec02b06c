"""Measures of how a herd splits into groups and how members mix, in plain NumPy and SciPy.

Shapes: N members; leading axes (…, usually T times) pass through. A group is single linkage: two members are of one
group where a chain of members joins them, each link of which is at most `cut` long; a member alone is a group.
Positions must be finite. `period_m`: the side of a periodic square, None in unbounded space.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from flocking.measures.space import nearest_neighbours, tree_of
from flocking.types import Floats, Ints


def group_labels(positions: Floats, cut: float, period_m: float | None = None) -> Ints:
    """Number of the group of each member (…, N, 2): (…, N), from 0, in order of each group's first member."""
    positions = np.asarray(positions, dtype=np.float64)
    shape, count = positions.shape[:-2], positions.shape[-2]
    formations = positions.reshape(-1, count, 2)
    if formations.size == 0:
        return np.zeros((*shape, count), dtype=np.int64)
    tree = tree_of(formations, cut, period_m)
    pairs = tree.query_pairs(cut, output_type="ndarray")
    links = coo_array((np.ones(len(pairs), dtype=np.int8), (pairs[:, 0], pairs[:, 1])), shape=(tree.n, tree.n))
    _, found = connected_components(links, directed=False)
    _, firsts, numbers = np.unique(found, return_index=True, return_inverse=True)
    ranks = np.empty(len(firsts), dtype=np.int64)
    ranks[np.argsort(firsts)] = np.arange(len(firsts))
    labels = ranks[numbers].reshape(-1, count)
    return (labels - labels[:, :1]).reshape(*shape, count)


def group_sizes(labels: Ints) -> Ints:
    """Members of each group, from the labels (…, N) of `group_labels`: (…, G), zeros beyond a formation's own
    groups."""
    labels = np.asarray(labels, dtype=np.int64)
    shape, count = labels.shape[:-1], labels.shape[-1]
    flat = labels.reshape(-1, count)
    most = int(flat.max(initial=-1)) + 1
    places = flat + most * np.arange(len(flat))[:, None]
    return np.bincount(places.ravel(), minlength=most * len(flat)).reshape(*shape, most)


def largest_share(positions: Floats, cut: float, period_m: float | None = None) -> Floats:
    """Share of the members (…, N, 2) in the largest group: (…,) from 1/N (all alone) to 1 (one group)."""
    sizes = group_sizes(group_labels(positions, cut, period_m))
    return sizes.max(axis=-1) / np.asarray(positions).shape[-2]


def share_entropy(sizes: Ints) -> Floats:
    """Shannon entropy of the shares of groups of these sizes (…, G), relative to its maximum, ln(number of groups):
    (…,).

    1 where all groups are equally large; 0 for one group, which is no split. Sizes of zero are no groups.
    """
    sizes = np.asarray(sizes, dtype=np.float64)
    shares = sizes / sizes.sum(axis=-1, keepdims=True)
    entropy = -(shares * np.log(np.where(shares > 0.0, shares, 1.0))).sum(axis=-1)
    groups = (sizes > 0.0).sum(axis=-1)
    return np.where(groups > 1, entropy / np.log(np.maximum(groups, 2)), 0.0)


def split_entropy(positions: Floats, cut: float, period_m: float | None = None) -> Floats:
    """How evenly the members (…, N, 2) are split into groups: (…,), the `share_entropy` of the groups' sizes.

    Source: Fine 2015, section 6.3.2 and table 6.1 (balanced split), which does not say of what the maximum is:
    that of as many groups is our reading.
    """
    return share_entropy(group_sizes(group_labels(positions, cut, period_m)))


def mixing(positions: Floats, kinds: Ints, k: int = 1, period_m: float | None = None) -> Floats:
    """How well members (…, N, 2) of different kinds (N,) are mixed: (…,).

    The share of the members' k nearest neighbours that are of another kind than theirs, over the share expected if
    the kinds were dealt out at random. 0: each kind by itself; 1: mixed at random; above 1: they alternate. Nan where
    there is but one kind. `k` is cut to N − 1.

    Source: the nearest-neighbour statistic of Schilling 1986 (J. Am. Stat. Assoc. 81, 799-806), as one minus it and
    relative to its expectation.
    """
    kinds = np.asarray(kinds)
    count = len(kinds)
    _, sizes = np.unique(kinds, return_counts=True)
    if len(sizes) < 2:
        return np.full(np.asarray(positions).shape[:-2], np.nan)
    expected = 1.0 - float((sizes * (sizes - 1)).sum()) / (count * (count - 1))
    distances, rows = nearest_neighbours(positions, min(k, count - 1), period_m)
    others = np.where(np.isnan(distances), np.nan, kinds[rows] != kinds[:, None])
    return others.mean(axis=(-2, -1)) / expected


def neighbours_kept(positions: Floats, k: int, lag: int = 1, period_m: float | None = None) -> Floats:
    """Share of the members' k nearest neighbours that still are among them `lag` times later, of (T, N, 2):
    (T − lag,).

    1: nobody changes neighbours; k/(N − 1) on average where they are dealt anew; nan for a member alone. `k` is cut
    to N − 1.
    Source: the neighbours' overlap Q of Cavagna et al. 2013 (Proc. R. Soc. B 280, 20122484).
    """
    positions = np.asarray(positions, dtype=np.float64)
    if positions.shape[-2] < 2:
        return np.full(max(len(positions) - lag, 0), np.nan)
    distances, rows = nearest_neighbours(positions, min(k, positions.shape[-2] - 1), period_m)
    earlier, later = rows[: len(rows) - lag], rows[lag:]
    kept = (earlier[..., :, None] == later[..., None, :]).any(axis=-1)
    known = ~np.isnan(distances[: len(rows) - lag] + distances[lag:])
    return np.where(known, kept, np.nan).mean(axis=(-2, -1))
