"""LCH on four Creates: what is measured of following and of seeing nobody, and what the claims make of it."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose

from flocking import selection
from flocking.types import Bools, Kind, Members
from tests.trials.made_up_run import MadeUpRun, finished
from tests.trials.simulations.robots.test_measures import NAN, trial_of
from trials import simulations
from trials.design import plan
from trials.simulations.robots import fields
from trials.simulations.robots.measures_following import followed, following
from trials.simulations.robots.resolved import Resolved
from trials.studies.crowded_horizon.figures import VARIATIONS
from trials.studies.crowded_horizon.lch_robots import claims
from trials.studies.crowded_horizon.robots_claims import THRESHOLDS
from trials.studies.crowded_horizon.robots_figures import longest_blind, most_followed
from trials.types import Group, TrialResult, Updates

AHEAD, BESIDE, NEAR_IT = (1.0, 0.0, 1), (0.0, 1.2, 2), (0.1, 1.2, 0)


def watched(law: str) -> TrialResult:
    """Three robots of that law; robot 0 sees nobody, then one member, then three of whom two stand together."""
    result = trial_of(
        [
            (1.0, 1, Kind.HOLD, 0, NAN, []),
            (2.0, 0, Kind.HOLD, 0, NAN, []),
            (3.0, 0, Kind.HOLD, 0, NAN, []),
            (4.0, 0, Kind.WAY_POINT, 1, (0.3, 0.0), [AHEAD]),
            (5.0, 0, Kind.WAY_POINT, 1, (0.2, 0.2), [AHEAD, BESIDE, NEAR_IT]),
            (6.0, 0, Kind.HOLD, 0, NAN, []),
        ],
        robots=3,
    )
    group = fields.group(law, 3)
    updates = dataclasses.replace(result.updates, input_selected=let_through(group, result.updates))
    return dataclasses.replace(result, updates=updates, trial=dataclasses.replace(result.trial, groups=(group,)))


def let_through(group: Group, updates: Updates) -> Bools:
    """(K,) the inputs that are in one of the sets of the group's law."""
    kept = np.zeros(len(updates.input_owners), dtype=np.bool_)
    for start, end in pairwise(updates.input_starts):
        positions = updates.input_positions[start:end].astype(np.float64)
        none, ids = np.full(len(positions), np.nan), updates.input_owners[start:end].astype(np.int64)
        bearings = np.arctan2(positions[:, 1], positions[:, 0])
        members = Members(positions, bearings, none, np.full((len(positions), 2), np.nan), ids)
        for steps in Resolved(group).selections:
            kept[start:end] |= selection.select(steps, members)
    return kept


@pytest.mark.parametrize(
    ("law", "whom"),
    [("lch-member-pose", [1, -1]), ("lch-group-bearing", [1, -1]), ("snn", [1, -1]), ("viscido-snn", [1, 1])],
)
def test_the_member_followed_is_the_one_selected_alone(law: str, whom: list[int]) -> None:
    result = watched(law)
    assert followed(result).tolist() == [-1, -1, -1, *whom, -1]
    assert following(result)["follow_share"] == sum(k >= 0 for k in whom) / 2


def test_without_updates_there_is_nothing_to_measure_on() -> None:
    assert all(map(math.isnan, following(trial_of([])).values()))


def test_a_group_of_one_is_followed_though_others_are_seen() -> None:
    """Bearings 90 and 84 degrees apart by 6: within 20 they are one group of two; a third robot is a group of its
    own. Of three readings on one member and one on another, the larger group is one member's."""
    result = watched("lch-group-bearing")
    updates = result.updates
    owners = updates.input_owners.copy()
    owners[updates.input_starts[4] + 1 :] = 2  # the two that stand together are one member's readings
    one = dataclasses.replace(result, updates=dataclasses.replace(updates, input_owners=owners))
    assert followed(one).tolist() == [-1, -1, -1, 1, 2, -1]


def test_the_turn_while_blind_begins_half_a_second_after_somebody_was_seen() -> None:
    blind, seeing = (Kind.HOLD, 0, NAN, []), (Kind.WAY_POINT, 1, (0.3, 0.0), [AHEAD])
    result = trial_of([(0.25 * k, 0, *(seeing if k in (0, 5) else blind)) for k in range(8)])
    poses_w = np.zeros((8, 3))
    poses_w[:, 2] = [0.0, 1.0, 3.1, -3.1, -3.0, 0.0, 0.0, 0.02]  # over the half turn from 3.1 to -3.1
    updates = dataclasses.replace(result.updates, poses_w=poses_w)
    found = following(dataclasses.replace(result, updates=updates))["blind_turn_rad_s"]
    half_turn = 2.0 * math.pi - 6.2
    # from the updates 2, 3 and 4; update 7, half a second after 5, has no next one
    assert_allclose(found, (half_turn + 0.1 + 3.0) / 0.75)
    assert math.isnan(following(trial_of([]))["blind_turn_rad_s"])


def test_the_drawn_moments() -> None:
    result = watched("viscido-snn")
    assert longest_blind(result) == (0, 2.0, 3.0)
    time, pairs = most_followed(result)
    assert pairs == {0: 1}
    assert time == 4.0


def test_the_plan_is_forty_trials_on_the_open_floor_and_twenty_with_other_thresholds() -> None:
    made = plan("lch-robots")
    assert len(made.trials) == 60
    assert [len([t for t in made.trials if t.conditions.get(key) == value]) for key, value in THRESHOLDS.values()] == [
        10,
        10,
    ]
    assert {trial.groups[0].law for trial in made.trials} == set(VARIATIONS)
    assert all(trial.groups[0].law_parameters["keeps_direction"] is True for trial in made.trials)
    assert all(
        (trial.world, trial.formation, trial.groups[0].count) == ("open-floor", "single-group", 4)
        for trial in made.trials
    )


def run_of(measures: Callable[[str], dict[str, float]]) -> MadeUpRun:
    return finished(plan("lch-robots").trials, lambda trial: measures(trial.groups[0].law), seed=2, spread=0.001)


def laid_down(law: str) -> dict[str, float]:
    follows = 0.9 if "group" in law else 0.1
    motion = {"mmd": 0.5, "polarization": 0.8, "group_speed": 0.2, "net_displacement": 5.0, "largest_share": 0.9}
    return motion | {"blind_turn_rad_s": 0.01, "none_share": 0.2, "follow_share": follows, "straightness": 0.5}


def test_alike_variations_that_follow_uphold_all_claims() -> None:
    assert [entry.agrees for entry in claims(run_of(laid_down))] == 6 * [True]


def test_one_variation_that_differs_in_one_measure_is_found() -> None:
    def faster(law: str) -> dict[str, float]:
        return laid_down(law) | ({"group_speed": 0.05} if law == "lch-group-pose" else {})

    same, *others = claims(run_of(faster))
    assert same.agrees is False
    assert "group speed" in same.quantity
    assert all(entry.agrees for entry in others)


def test_group_centric_variations_that_follow_no_more_than_others_do_not_uphold_it() -> None:
    entries = claims(run_of(lambda law: laid_down(law) | {"follow_share": 0.9, "blind_turn_rad_s": 0.5}))
    assert [entry.agrees for entry in entries] == [True, *5 * [False]]


def test_four_creates_for_a_moment() -> None:
    """Bearings spread over more than the splitting threshold: the first way-points are each made from one member."""
    trial = plan("lch-robots", settings={"duration_s": 2.0, "herd.law": "lch-group-bearing"}).trials[0]
    result = simulations.run_trial(trial, reraise=True)
    assert result.measures["largest_share"] == 1.0
    assert 0.0 < result.measures["follow_share"] <= 1.0
