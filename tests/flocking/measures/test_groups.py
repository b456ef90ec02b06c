"""How herds split and mix: closed forms, limits, periodic space."""

from __future__ import annotations

import numpy as np
import pytest

from flocking.measures.groups import (
    group_labels,
    group_sizes,
    largest_share,
    mixing,
    neighbours_kept,
    share_entropy,
    split_entropy,
)
from flocking.types import Floats

EXACT = 1e-12
"""Rounding of a few float64 operations on numbers of order 1."""


def _clusters(*sizes: int) -> Floats:
    """Groups of members 0.1 apart, 10 from group to group, on one line."""
    return np.array([[10.0 * group + 0.1 * member, 0.0] for group, size in enumerate(sizes) for member in range(size)])


def test_labels_name_the_groups_in_order_of_their_first_members() -> None:
    formation = _clusters(2, 3)[[2, 0, 3, 1, 4]]
    assert group_labels(formation, cut=1.0).tolist() == [0, 1, 0, 1, 0]
    both = np.stack([formation, formation[::-1]])
    assert group_labels(both, cut=1.0).tolist() == [[0, 1, 0, 1, 0], [0, 1, 0, 1, 0]]
    assert group_labels(both[:, :, None, :][:0], cut=1.0).shape == (0, 5, 1)


def test_sizes_of_formations_with_different_numbers_of_groups() -> None:
    motion = np.stack([_clusters(4, 2), _clusters(1, 2, 3), _clusters(6)])
    assert group_sizes(group_labels(motion, cut=1.0)).tolist() == [[4, 2, 0], [1, 2, 3], [6, 0, 0]]
    assert largest_share(motion, cut=1.0) == pytest.approx([4 / 6, 3 / 6, 1.0], abs=EXACT)


def test_entropy_of_shares_is_relative_to_that_of_equal_groups() -> None:
    assert share_entropy(np.array([5, 5, 5])) == pytest.approx(1.0, abs=EXACT)
    assert share_entropy(np.array([15])) == 0.0
    assert share_entropy(np.array([3, 1])) == pytest.approx((0.75 * np.log(4 / 3) + 0.25 * np.log(4)) / np.log(2))
    # a group that is not there does not count among the groups
    padded = share_entropy(np.array([[3, 1, 0], [2, 2, 0]]))
    assert padded == pytest.approx([float(share_entropy(np.array([3, 1]))), 1.0], abs=EXACT)


def test_split_entropy_does_not_know_how_many_members_there_are() -> None:
    assert split_entropy(_clusters(2, 6), cut=1.0) == pytest.approx(split_entropy(_clusters(5, 15), cut=1.0), abs=EXACT)
    assert split_entropy(_clusters(1, 1, 1, 1), cut=1.0) == pytest.approx(1.0, abs=EXACT)
    motion = np.stack([_clusters(8), _clusters(4, 4)])
    assert split_entropy(motion, cut=1.0) == pytest.approx([0.0, 1.0], abs=EXACT)


def test_thirty_per_cent_of_the_maximum_lies_between_one_and_two_of_twenty_five() -> None:
    """The balanced split of table 6.1 with 25 members and two groups: 24 + 1 is none, 23 + 2 is one."""
    assert split_entropy(_clusters(24, 1), cut=1.0) < 0.3 < split_entropy(_clusters(23, 2), cut=1.0)


def test_a_group_across_the_seam_is_one_group() -> None:
    formation = np.array([[0.2, 5.0], [9.9, 5.0], [5.0, 0.1], [5.0, 9.8]])
    assert group_sizes(group_labels(formation, cut=0.5)).tolist() == [1, 1, 1, 1]
    assert group_labels(formation, cut=0.5, period_m=10.0).tolist() == [0, 0, 1, 1]
    assert group_labels(formation + np.array([10.0, -30.0]), cut=0.5, period_m=10.0).tolist() == [0, 0, 1, 1]


def test_kinds_by_themselves_do_not_mix_and_alternating_kinds_mix_more_than_at_random() -> None:
    kinds = np.array([0, 0, 0, 1, 1, 1])
    assert mixing(_clusters(3, 3), kinds, k=2) == 0.0
    line = np.stack([np.arange(6.0) + 1e-3 * np.arange(6.0) ** 2, np.zeros(6)], axis=1)  # the left one is nearer
    alternating = np.array([0, 1, 0, 1, 0, 1])
    # all nearest neighbours are of the other kind; at random, three of the five others are
    assert mixing(line, alternating) == pytest.approx(5 / 3, abs=EXACT)


def test_mixing_with_everybody_as_neighbour_is_that_at_random() -> None:
    formation = np.random.default_rng(2).normal(size=(9, 2))
    assert mixing(formation, np.array([0, 0, 0, 0, 0, 1, 1, 1, 2]), k=99) == pytest.approx(1.0, abs=EXACT)


def test_mixing_of_kinds_dealt_at_random_is_one() -> None:
    rng = np.random.default_rng(3)
    formation, kinds = rng.uniform(0, 10, (200, 2)), np.repeat([0, 1], 100)
    found = [float(mixing(formation, rng.permutation(kinds), k=4)) for _ in range(200)]
    # four standard errors of the mean
    assert abs(np.mean(found) - 1.0) < 4.0 * np.std(found) / np.sqrt(len(found))


def test_one_kind_has_nothing_to_mix() -> None:
    assert np.isnan(mixing(np.zeros((3, 5, 2)), np.zeros(5))).all()


def test_neighbours_are_kept_by_rigid_motion_and_lost_when_partners_are_exchanged() -> None:
    pairs = np.array([[0.0, 0.0], [0.5, 0.0], [5.0, 0.0], [5.5, 0.0]])
    moved = pairs @ np.array([[0.0, 1.0], [-1.0, 0.0]]) + [7.0, 2.0]
    exchanged = pairs[[0, 2, 1, 3]]
    half = np.array([[0.0, 0.0], [0.5, 0.0], [0.0, 0.6], [0.5, -3.0]])  # of 0 and 1 the same, of 2 and 3 others
    motion = np.stack([pairs, moved, exchanged])
    assert neighbours_kept(motion, k=1) == pytest.approx([1.0, 0.0], abs=EXACT)
    assert neighbours_kept(motion, k=1, lag=2) == pytest.approx([0.0], abs=EXACT)
    assert neighbours_kept(np.stack([pairs, half]), k=1) == pytest.approx([0.5], abs=EXACT)
    assert neighbours_kept(motion, k=3) == pytest.approx([1.0, 1.0], abs=EXACT)
    assert np.isnan(neighbours_kept(motion[:, :1], k=3)).all()


def test_neighbours_across_the_seam_are_kept() -> None:
    rng = np.random.default_rng(4)
    motion = rng.uniform(0, 10, (1, 30, 2)) + np.linspace(0, 20, 7)[:, None, None]
    assert neighbours_kept(np.mod(motion, 10.0), k=5, period_m=10.0) == pytest.approx(np.ones(6))
    assert neighbours_kept(np.mod(motion, 10.0), k=5).min() < 1.0


def test_a_nan_makes_mixing_nan() -> None:
    motion = np.random.default_rng(5).normal(size=(3, 6, 2))
    motion[1, 2, 0] = np.nan
    assert np.isnan(mixing(motion, np.array([0, 0, 0, 1, 1, 1]))).tolist() == [False, True, False]
    assert np.isnan(neighbours_kept(motion, k=2)).all()
