"""A search and a decomposition are trials: planned, checked and run as all others, and their tables give them back."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from flocking.errors import InputError
from trials import keys, simulations
from trials.batch import series
from trials.simulations.searches import fields, loop, measures
from trials.studies.searches import decompose, design, optimise, optimise_points
from trials.types import Trial, TrialResult, with_setup

SMALL = {"search.budget": 60, "search.pairs": 2, "search.best_pairs": 2, "search.elite_pairs": 1, "iterations": 120}
FEW = {"pieces.pairs": 2, "pieces.window_m": 3.0, "pieces.stride_m": 3.0, "iterations": 60}


def small(method: str = "cma-es", **setup: object) -> Trial:
    made = fields.trial("t", 1, [design.herd(3)], "dirt")
    return with_setup(made, {**SMALL, "method": method, **setup})  # type: ignore[dict-item]


def few(**setup: object) -> Trial:
    made = fields.trial("t", 1, [design.herd(3)], "race", method=fields.DECOMPOSITION)
    return with_setup(made, {**FEW, **setup})  # type: ignore[dict-item]


@pytest.fixture(scope="module")
def result() -> TrialResult:
    return simulations.run_trial(small(), reraise=True)


def test_the_same_trial_gives_the_same_search(result: TrialResult) -> None:
    again = simulations.run_trial(small(), reraise=True)
    assert dict(again.measures) == dict(result.measures)
    for name, table in result.tables.items():
        np.testing.assert_array_equal(again.tables[name], table)
    other = simulations.run_trial(dataclasses.replace(small(), repeat=2), reraise=True)
    assert not np.array_equal(other.tables["parameters"], result.tables["parameters"])


def test_the_budget_is_kept_and_measured(result: TrialResult) -> None:
    assert set(result.measures) == set(measures.OF_SEARCH)
    assert result.measures["points"] == 15
    assert result.measures["simulations"] == 60
    assert len(result.tables["robustness"]) == 15


def test_tables_come_back_and_give_the_curve(result: TrialResult) -> None:
    back = series.unpack(series.pack(result)).tables
    simulated, best = loop.curve_of(result.trial, back)
    assert simulated.tolist() == list(range(4, 64, 4))
    assert best[-1] == result.measures["best"]
    assert best.mean() == pytest.approx(result.measures["mean_best"])
    seen = np.maximum.accumulate(back["robustness"])
    assert seen[-1] == result.measures["best_seen"]
    assert len(back["construct"]) == 1
    assert result.measures["fence"] == pytest.approx(np.hypot(*(back["construct"][0, 2:] - back["construct"][0, :2])))


def test_all_methods_have_the_same_archive_and_the_same_control() -> None:
    """What the methods are compared by does not depend on them."""
    found = [simulations.run_trial(small(method, iterations=20), reraise=True) for method in ("random", "cma-me")]
    np.testing.assert_array_equal(found[0].tables["bounds"], found[1].tables["bounds"])
    assert found[0].measures["control"] == found[1].measures["control"]


def test_a_herd_that_turns_together_turns_right_in_half_of_the_mirrored_starts_at_most() -> None:
    control = simulations.run_trial(small(iterations=0, **{"search.best_pairs": 6}), reraise=True).measures["control"]
    assert 0.3 < control <= 0.5


def test_a_decomposition_is_a_trial() -> None:
    found = simulations.run_trial(few(), reraise=True)
    assert set(found.measures) == set(measures.OF_PIECES)
    assert found.measures["pieces"] == len(found.tables["labels"]) == found.tables["piece_of_wall"].max() + 1
    np.testing.assert_array_equal(simulations.run_trial(few(), reraise=True).tables["means"], found.tables["means"])


def test_mirrored_pieces_have_mirrored_effects() -> None:
    """Both wings of the race in mirrored starts: forwards alike, sideways opposite."""
    wings = "left: -3, 1, -0.9, 4.4; right: 0.9, 1, 3, 4.4"
    effects = simulations.run_trial(few(**{"pieces.regions": wings}), reraise=True).tables["effects"]
    # rounding grows in a herd that members steer: 60 steps leave far less than a micrometre
    np.testing.assert_allclose(effects[0, :2], effects[1, :2] * [1.0, -1.0], rtol=0.0, atol=1e-6)


def test_every_key_is_put_and_shown_with_its_source() -> None:
    trial = small()
    for key, value in (("search.counts", "2, 3"), ("world.anchor", 2), ("behaviour.within", 100), ("herd.count", 4)):
        trial = keys.put(trial, key, value)
    rows = {row.key: row for row in keys.rows(simulations.settled(trial))}
    assert rows["search.parameters"].value == "angle_deg, length_m"
    assert rows["behaviour"].value == "turn-right"
    assert "world.angle_deg" not in rows  # it varies
    assert "pieces.window_m" not in rows
    assert all(row.source for row in rows.values())
    simulations.check(trial)
    assert "search.budget" not in {row.key for row in keys.rows(simulations.settled(few()))}


@pytest.mark.parametrize(
    ("setup", "told"),
    [
        ({"method": "cmaes"}, "cma-es"),
        ({"search.parameters": "angel_deg"}, "angle_deg"),
        ({"search.budget": 3}, "from 4 simulations"),
        ({"search.counts": "5, none"}, "whole numbers joined by commas"),
        ({"search.descriptors": "fence_m, angle"}, "angle_deg"),
        ({"search.cells": "8"}, "a number of at least 1 for each of fence_m, angle_deg"),
        ({"pieces.regions": "wing: 1, 2, 0, 4"}, "x0 below x1"),
        ({"pieces.regions": "1, 2, 3, 4"}, "NAME"),
        ({"behaviour": "turn-left"}, "turn-right"),
    ],
)
def test_bad_input_is_refused_in_one_line(setup: dict[str, object], told: str) -> None:
    with pytest.raises(InputError, match=told) as refused:
        simulations.check(small(**setup))
    assert "\n" not in str(refused.value)


def test_a_moment_of_each_runs_all_its_code() -> None:
    for module in (optimise, optimise_points, decompose):
        moment = simulations.of(module.base(1)).moment(module.base(1))
        assert simulations.run_trial(moment).outcome == "done"
