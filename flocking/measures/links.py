"""Links between members that see one another, and the link tension index.

Source: Akama & Naruse 2014, equations 2 and 6 to 8, tables 1 and 2. N members, L links; metres, m/s, s, and any unit
of mass with the stiffness in that unit per s². `period_m`: the side of a periodic square, None in unbounded space.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flocking.measures.space import shortest, tree_of
from flocking.types import Bools, Floats, Ints


class Outcomes(NamedTuple):
    """Numbers of links by what became of them and what the index had said: a row of tables 1 and 2 each."""

    broken_broken: int
    """Broke, as predicted."""
    broken_predicted_intact: int
    intact_predicted_broken: int
    intact_intact: int
    """Held, as predicted."""


def links_within(positions: Floats, range_m: float, period_m: float | None = None) -> Ints:
    """Pairs of members (N, 2) at most `range_m` apart (equation 2): (L, 2) rows i < j, sorted."""
    formation = np.asarray(positions, dtype=np.float64).reshape(1, -1, 2)
    if formation.size == 0:
        return np.zeros((0, 2), dtype=np.int64)
    pairs = tree_of(formation, range_m, period_m).query_pairs(range_m, output_type="ndarray")
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))].astype(np.int64)


def link_lengths(positions: Floats, links: Ints, period_m: float | None = None) -> Floats:
    """Lengths of the links (L, 2) between members (N, 2): (L,)."""
    gaps = shortest(positions[links[:, 1]] - positions[links[:, 0]], period_m)
    return np.hypot(gaps[:, 0], gaps[:, 1])


def link_tension(
    positions: Floats,
    velocities: Floats,
    links: Ints,
    range_m: float,
    rest_m: float,
    mass: float = 1.0,
    stiffness: float = 1.0,
    period_m: float | None = None,
) -> Floats:
    """The index of each link (L, 2) between members (N, 2): (L,), how far beyond `range_m` its spring would stretch.

    Rest length plus greatest elongation less range (equation 8); positive: the link is predicted to break. The
    greatest elongation is the root of elongation² + (mass / stiffness) · (speed along the link)² (equation 6, whose
    Δd is read, with the text, as the whole elongation and not as what is added to the present one). Equation 7 as
    printed drops mass / stiffness: the defaults. Exact for two undamped members on one spring if `mass` is their
    reduced mass, half the mass of one.

    Of members at one point the link has no direction: all of their relative speed counts.
    """
    gaps = shortest(positions[links[:, 1]] - positions[links[:, 0]], period_m)
    speeds = velocities[links[:, 1]] - velocities[links[:, 0]]
    lengths = np.hypot(gaps[:, 0], gaps[:, 1])
    apart = lengths > 0.0
    along = (gaps * speeds).sum(axis=1) / np.where(apart, lengths, 1.0)
    along = np.where(apart, along, np.hypot(speeds[:, 0], speeds[:, 1]))
    return rest_m + np.hypot(lengths - rest_m, np.sqrt(mass / stiffness) * along) - range_m


def link_outcomes(index: Floats, broken: Bools) -> Outcomes:
    """The contingency of the index (L,) at one time and of which links (L,) were broken at a later one.

    A positive index predicts breaking; zero predicts that the link holds (the range includes its limit).
    """
    predicted, broken = np.asarray(index) > 0.0, np.asarray(broken, dtype=np.bool_)
    counts = (predicted & broken, ~predicted & broken, predicted & ~broken, ~predicted & ~broken)
    return Outcomes(*(int(count.sum()) for count in counts))
