"""The verdicts of the searches' claims follow from what their trials measure."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from tests.trials.studies.judged import verdicts
from trials import design
from trials.simulations.robots.fields import environment_of
from trials.simulations.robots.starts import starting_poses
from trials.studies.searches import optimise_transfer
from trials.studies.searches.pieces_claims import REGIONS


def of_search(better: float) -> Any:
    def measures(conditions: Mapping[str, Any]) -> dict[str, float]:
        informed = conditions["method"] != "random"
        more = better if informed else 0.0
        return {
            "best": 0.8 + more, "mean_best": 0.6 + more, "robust_points": 0.1 + more, "robust_cells": 5.0 + 50.0 * more,
            "uplift": 0.3 + more,
        }  # fmt: skip

    return measures


def test_searches_that_are_better_than_random_hold_all_claims() -> None:
    assert verdicts("optimise", of_search(0.1)) == [True] * 5
    assert verdicts("optimise-points", of_search(0.1)) == [True] * 4


def test_searches_that_are_no_better_hold_none() -> None:
    assert verdicts("optimise", of_search(0.0)) == [False] * 5
    assert verdicts("optimise-points", of_search(0.0)) == [False, False, False, True]  # they still beat an empty world


def test_decompositions_are_judged_by_their_clusters_and_by_what_acts() -> None:
    def measures(conditions: Mapping[str, Any]) -> dict[str, float]:
        return {"clusters": 3.0, "active_share": 0.5 if conditions[REGIONS] else 0.0}

    assert verdicts("decompose", measures) == [True, True]
    assert verdicts("decompose", lambda conditions: {"clusters": 1.0, "active_share": 0.0}) == [None, False]


def test_trials_of_a_repeat_have_the_same_starts_whatever_the_method() -> None:
    trials = design.plan("optimise", repeats=2).trials
    assert len({(trial.seed, trial.repeat) for trial in trials}) == 2
    assert {trial.conditions["method"] for trial in trials} == {"random", "cma-es", "cma-me", "map-elites"}


def test_elites_are_tried_with_their_wall_and_without_from_the_same_start() -> None:
    trials = design.plan("optimise-transfer", repeats=2).trials
    assert len(trials) == 4
    for trial in trials:
        environment = environment_of(trial)
        assert len(environment.construct) == (1 if trial.conditions["world.wall"] else 0)
        if environment.construct:
            wall = optimise_transfer.elites()[trial.repeat - 1]
            assert environment.fence_length() == pytest.approx(wall["length_m"])
    for repeat in (1, 2):
        starts = [starting_poses(trial) for trial in trials if trial.repeat == repeat]
        np.testing.assert_array_equal(*starts)


def test_transfer_is_judged_beside_the_junction_alone() -> None:
    def measures(conditions: Mapping[str, Any]) -> dict[str, float]:
        return {"fitness": 0.8 if conditions["world.wall"] else 0.5, "elicited": 0.3}

    assert verdicts("optimise-transfer", measures) == [False, True]
