"""The judges of the kinematic experiments on made-up runs: what was published holds, the contrary does not."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from tests.trials.made_up_run import MadeUpRun, finished
from trials import design
from trials.evidence.claims import Entry, published
from trials.evidence.outcomes import near

Measures = Callable[[Mapping[str, Any]], Mapping[str, float]]
"""Conditions → means of the measures."""
SPREAD = 0.01
"""Relative deviation from trial to trial: far below every margin."""


def judged(experiment: str, measures: Measures, repeats: int | None = None) -> list[Entry]:
    """The entries of an experiment whose trials measured what `measures` says, give or take the spread."""
    trials = design.plan(experiment, repeats=repeats).trials
    run = finished(trials, lambda trial: measures(trial.conditions), seed=5, spread=SPREAD)
    entries: list[Entry] = design.load(experiment).claims(run)
    return entries


def verdicts(experiment: str, measures: Measures) -> list[bool | None]:
    return [entry.agrees for entry in judged(experiment, measures)]


def table_4_1(conditions: Mapping[str, Any], far: bool = False) -> Mapping[str, float]:
    """As printed; with `far`, what our range of 3000 gives."""
    formation = conditions["formation"].replace("-", "_")
    variation = conditions["herd.law"].removeprefix("lch-").replace("-", "_")
    if far and formation == "split_group" and "3000" in conditions["herd.selection"]:
        return {"mmd_end": 0.05}
    return {"mmd_end": published("trials.studies.crowded_horizon", "fine2015", "table_4_1")[formation][variation]}


def test_the_printed_table_holds_in_all_its_cells_and_ranges() -> None:
    assert verdicts("lch-table-4-1", table_4_1) == [True] * 9


def test_a_table_off_by_twice_its_margins_does_not_hold() -> None:
    def off(conditions: Mapping[str, Any]) -> Mapping[str, float]:
        add = 0.01 if conditions["formation"] == "single-group" else 0.3
        return {"mmd_end": table_4_1(conditions)["mmd_end"] + add}

    assert verdicts("lch-table-4-1", off) == [False] * 8 + [True]  # the ranges still agree


def test_groups_that_merge_at_the_large_range_alone_refute_that_the_range_does_not_matter() -> None:
    assert verdicts("lch-table-4-1", lambda conditions: table_4_1(conditions, far=True)) == [True] * 8 + [False]


def test_near_shows_the_values_themselves() -> None:
    outcome = near("x", np.array([4.9, 5.0, 5.1]), 5.2, 0.5)
    assert outcome.decision.agrees is True
    assert outcome.shown()[0] == pytest.approx(5.0)
    assert outcome.in_margins()[0] == pytest.approx(-0.4)


def order(conditions: Mapping[str, Any], sizes_alike: bool = False) -> Mapping[str, float]:
    """Falls with the noise from 1, at large noise as one over the root of the number of members."""
    count, noise = conditions["herd.count"], conditions["herd.law.noise_rad"]
    left = 1.0 / math.sqrt(100 if sizes_alike else count)
    return {"polarization": 1.0 - (1.0 - left) * min(1.0, noise / 4.0) ** 2}


def test_an_order_that_falls_further_in_larger_herds_is_vicseks() -> None:
    assert verdicts("vicsek-transition", order) == [True, True]


def test_an_order_that_no_noise_or_no_size_changes_is_not() -> None:
    assert verdicts("vicsek-transition", lambda conditions: {"polarization": 0.9}) == [False, False]
    assert verdicts("vicsek-transition", lambda conditions: order(conditions, sizes_alike=True)) == [True, False]


def accuracy(conditions: Mapping[str, Any], exponent: float = 1.0) -> Mapping[str, float]:
    """Grows with the number of informed members (exponent 1) or with their share alone (0)."""
    count, share = conditions["herd.count"], conditions["herd.informed_share"]
    informed = round(count * share)
    if informed == 0:
        return {"goal_alignment": math.nan}
    drive = share * (count / 50.0) ** exponent
    return {"goal_alignment": math.tanh(10.0 * drive)}


def test_accuracy_that_grows_with_the_number_of_the_informed_is_couzins() -> None:
    assert verdicts("couzin-leaders", accuracy) == 2 * [True, True]  # each claim at either speed


def test_accuracy_that_knows_no_size_or_no_share_is_not() -> None:
    assert verdicts("couzin-leaders", lambda conditions: accuracy(conditions, exponent=0.0)) == 2 * [True, False]
    assert verdicts("couzin-leaders", lambda conditions: {"goal_alignment": 0.5})[0] is False


def test_hamiltons_groups() -> None:
    def many(conditions: Mapping[str, Any], merged: float = 1.0) -> Mapping[str, float]:
        groups = merged if conditions["herd.law"] == "hamilton-merging" else 20.0
        return {"groups_end": groups, "largest_share_end": 1.0 / groups, "mmd_start": 15.0, "mmd_end": 10.0}

    assert verdicts("hamilton-1971", many) == [True, True, True]
    assert verdicts("hamilton-1971", lambda conditions: many(conditions, merged=3.0)) == [True, True, False]
    one = {"groups_end": 1.0, "largest_share_end": 1.0, "mmd_start": 15.0, "mmd_end": 16.0}
    assert verdicts("hamilton-1971", lambda conditions: one) == [False, False, False]


def test_directional_motion_with_a_limited_view() -> None:
    def drift(conditions: Mapping[str, Any], limited: float = 4.0) -> Mapping[str, float]:
        way = 0.2 if conditions["herd.selection"] == "all" else limited
        return {"net_displacement": way, "directedness": way / 7.5}

    assert verdicts("lch-field-of-view", drift) == [True]
    assert verdicts("lch-field-of-view", lambda conditions: drift(conditions, limited=0.3)) == [False]


@pytest.mark.parametrize(
    "experiment", ["lch-table-4-1", "vicsek-transition", "couzin-leaders", "hamilton-1971", "lch-field-of-view"]
)
def test_a_run_that_has_not_begun_is_undecided(experiment: str) -> None:
    run = MadeUpRun(design.plan(experiment, repeats=1).trials, [])
    assert {entry.agrees for entry in design.load(experiment).claims(run)} == {None}


class TestPublished:
    def test_table_4_1_is_as_large_as_the_publication(self) -> None:
        table, made = published("trials.studies.crowded_horizon", "fine2015", "table_4_1"), design.plan("lch-table-4-1")
        assert len(made.trials) == table["simulations_in_all"]
        assert made.repeats == table["trials_each"]
        values = {row.key: row.value for row in made.parameters}
        assert values["herd.count"] == table["members"]
        assert values["steps"] == table["iterations"]
        assert values["herd.law.st_m"] == table["st_distance"]
        ranges = [f"distance-based(0, {range_})" for range_ in table["sensing_ranges"]]
        assert made.conditions["herd.selection"] == ranges

    def test_the_view_is_limited_for_as_many_members_as_in_figure_4_4(self) -> None:
        values = {row.key: row.value for row in design.plan("lch-field-of-view").parameters}
        assert (
            values["herd.count"]
            == published("trials.studies.crowded_horizon", "fine2015", "lch_claims")["field_of_view_members"]
        )

    def test_vicseks_herds_have_the_published_sizes_density_and_speed(self) -> None:
        figure, made = published("trials.studies.classics", "vicsek1995", "figure_2"), design.plan("vicsek-transition")
        assert set(made.conditions["herd.count"]) < set(figure["particles"])
        values = {row.key: row.value for row in made.parameters}
        assert values["herd.count"] / values["world.size_m"] ** 2 == pytest.approx(figure["density"])
        assert values["herd.law.speed_m_s"] == figure["speed"]

    def test_couzins_groups_have_the_published_sizes_and_weight(self) -> None:
        figure, made = published("trials.studies.classics", "couzin2005", "figure_1"), design.plan("couzin-leaders")
        assert made.conditions["herd.count"] == figure["group_sizes"]
        assert {row.key: row.value for row in made.parameters}["herd.law.omega"] == figure["weight"]


@pytest.mark.parametrize("name", ["vicsek-transition", "couzin-leaders", "hamilton-1971", "lch-table-4-1"])
def test_a_run_that_holds_next_to_nothing_leaves_its_claims_undecided(name: str, tmp_path: Path) -> None:
    class Nothing:
        folder = tmp_path
        trials: ClassVar = design.plan(name, repeats=1).trials[:2]

        def rows(self) -> list[Any]:
            return []

    assert {entry.agrees for entry in design.load(name).claims(Nothing())} == {None}
