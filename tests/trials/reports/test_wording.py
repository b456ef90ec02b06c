"""The columns of the terminal: a simulation's own headings, or the key measures by their names."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from trials import design
from trials.reports.wording import columns, key_measures
from trials.simulations.robots.measures import ABOUT, HEADINGS, KEY_MEASURES


def run_of(experiment: str) -> Any:
    return SimpleNamespace(trials=design.plan(experiment, repeats=1).trials)


def test_robots_have_headings_of_their_own() -> None:
    run, experiment = run_of("detection-case-study"), design.load("detection-case-study")
    assert columns(run, experiment) == HEADINGS
    assert key_measures(run, experiment) == KEY_MEASURES
    assert {*HEADINGS, *KEY_MEASURES} <= ABOUT.keys()


def test_a_kinematic_herd_has_the_names_of_its_key_measures() -> None:
    run, experiment = run_of("hamilton-1971"), design.load("hamilton-1971")
    assert key_measures(run, experiment) == experiment.KEY_MEASURES
    assert columns(run, experiment)["mmd_end"] == "mmd\nend"
    assert tuple(columns(run, None)) == key_measures(run, None) != experiment.KEY_MEASURES
