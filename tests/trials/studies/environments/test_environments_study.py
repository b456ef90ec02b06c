"""Verdicts on group size with Creates, on the stages of cattle and on tightness follow from what trials measure."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy import stats

from generation import found
from tests.trials.studies.judged import verdicts
from trials import design
from trials.simulations.robots.fields import environment_of
from trials.studies.environments import herding, tightness_claims
from trials.studies.environments.tightness_claims import Counts, counted


def of_creates(group: float, alone: float, empty: float) -> Any:
    def measures(conditions: Mapping[str, Any]) -> dict[str, float]:
        if not conditions["world.construct"]:
            return {"elicited": empty if conditions["herd.count"] == 4 else 0.0}
        return {"elicited": group if conditions["herd.count"] == 4 else alone}

    return measures


def test_size_decides_where_four_are_corralled_and_one_is_not() -> None:
    assert verdicts("corral-group-size-robots", of_creates(1.0, 0.0, 0.0)) == [True] * 4
    assert verdicts("corral-group-size-robots", of_creates(1.0, 1.0, 0.0)) == [False] * 4
    assert verdicts("corral-group-size-robots", of_creates(0.0, 1.0, 0.0)) == [True, False] * 2


def test_four_that_are_corralled_without_a_construct_show_nothing_of_size() -> None:
    assert verdicts("corral-group-size-robots", of_creates(1.0, 0.0, 1.0)) == [True, False] * 2


def test_trials_of_a_repeat_share_their_environment_and_the_control_has_no_construct() -> None:
    trials = design.plan("corral-group-size-robots", repeats=2).trials
    assert len(trials) == 16
    for repeat in (1, 2):
        assert len({trial.world_source for trial in trials if trial.repeat == repeat}) == 1
    assert trials[0].world_source != trials[-1].world_source
    for trial in trials:
        assert bool(environment_of(trial).construct) is trial.conditions["world.construct"]
        assert trial.setup["duration_s"] == 500 * trial.conditions["behaviour.iteration_s"]
        assert trial.groups[0].count == trial.conditions["herd.count"]


def test_a_stage_is_elicited_where_it_exceeds_its_control() -> None:
    def measures(conditions: Mapping[str, Any]) -> dict[str, float]:
        both = {"stage_1": 0.9, "control_stage_1": 0.2, "stage_2": 0.5, "control_stage_2": 0.5}
        return {**both, "stage_3": 0.6 if conditions["varied"] else 0.1, "control_stage_3": 0.1}

    assert verdicts("cattle-stages", measures) == [True, False, False, False, True, False, True, False]


def test_cattle_are_two_classes_and_nothing_but_their_distance_from_walls_differs() -> None:
    (trial, *_) = design.plan("cattle-stages", repeats=1).trials
    tame, shy = trial.groups
    assert (tame.law, tame.law_parameters, tame.count) == (shy.law, shy.law_parameters, shy.count)
    assert {key for key in tame.setup if tame.setup[key] != shy.setup[key]} == {"margin_m", "look_ahead_m"}


@pytest.mark.parametrize("schema", found.schemas())
def test_each_schema_has_a_herd(schema: str) -> None:
    (trial,) = [each for each in design.plan("tightness", repeats=1).trials if each.world == schema]
    assert trial.setup["behaviour"] == found.load(schema).behaviour
    assert len(trial.groups) == (2 if schema == "cattle" else 1)
    assert trial.groups[0].count == herding.herding(schema).groups[0].count


def row(**measures: float) -> Any:
    return SimpleNamespace(measures=measures)


def test_environments_of_all_trials_are_counted_together() -> None:
    one = row(generated=100.0, passed=50.0, valid=20.0, gained=0.3, lost=0.1)  # 15 gained, 5 lost, 5 both, 25 neither
    none = row(generated=100.0, passed=0.0, valid=0.0, gained=float("nan"), lost=float("nan"))
    assert counted([one, one, none]) == Counts(300, 10, 30, 10, 50)
    counts = counted([one, one, none])
    assert counts.tightness().rate == pytest.approx(40 / 300)
    assert counts.valid().rate == pytest.approx(0.4)
    assert counts.control().rate == pytest.approx(0.2)
    assert counts.uplift().uplift == pytest.approx(0.2)


def test_p_values_are_those_of_the_score_test_behind_wilsons_interval() -> None:
    outcome = tightness_claims._tightness(Counts(1000, 3, 15, 2, 980))
    z = (0.018 - 0.01) / np.sqrt(0.01 * 0.99 / 1000)
    assert outcome.decision.p_holds == pytest.approx(2.0 * stats.norm.sf(z), rel=1e-4)
    assert outcome.decision.agrees is True
    assert outcome.decision.low > 0.01


@pytest.mark.parametrize(
    ("counts", "tight", "uplift"),
    [
        (Counts(1000, 0, 300, 0, 700), True, True),
        (Counts(1000, 500, 0, 0, 500), True, False),
        (Counts(1000, 400, 20, 120, 460), True, False),
        (Counts(1000, 0, 0, 0, 1000), False, False),
        (Counts(200, 0, 3, 0, 197), None, None),
    ],
)
def test_tightness_alone_says_nothing_of_constructs(counts: Counts, tight: bool | None, uplift: bool | None) -> None:
    assert tightness_claims._tightness(counts).decision.agrees is tight
    assert tightness_claims._uplift(counts).decision.agrees is uplift
