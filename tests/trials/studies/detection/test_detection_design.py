"""Where the design of the detection case study repeats a published number, the two are equal."""

from __future__ import annotations

import pytest

from robots import body
from trials.design import plan
from trials.evidence.claims import published
from trials.studies.detection.judges import JUDGES
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
    assert len(JUDGES) == len(STUDY["claims"]) == len(STUDY["sections"]) == 13
