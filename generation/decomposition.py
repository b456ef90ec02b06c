"""Primitives cut out of a known construct, and sorted by what each makes a herd do on its own.

Source: Fine 2015, section 8.1.1, which proposes it and does not do it. Directed: an expert names the regions.
Undirected: a window slides along the construct, and the pieces are clustered by the behaviour that they elicit. Each
piece stays in its place in the workspace, alone. Metres and radians, world frame.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from flocking.errors import InputError
from flocking.measures.groups import group_labels
from flocking.types import Floats, Ints
from generation.environment import Environment
from generation.group import Group, Job
from generation.primitives import Polygon, Polyline, Primitive, Segment, places
from generation.validation.starts import Starts, axis, mirrored, poses
from generation.validation.validate import empty

JOINED_M = 1e-6
"""Primitives of a construct whose ends are this near are one fence. A choice."""
MOST_PIECES = 1000
"""A choice: clustering compares each with each."""
LEAST_PIECE_M = 1e-3
"""Shorter pieces are none. A choice."""
STRUCTURE = 0.5
"""Mean silhouette from which there are clusters at all: Kaufman & Rousseeuw 1990, table 4: reasonable structure."""
MOST_CLUSTERS = 8
"""A choice."""
START_SEED, MEMBERS_SEED = range(2)


class Piece(NamedTuple):
    """A part of a construct."""

    primitives: tuple[Primitive, ...]
    name: str
    """Of a region; of a window the fence and the metres along it, as in `fence 1, 0.5 to 1.5 m`."""

    @property
    def length_m(self) -> float:
        """Length of its fence."""
        return Environment(construct=self.primitives).fence_length()


class Feature(NamedTuple):
    """One number that tells what a herd did."""

    name: str
    unit: str
    finest: float
    """What is no difference, however little it varies between starts. A choice."""


FEATURES = (
    Feature("forward_m", "m", 0.05),
    Feature("left_m", "m", 0.05),
    Feature("course_cos", "", 0.02),
    Feature("course_sin", "", 0.02),
    Feature("spread_m", "m", 0.05),
    Feature("groups", "", 0.1),
)
"""Of one simulation: displacement of the centre from the start on along the marker `start` and to its left; cosine and
sine of the centre's final course from that direction, each times the share of the centre's way that is not lost in
turning (0 of a herd that mills); root mean square distance from the centre at the end; groups at the end."""
LAST = 0.1
"""Share of the moments over which the final course is taken. A choice."""


class Elicited(NamedTuple):
    """What n pieces and the empty workspace make a herd do in K simulations of the same starts and random numbers."""

    each: Floats
    """(n, K, F)."""
    empty: Floats
    """(K, F) of the workspace without the construct."""

    @property
    def means(self) -> Floats:
        """(n, F)."""
        return np.asarray(self.each.mean(axis=1))

    @property
    def effects(self) -> Floats:
        """(n, F) means less those of the empty workspace."""
        return np.asarray(self.means - self.empty.mean(axis=0))

    @property
    def finest(self) -> Floats:
        """(F,) what is no difference."""
        return np.array([feature.finest for feature in FEATURES])

    @property
    def scales(self) -> Floats:
        """(F,) what counts as one: the standard error of a mean, pooled over the pieces, or `finest`."""
        count = self.each.shape[1]
        pooled = self.each.var(axis=1, ddof=1).mean(axis=0) if count > 1 else np.zeros(len(FEATURES))
        return np.asarray(np.maximum(np.sqrt(pooled / count), self.finest))


class Clusters(NamedTuple):
    """Pieces that elicit alike."""

    labels: Ints
    """(n,) from 0, in the order of each cluster's first piece."""
    medoids: Ints
    """(C,) of each cluster, the piece with the least sum of distances to its others: its primitive."""
    silhouettes: Floats
    """(M,) mean silhouette of 2, 3, … clusters."""


def chains(construct: Sequence[Primitive]) -> list[Floats]:
    """The fences of a construct as places (K + 1, 2): primitives whose end is the next one's beginning are joined."""
    found: list[Floats] = []
    for primitive in construct:
        along = places(primitive)
        if found and math.dist(found[-1][-1], along[0]) <= JOINED_M:
            found[-1] = np.vstack([found[-1], along[1:]])
        else:
            found.append(along)
    return found


def windows(construct: Sequence[Primitive], window_m: float, stride_m: float) -> list[Piece]:
    """Undirected: pieces of that length along each fence, one every `stride_m`, and one that ends where the fence does.

    A fence that is shorter is one piece. Raises `InputError` for no construct and for too many pieces.
    """
    if not window_m > 0.0 or not stride_m > 0.0:
        raise InputError(f"window {window_m:g} m, stride {stride_m:g} m: expected both above 0")
    fences = [(along, _arc_lengths(along)) for along in chains(construct)]
    total = sum(lengths[-1] / stride_m + 1 for _, lengths in fences)
    if not fences or total > MOST_PIECES:
        least = sum(lengths[-1] for _, lengths in fences) / MOST_PIECES
        told = f"expected a stride of {least:.3g} m or more" if fences else "expected a construct"
        raise InputError(f"window {window_m:g} m, stride {stride_m:g} m: {total:.0f} pieces; {told}")
    found = []
    for number, (along, lengths) in enumerate(fences, 1):
        last = max(lengths[-1] - window_m, 0.0)
        begins = [*np.arange(0.0, last - 1e-9, stride_m).tolist(), last]
        for begin in begins:
            end = min(begin + window_m, float(lengths[-1]))
            if end - begin >= LEAST_PIECE_M:
                name = f"fence {number}, {begin:.3g} to {end:.3g} m"
                found.append(Piece((_between(along, lengths, begin, end),), name))
    return found


def regions(construct: Sequence[Primitive], areas: Mapping[str, Polygon]) -> list[Piece]:
    """Directed: what lies of the construct in each of these areas. Raises `InputError` for an area without any."""
    from shapely import LineString, MultiLineString, get_parts, intersection, line_merge
    from shapely import Polygon as Area

    fences = MultiLineString([LineString(along) for along in chains(construct)])
    found = []
    for name, area in areas.items():
        inside = intersection(fences, Area(area.corners_m))
        merged = line_merge(inside) if inside.geom_type == "MultiLineString" else inside
        lines = [part for part in get_parts(merged) if part.geom_type == "LineString" and part.length >= LEAST_PIECE_M]
        if not lines:
            raise InputError(f"region {name!r} holds nothing of the construct: expected one that it passes through")
        found.append(Piece(tuple(_primitive(np.asarray(line.coords, np.float64)) for line in lines), name))
    return found


def elicited(
    pieces: Sequence[Piece], whole: Environment, group: Group, starts: Starts, simulations: int, iterations: int,
    cut_m: float, seed: Sequence[int], told: Callable[[int], None] = lambda done: None,
) -> Elicited:  # fmt: skip
    """What the pieces of an environment's construct make a herd do, each alone in its workspace, and without any.

    Starts come in mirrored pairs, as in a search. `cut_m`: members farther apart are of different groups.
    `told` is told of each simulation.
    """
    alone = [dataclasses.replace(whole, construct=piece.primitives) for piece in pieces]
    alone.append(empty(whole))
    jobs = []
    for environment in alone:
        for k in range(simulations):
            rng = np.random.default_rng([*seed, k // 2, START_SEED])
            placed = poses(alone[-1], group.count, starts, rng)
            placed = mirrored(placed, axis(whole)) if k % 2 else placed
            jobs.append(Job(environment, placed, (*seed, k // 2, MEMBERS_SEED)))
    heading = axis(whole).heading_rad
    rows = []
    for way in group.trajectories(jobs, iterations):
        rows.append(features(way, heading, cut_m))
        told(len(rows))
    each = np.array(rows).reshape(len(alone), simulations, len(FEATURES))
    return Elicited(each[:-1], each[-1])


def features(positions: Floats, heading_rad: float, cut_m: float) -> Floats:
    """(F,) the `FEATURES` of members at positions (T, N, 2) that were to go in a direction."""
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    to_start = np.array([[c, s], [-s, c]])
    centres = positions.mean(axis=1)
    forward, left = to_start @ (centres[-1] - centres[0])
    late = centres[-max(2, math.ceil(LAST * len(centres))) :]
    course = to_start @ (late[-1] - late[0])
    way = float(np.hypot(*np.diff(late, axis=0).T).sum())
    cos, sin = course / way if way > 0.0 else (0.0, 0.0)
    off = positions[-1] - centres[-1]
    groups = int(group_labels(positions[-1], cut_m).max()) + 1
    return np.array([forward, left, cos, sin, math.sqrt(float((off**2).sum(axis=1).mean())), groups])


def clustered(means: Floats, scales: Floats) -> Clusters:
    """Clusters of pieces by their features (n, F), each over its scale (F,): average linkage, Euclidean distances.

    Their number is that of the largest mean silhouette (Rousseeuw 1987), from 2 to `MOST_CLUSTERS`; where that is
    below `STRUCTURE`, or there are fewer than three pieces, all are one cluster.
    """
    from scipy.cluster.hierarchy import fcluster, linkage
    from scipy.spatial.distance import pdist, squareform

    count = len(means)
    if count == 0:
        raise InputError("no pieces: expected at least one")
    apart = pdist(means / scales)
    distances = squareform(apart) if count > 1 else np.zeros((1, 1))
    best, labels, silhouettes = STRUCTURE, np.zeros(count, np.int64), []
    if count > 2:
        tree = linkage(apart, method="average")
        for number in range(2, min(MOST_CLUSTERS, count - 1) + 1):
            tried = np.asarray(fcluster(tree, number, criterion="maxclust"), np.int64)
            silhouettes.append(silhouette(distances, tried))
            if silhouettes[-1] > best:
                best, labels = silhouettes[-1], tried
    _, firsts, numbers = np.unique(labels, return_index=True, return_inverse=True)
    labels = np.argsort(np.argsort(firsts))[numbers]
    medoids = []
    for label in range(labels.max() + 1):
        members = np.flatnonzero(labels == label)
        medoids.append(members[np.argmin(distances[np.ix_(members, members)].sum(axis=1))])
    return Clusters(labels, np.array(medoids), np.array(silhouettes))


def silhouette(distances: Floats, labels: Ints) -> float:
    """Mean over n members of (b - a) / max(a, b), from distances (n, n): a = mean distance to the others of its
    cluster, b = least mean distance to another cluster's. 0 of a member that is alone, and where there is one cluster.
    """
    kinds = np.unique(labels)
    if len(kinds) < 2:
        return 0.0
    sums = np.column_stack([distances[:, labels == kind].sum(axis=1) for kind in kinds])
    sizes = np.array([(labels == kind).sum() for kind in kinds])
    own = np.searchsorted(kinds, labels)
    rows = np.arange(len(labels))
    inside = sums[rows, own] / np.maximum(sizes[own] - 1, 1)
    outside = sums / sizes
    outside[rows, own] = np.inf
    nearest = outside.min(axis=1)
    widest = np.maximum(inside, nearest)
    each = np.where((sizes[own] > 1) & (widest > 0.0), (nearest - inside) / np.where(widest > 0.0, widest, 1.0), 0.0)
    return float(each.mean())


def _arc_lengths(along: Floats) -> Floats:
    return np.append(0.0, np.cumsum(np.hypot(*np.diff(along, axis=0).T)))


def _between(along: Floats, lengths: Floats, begin: float, end: float) -> Primitive:
    """The part of places (K + 1, 2) between two arc lengths."""
    ends = np.column_stack([np.interp([begin, end], lengths, along[:, axis]) for axis in (0, 1)])
    inner = along[(lengths > begin + JOINED_M) & (lengths < end - JOINED_M)]
    return _primitive(np.vstack([ends[:1], inner, ends[1:]]))


def _primitive(along: Floats) -> Primitive:
    if len(along) == 2:
        return Segment(*along.ravel().tolist())
    return Polyline(tuple((x, y) for x, y in along.tolist()))
