"""A map is a trial: it is planned, checked and run as all others are, and its tables give the map back."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from flocking.errors import InputError
from trials import design, keys, simulations
from trials.batch import series
from trials.simulations.maps import fields, loop, simulation
from trials.types import Trial

SMALL = {"grid": "3", "refinements": 1, "pairs": 2, "iterations": 120}


def small(**setup: object) -> Trial:
    return fields.trial("t", 1, [fields.herd(3)], "dirt", **{**SMALL, **setup})  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def result():  # type: ignore[no-untyped-def]
    return simulations.run_trial(small(), reraise=True)


def test_the_same_trial_gives_the_same_map(result) -> None:  # type: ignore[no-untyped-def]
    again = simulations.run_trial(small(), reraise=True)
    assert again.measures == pytest.approx(dict(result.measures), nan_ok=True, abs=0.0)
    for name, table in result.tables.items():
        np.testing.assert_array_equal(again.tables[name], table)


def test_another_repeat_has_other_starts(result) -> None:  # type: ignore[no-untyped-def]
    other = simulations.run_trial(dataclasses.replace(small(), repeat=2), reraise=True)
    assert not np.array_equal(other.tables["x_deviation"][:9], result.tables["x_deviation"][:9])


def test_tables_give_the_map_back(result) -> None:  # type: ignore[no-untyped-def]
    map_ = loop.map_of(result.trial, series.unpack(series.pack(result)).tables)
    assert map_.successful.sum() == result.measures["successful"]
    assert len(map_.points) == result.measures["configurations"]
    assert set(result.measures) == set(simulation.SIMULATION.measures)
    assert result.measures["uplift"] == result.measures["success"] - result.measures["control_success"]
    assert np.isfinite(result.poses_w).all()


def test_a_herd_of_one_law_turns_right_as_often_as_left_without_a_construct() -> None:
    """A wall of next to no length: of a start and its mirror image at most one is a right turn of nine in ten."""
    trial = small(pairs=6, refined="angle_deg", grid="4", refinements=0, iterations=0)
    trial = dataclasses.replace(trial, world_parameters={"length_m": 1e-6})
    share = simulations.run_trial(trial, reraise=True).measures["success"]
    assert share <= 0.5
    assert share > 0.3  # and the herd does turn: a junction whose herd got stuck would have no successes


def test_every_key_is_put_and_shown_with_its_source() -> None:
    trial = small()
    for key, value in (("grid", "4,2"), ("world.anchor", 2), ("behaviour.within", 150), ("herd.count", 5)):
        trial = keys.put(trial, key, value)
    rows = {row.key: row for row in keys.rows(simulations.settled(trial))}
    assert rows["refined"].value == "angle_deg, length_m"
    assert rows["behaviour"].value == "turn-right"
    assert "world.angle_deg" not in rows  # it varies
    assert all(row.source for row in rows.values())
    simulations.check(trial)


@pytest.mark.parametrize(
    ("setup", "told"),
    [
        ({"refined": "angel_deg"}, "angle_deg"),
        ({"grid": "0"}, "at least 1"),
        ({"grid": "eight"}, "whole numbers joined by commas"),
        ({"method": "random"}, "budget"),
        ({"refinements": 12}, "fewer"),
        ({"box.first_low": 400.0}, "0 to 360"),
        ({"behaviour": "turn-left"}, "turn-right"),
    ],
)
def test_what_fits_no_map_is_refused_in_one_line(setup: dict[str, object], told: str) -> None:
    with pytest.raises(InputError, match=told) as refused:
        simulations.check(small(**setup))
    assert "\n" not in str(refused.value)


def test_the_studys_experiments_are_planned_and_checked() -> None:
    for name in ("dirt-map", "dirt-sampling", "dsdr-map", "sirt-map", "dirt-against-sirt"):
        made = design.plan(name, repeats=1)
        for trial in made.trials:
            simulations.check(trial)
    sizes = [dict(trial.conditions) for trial in design.plan("dirt-map", repeats=1).trials]
    assert len(sizes) == 7  # four anchors, and three group sizes refined
