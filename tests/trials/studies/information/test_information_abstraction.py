"""Information taken away: which laws take part, what they are told, and what the claims make of it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from flocking import lawentry, lawsource
from flocking.errors import InputError
from tests.trials.survey_runs import made_up
from trials import simulations
from trials.design import plan
from trials.studies.information import law_survey
from trials.studies.information.abstraction_claims import claims
from trials.studies.information.abstraction_design import (
    ALL_TOLD,
    BODY,
    KEYS,
    LENGTH,
    VARIATIONS,
    permits,
    words_left_out,
)
from trials.studies.information.abstraction_figures import figures
from trials.studies.information.abstraction_robots import claims as claims_of_robots
from trials.types import Trial

FLOCK = {"largest_share": 1.0, "polarization": 0.9, "mmd": 0.5}
CROWD = {"largest_share": 0.3, "polarization": 0.2, "mmd": 1.0}
LCH = "lch-member-pose"


def test_every_law_takes_part_or_is_left_out_for_a_reason() -> None:
    left = law_survey.left_out()
    assert {*left, *law_survey.taking_part()} == set(lawsource.names())
    assert left["random-motion"] == left["bumper-only"] == "reads nothing of other members"
    assert left["hamilton-1d"] == "moves along one axis only"
    assert all(f"{law} ({why})" in words_left_out() for law, why in left.items())


def test_a_law_of_the_users_own_joins(tmp_path: Path) -> None:
    path = tmp_path / "mine.py"
    path.write_text(Path(str(lawentry.module_of("snn").__file__)).read_text())
    trials = plan("information-abstraction", repeats=1, law=str(path)).trials
    assert len(trials) == len(ALL_TOLD) + 1


def test_what_a_law_is_judged_by_follows_from_what_it_reads() -> None:
    assert law_survey.judged_by("snn") == ("largest_share", "mmd")
    assert law_survey.judged_by("couzin") == ("largest_share", "polarization")
    assert law_survey.judged_by("vicsek") == law_survey.judged_by("shimoyama") == ("largest_share", "polarization")
    assert law_survey.told_apart_by("vicsek") == ("polarization",)  # it does not know where anybody is
    assert law_survey.told_apart_by("couzin") == law_survey.judged_by("couzin")


@pytest.mark.parametrize("name", law_survey.taking_part())
def test_every_control_goes_as_far_as_the_herds_that_it_stands_for(name: str) -> None:
    conditions = law_survey.control(name, LENGTH)
    way = conditions["herd.law.speed_m_s"] * conditions["steps"] * conditions["timestep_s"]
    assert way > 0.0
    if law_survey.herd_of(name).speed_m_s == 0.0:
        assert way == pytest.approx(LENGTH.spacings * conditions["formation.spacing_m"])


def test_bearings_are_for_laws_that_read_no_headings_and_groups_for_those_without_cells() -> None:
    assert permits("snn", "bearings")
    assert all(permits("lch", *told) for told in VARIATIONS)
    assert not permits("vicsek", "bearings")
    assert not permits("couzin", "bearings")
    assert permits("couzin", "poses", "densest")
    assert not permits("camperi", "poses", "densest")


def test_the_cells_of_a_law_and_its_control_stand_in_its_own_herd() -> None:
    *of_law, control = plan("information-abstraction", repeats=1, settings={"herd.law": "snn"}).trials
    herd = law_survey.herd_of("snn")
    assert len(of_law) == 16
    group = f"densest-distance({herd.spacing_m:g})"
    assert {trial.groups[0].selection for trial in of_law} == {"all", group, "densest-angle(10)"}
    for trial in of_law:
        assert trial.groups[0].setup["silhouette_m"] == BODY * herd.spacing_m
        assert trial.groups[0].setup["assumed_distance_m"] == herd.spacing_m
        assert trial.setup["steps"] == control.setup["steps"]
    assert control.groups[0].law == "random-motion"
    assert control.formation_parameters["spacing_m"] == control.setup["cut_m"] == herd.spacing_m
    assert control.groups[0].law_parameters["speed_m_s"] == herd.speed_m_s


def test_each_variation_of_lch_is_asked_what_it_reads_by_itself() -> None:
    *of_law, _ = plan("information-abstraction", repeats=1, sweep={"herd.law": list(VARIATIONS.values())}).trials
    assert len(of_law) == 16
    for trial in of_law:
        assert trial.groups[0].selection == "all"
        assert trial.groups[0].setup["information"] == trial.groups[0].law.rpartition("-")[2].replace(
            "pose", "poses"
        ).replace("bearing", "bearings")
    assert len({(trial.groups[0].law, trial.groups[0].pipeline) for trial in of_law}) == 16


def test_what_the_user_sets_stands() -> None:
    asked = {"herd.law": LCH, "herd.silhouette_m": 0.2, "steps": 7}
    first, *_ = plan("information-abstraction", repeats=1, settings=asked).trials
    assert (first.groups[0].setup["silhouette_m"], first.setup["steps"]) == (0.2, 7)


def test_a_law_that_takes_no_part_is_refused_in_one_line() -> None:
    with pytest.raises(InputError, match="'hamilton-1d' moves along one axis only"):
        plan("information-abstraction", settings={"herd.law": "hamilton-1d"})


def laid_down(lost: str = "", gained: str = "") -> object:
    def measures(trial: Trial) -> Mapping[str, float]:
        (group,) = trial.groups
        if group.law == law_survey.CONTROL:
            return CROWD
        if group.pipeline == lost:
            return CROWD | {"mmd": 0.99}
        return FLOCK | ({"mmd": 0.1} if group.pipeline == gained else {})

    return measures


@pytest.mark.parametrize(
    ("lost", "gained", "agrees", "share"),
    [
        ("", "", True, 1.0),
        ("sensor-based", "", False, 11 / 15),
        ("", "member-based", False, 11 / 15),
    ],
)
def test_a_law_is_abstracted_if_nothing_changes(lost: str, gained: str, agrees: bool, share: float) -> None:
    """Four of the fifteen conditions have that detection; a herd that is much denser is not the same either."""
    run = made_up("information-abstraction", laid_down(lost, gained), laws=list(VARIATIONS.values()))  # type: ignore[arg-type]
    (entry,) = claims(run)
    assert entry.agrees is agrees
    assert entry.measured == share
    assert (
        entry.published
        == "information-abstracted: its behaviour does not depend on the type and detail of what it is told"
    )


def test_a_law_that_does_not_flock_has_nothing_to_lose() -> None:
    (entry,) = claims(made_up("information-abstraction", lambda trial: CROWD, **{"herd.law": "snn"}))
    assert entry.agrees is None
    assert "not shown to be better than random motion" in entry.test


def test_the_map_is_drawn(tmp_path: Path) -> None:
    run = made_up("information-abstraction", laid_down("member-based"), **{"herd.law": "snn"})  # type: ignore[arg-type]
    (figure,) = figures(run, tmp_path)
    assert "snn" in figure.path.read_text()
    assert "hamilton-1d" in figure.caption


def test_the_map_names_the_laws_that_have_a_goal_and_are_given_none(tmp_path: Path) -> None:
    asked = {"herd.law": "conradt", "herd.selection": "all"}
    run = made_up("information-abstraction", lambda trial: CROWD, **asked)
    (figure,) = figures(run, tmp_path)
    assert figure.caption.endswith("Of the laws with goals, these run without one here: conradt.")
    informed = made_up("information-abstraction", lambda trial: CROWD, **asked, **{"herd.informed_share": 0.2})
    (figure,) = figures(informed, tmp_path)
    assert "with goals" not in figure.caption


def test_one_real_trial_keeps_its_ends_alone() -> None:
    trial = plan("information-abstraction", repeats=1, settings={"herd.law": LCH, "steps": 5}).trials[3]
    result = simulations.run_trial(trial, reraise=True)
    assert result.trial.groups[0].pipeline == "sensor-based"
    assert len(result.times) == 2
    assert result.measures["distance_travelled"] > 0.0
    assert all(key in KEYS for key in trial.conditions)


def test_on_creates_the_variations_are_held_against_one() -> None:
    """Sensor-based detection costs three conditions of each LCH variation (one of three, or of four where it is not
    the best itself)."""
    entries = {
        e.quantity.partition(":")[0]: e
        for e in claims_of_robots(
            made_up("information-abstraction-robots", laid_down("sensor-based"))  # type: ignore[arg-type]
        )
    }
    assert entries["lch-member-pose"].measured == 2 / 3
    assert entries["lch-group-bearing"].measured == 3 / 4
    assert entries["couzin"].measured == 5 / 7
    assert {entry.agrees for entry in entries.values()} == {False}
