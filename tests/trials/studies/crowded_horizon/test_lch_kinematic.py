"""LCH in the kinematic herd on made-up runs: what was published holds, the contrary does not."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest

from tests.trials.studies.judged import judged, verdicts
from trials import design
from trials.evidence.claims import published

STUDY = "trials.studies.crowded_horizon"


def table_4_1(conditions: Mapping[str, Any], far: bool = False) -> Mapping[str, float]:
    """As printed; with `far`, what our range of 3000 gives."""
    formation = conditions["formation"].replace("-", "_")
    variation = conditions["herd.law"].removeprefix("lch-").replace("-", "_")
    if far and formation == "split_group" and "3000" in conditions["herd.selection"]:
        return {"mmd_end": 0.05}
    return {"mmd_end": published(STUDY, "fine2015", "table_4_1")[formation][variation]}


def test_the_printed_table_holds_in_all_its_cells_and_ranges() -> None:
    assert verdicts("lch-table-4-1", table_4_1) == [True] * 9


def test_a_table_off_by_twice_its_margins_does_not_hold() -> None:
    def off(conditions: Mapping[str, Any]) -> Mapping[str, float]:
        add = 0.01 if conditions["formation"] == "single-group" else 0.3
        return {"mmd_end": table_4_1(conditions)["mmd_end"] + add}

    assert verdicts("lch-table-4-1", off) == [False] * 8 + [True]  # the ranges still agree


def test_groups_that_merge_at_the_large_range_alone_refute_that_the_range_does_not_matter() -> None:
    assert verdicts("lch-table-4-1", lambda conditions: table_4_1(conditions, far=True)) == [True] * 8 + [False]


def test_each_cell_of_the_table_is_a_number_in_the_report() -> None:
    table = published(STUDY, "fine2015", "table_4_1")
    *cells, ranges = judged("lch-table-4-1", table_4_1)
    printed = [float(value) for formation in ("single_group", "split_group") for value in table[formation].values()]
    assert [entry.published for entry in cells] == printed
    assert [entry.measured for entry in cells] == pytest.approx(printed, rel=0.02)  # spread of 1 %, ten trials
    assert ranges.published == ranges.claim


def test_directional_motion_with_a_limited_view() -> None:
    def drift(conditions: Mapping[str, Any], limited: float = 4.0) -> Mapping[str, float]:
        way = 0.2 if conditions["herd.selection"] == "all" else limited
        return {"net_displacement": way, "directedness": way / 7.5}

    assert verdicts("lch-field-of-view", drift) == [True]
    assert verdicts("lch-field-of-view", lambda conditions: drift(conditions, limited=0.3)) == [False]


def test_table_4_1_is_as_large_as_the_publication() -> None:
    table, made = published(STUDY, "fine2015", "table_4_1"), design.plan("lch-table-4-1")
    assert len(made.trials) == table["simulations_in_all"]
    assert made.repeats == table["trials_each"]
    values = {row.key: row.value for row in made.parameters}
    assert values["herd.count"] == table["members"]
    assert values["steps"] == table["iterations"]
    assert values["herd.law.st_m"] == table["st_distance"]
    ranges = [f"distance-based(0, {range_})" for range_ in table["sensing_ranges"]]
    assert made.conditions["herd.selection"] == ranges


def test_the_view_is_limited_for_as_many_members_as_in_figure_4_4() -> None:
    values = {row.key: row.value for row in design.plan("lch-field-of-view").parameters}
    assert values["herd.count"] == published(STUDY, "fine2015", "lch_claims")["field_of_view_members"]


def test_the_sixteen_lch_parameterizations_make_the_published_number_of_simulations() -> None:
    table = published(STUDY, "fine2015", "table_4_1")
    variations, starts = len(table["single_group"]), ("single_group", "split_group")
    assert set(table["single_group"]) == set(table["split_group"])
    cells = variations * len(starts) * len(table["sensing_ranges"])
    assert cells * table["trials_each"] == table["simulations_in_all"]
