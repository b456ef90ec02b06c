"""Where a design repeats a published number, the two are equal."""

from __future__ import annotations

import pytest

from flocking.measures.links import Outcomes
from robots import body
from trials.design import plan
from trials.evidence.claims import published
from worlds import corridor
from worlds.formations import FORMATIONS

STUDY = published("trials.studies.detection", "fine2015", "detection_case_study")


def test_the_case_study_is_as_large_as_the_publication() -> None:
    trials = plan("detection-case-study").trials
    assert len(trials) == STUDY["trials"]
    assert {sum(group.count for group in trial.groups) for trial in trials} == {STUDY["robots"]}
    assert len({trial.formation for trial in trials}) == STUDY["starting_formations"] == len(FORMATIONS)


def test_its_exclusion_distances_are_the_published_ones() -> None:
    assert plan("detection-case-study").conditions["herd.law.exclusion_m"] == STUDY["exclusion_distances_m"]


def test_its_corridor_is_as_wide_as_published() -> None:
    width = STUDY["corridor_width_robot_diameters"] * 2.0 * body.load("create").radius
    assert corridor.Parameters().width_m == pytest.approx(width)


def test_every_claim_has_its_judge() -> None:
    from trials.studies.detection.judges import JUDGES

    assert len(JUDGES) == len(STUDY["claims"]) == len(STUDY["sections"]) == 13


@pytest.mark.parametrize(
    ("study", "source", "table"),
    [
        ("detection", "fine2015", "detection_case_study"),
        ("crowded_horizon", "fine2015", "lch_claims"),
        ("link_tension", "akama2014", "claims"),
    ],
)
def test_every_claim_has_its_section(study: str, source: str, table: str) -> None:
    told = published(f"trials.studies.{study}", source, table)
    assert len(told["claims"]) == len(told["sections"]) > 0
    assert all(told["sections"])


def test_the_sixteen_lch_parameterizations_make_the_published_number_of_simulations() -> None:
    table = published("trials.studies.crowded_horizon", "fine2015", "table_4_1")
    variations, starts = len(table["single_group"]), ("single_group", "split_group")
    assert set(table["single_group"]) == set(table["split_group"])
    cells = variations * len(starts) * len(table["sensing_ranges"])
    assert cells * table["trials_each"] == table["simulations_in_all"]


@pytest.mark.parametrize("table", ["table_1", "table_2"])
def test_link_tables_have_the_cells_that_are_measured_and_the_sums_that_the_text_tells(table: str) -> None:
    first, second = published("trials.studies.link_tension", "akama2014", table).values()
    assert set(first) == set(second) == set(Outcomes._fields)
    told = published("trials.studies.link_tension", "akama2014", "simulations")["predicted_broken"][table]
    assert first["broken_broken"] + first["intact_predicted_broken"] == told


def test_no_placeholder_is_left_in_the_docs() -> None:
    from pathlib import Path

    root = Path(__file__).parents[3]
    for page in (root / "README.md", *sorted((root / "docs").glob("*.md"))):
        text = page.read_text(encoding="utf-8")
        assert "TRIALS-" + "OUTPUT" not in text, page
        assert "SPEED-" + "TABLE" not in text, page
    assert "| verdict |" in (root / "docs/detection-case-study.md").read_text(encoding="utf-8")
