"""Hamilton's model with merging: who is of one group, which group moves and where, and that one is left."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from flocking import lawentry
from flocking.kinematic import Band, Schedule, simulate, start_uniform
from flocking.laws.hamilton_merging import nearest_group, number_groups
from flocking.types import NO_OBSTACLES, Kind, Motion, Own, members_at

EXACT = 1e-12
OWN = Own(np.zeros(2), 0.0, math.nan, np.full(2, math.nan), np.zeros(2, dtype=bool), 1.0, 0, 0)


def decide(positions: Any, **given: float) -> Motion:
    law = lawentry.load("hamilton-merging")
    members = members_at(np.array(positions, dtype=np.float64).reshape(-1, 2))
    sets = np.ones((1, len(members.ids)), dtype=bool)
    return law.function(OWN, members, sets, NO_OBSTACLES, law.parameters(given), np.zeros(0), np.zeros(0))


def rule(motion: Motion) -> str:
    return lawentry.load("hamilton-merging").rules[motion.rule]


def test_groups_are_chains_of_links() -> None:
    positions = np.array([[2.9, 0.0], [5.8, 0.0], [9.0, 0.0], [-20.0, 0.0], [-20.0, 2.0]])
    numbers = np.empty(5, np.int64)
    assert number_groups(positions, np.ones(5, dtype=bool), 3.0, numbers) == 3
    assert numbers.tolist() == [0, 0, 1, 2, 2]
    assert nearest_group(positions, numbers) == 1


def test_who_was_not_chosen_belongs_to_no_group_and_joins_none() -> None:
    positions, numbers = np.array([[2.9, 0.0], [5.8, 0.0]]), np.empty(2, np.int64)
    assert number_groups(positions, np.array([False, True]), 3.0, numbers) == 2
    assert numbers.tolist() == [-1, 1]


def test_far_from_its_nearest_neighbour_it_is_hamiltons_model() -> None:
    motion = decide([[0.0, 2.1], [50.0, 0.0]])
    assert rule(motion) == "snn"
    assert (motion.x, motion.y) == pytest.approx((0.0, 1.0), abs=EXACT)


def test_the_smaller_group_moves_a_body_length_from_its_middle_towards_the_others() -> None:
    motion = decide([[0.0, 1.0], [30.0, 0.5], [31.0, 0.5], [32.0, 0.5]])
    assert rule(motion) == "merge"
    assert (motion.x, motion.y) == pytest.approx((1.0, 0.0), abs=EXACT)


def test_the_larger_group_waits_and_equal_ones_both_move() -> None:
    assert decide([[0.0, 1.0], [1.0, 0.0], [30.0, 0.0], [31.0, 0.0]]).kind == Kind.STOP
    assert rule(decide([[0.0, 1.0], [30.0, 0.0], [31.0, 0.0]])) == "merge"


def test_the_nearest_group_counts_not_the_largest() -> None:
    near_pair, far_crowd = [[0.0, -10.0], [0.0, -11.0]], [[40.0 + k, 0.0] for k in range(5)]
    motion = decide([[0.0, 1.0], *near_pair, *far_crowd])
    assert (motion.x, motion.y) == pytest.approx((0.0, -1.0), abs=EXACT)


def test_one_group_rests() -> None:
    motion = decide([[0.0, 1.0], [1.0, 0.0]])
    assert (motion.kind, rule(motion)) == (Kind.STOP, "rest")


def test_a_herd_ends_as_one_group_where_the_model_without_merging_leaves_many() -> None:
    starts = start_uniform(40, 4.0 * math.sqrt(40.0), np.random.default_rng(3))
    groups = {}
    for name in ("hamilton-2d", "hamilton-merging"):
        band = Band(lawentry.load(name), 40)
        end = simulate(band, starts, Schedule(1.0, 150, every=150), rng=np.random.default_rng(0)).positions_w[-1]
        numbers = np.empty(39, np.int64)
        groups[name] = number_groups(end[1:] - end[0], np.ones(39, dtype=bool), 3.0, numbers)
    assert groups["hamilton-merging"] == 1
    assert groups["hamilton-2d"] > 5
