"""Walls, obstacles and asynchrony: the settings of each law, what counts as a loss, and contact alone."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from tests.trials.survey_runs import made_up
from trials import simulations
from trials.design import plan
from trials.studies.information import law_survey
from trials.studies.information.environment_claims import claims
from trials.studies.information.environment_design import BUMPER, RADIUS_M, SETTINGS
from trials.studies.information.environment_figures import figures
from trials.studies.information.law_survey import CONTROL
from trials.types import Trial

FLOCK = {"largest_share": 0.8, "polarization": 0.8, "mmd": 1.0}
LAW = "snn"


def test_the_settings_of_a_law() -> None:
    trials = plan("environment-and-synchrony", repeats=1, settings={"herd.law": LAW}).trials
    herd = law_survey.herd_of(LAW)
    assert len(trials) == len(SETTINGS) == 10
    assert not any(t.world == "unbounded" and t.groups[0].setup["obstacles"] == "avoid" for t in trials)
    sizes = {trial.world_parameters.get("size_m") for trial in trials}
    assert sizes == {None, 3.0 * 5.0 * herd.spacing_m}
    assert {trial.formation for trial in trials} == {"single-group"}


def test_members_that_feel_their_way_are_solid_and_so_is_their_control() -> None:
    trials = plan("environment-and-synchrony", repeats=1, settings={"herd.law": BUMPER}).trials
    assert [trial.groups[0].law for trial in trials] == [BUMPER, CONTROL] * 6
    for one, other in zip(trials[::2], trials[1::2], strict=True):
        assert one.groups[0].setup["radius_m"] == other.groups[0].setup["radius_m"] == RADIUS_M
        assert one.setup["steps"] == other.setup["steps"]
        assert one.world_parameters == other.world_parameters


def losing(**by: float) -> object:
    def measures(trial: Trial) -> Mapping[str, float]:
        harmed = trial.setup.get("synchronous") is False
        return {name: value + (by.get(name, 0.0) if harmed else 0.0) for name, value in FLOCK.items()}

    return measures


@pytest.mark.parametrize(
    ("by", "agrees", "share"),
    [
        ({}, True, 1.0),
        ({"polarization": -0.5}, False, 4 / 9),
        ({"mmd": 2.0}, False, 4 / 9),
        ({"mmd": -0.9, "largest_share": 0.2}, True, 1.0),
    ],
)
def test_worse_is_a_loss_and_better_is_not(by: dict[str, float], agrees: bool, share: float) -> None:
    """Five of the nine other settings are asynchronous."""
    run = made_up("environment-and-synchrony", losing(**by), **{"herd.law": LAW})  # type: ignore[arg-type]
    (entry,) = claims(run)
    assert entry.agrees is agrees
    assert entry.measured == share


@pytest.mark.parametrize(("excess", "agrees"), [(0.4, True), (0.0, False)])
def test_contact_makes_a_flock_if_it_does_anywhere(excess: float, agrees: bool) -> None:
    def measures(trial: Trial) -> Mapping[str, float]:
        better = trial.groups[0].law == BUMPER and trial.world == "bounded"
        return FLOCK | {"polarization": 0.3 + (excess if better else 0.0)}

    (entry,) = claims(made_up("environment-and-synchrony", measures, **{"herd.law": BUMPER}))
    assert entry.agrees is agrees
    assert len(entry.outcomes) == 18


def test_the_map_is_drawn(tmp_path: Path) -> None:
    run = made_up("environment-and-synchrony", losing(polarization=-0.5), **{"herd.law": LAW})  # type: ignore[arg-type]
    (figure,) = figures(run, tmp_path)
    text = figure.path.read_text()
    assert LAW in text
    assert " P<" in text


def test_a_real_herd_stays_within_its_walls() -> None:
    asked = {"herd.law": BUMPER, "world": "obstacles", "steps": 60}
    trial = plan("environment-and-synchrony", repeats=1, settings=asked).trials[0]
    result = simulations.run_trial(trial, reraise=True)
    size = trial.world_parameters["size_m"]
    assert len(result.walls_w) == 4 + 12
    assert (result.poses_w[-1, :, :2] >= RADIUS_M - 1e-6).all()  # a disc touches a wall up to the clearance
    assert (result.poses_w[-1, :, :2] <= float(size) - RADIUS_M + 1e-6).all()
