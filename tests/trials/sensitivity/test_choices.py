"""Which parameters are varied, and within which ranges."""

from __future__ import annotations

import numpy as np
import pytest

from flocking.errors import InputError
from trials.design import load, plan
from trials.sensitivity.choices import Choice, choices, reference, settings
from trials.sensitivity.model import Model, supplements

STUDIED = ("detection-case-study", "lch-table-4-1", "link-tension")


@pytest.mark.parametrize("name", STUDIED)
def test_only_what_was_chosen_is_varied_within_its_bounds(name: str) -> None:
    made = plan(name, repeats=3)
    published = {row.key for row in made.parameters if row.published}
    varied, without = choices(made)
    keys = [choice.key for choice in varied]
    assert len(set(keys)) == len(keys) > 5
    assert not published & set(keys)
    assert not made.conditions.keys() & {*keys, *without}
    for choice in varied:
        assert choice.low < choice.high
        assert 0.0 <= choice.place() <= 1.0
        assert choice.names or choice.low <= float(choice.value) <= choice.high


@pytest.mark.parametrize("name", STUDIED)
def test_every_corner_of_the_ranges_can_be_planned(name: str) -> None:
    varied, _ = choices(plan(name, repeats=1))
    for corner in (0.0, 1.0):
        given = settings(varied, np.full(len(varied), corner))
        assert len(given) > 5
        assert len(plan(name, repeats=1, settings=given).trials) == len(plan(name, repeats=1).trials)


@pytest.mark.parametrize("name", STUDIED)
def test_values_within_the_ranges_fit_together(name: str) -> None:
    varied, _ = choices(plan(name, repeats=1))
    model = Model(name, 1, 1, varied)
    for place in np.random.default_rng(6).random((8, len(varied))):
        assert model.parts(place)  # checks every trial


@pytest.mark.parametrize("name", STUDIED)
def test_the_experiments_own_point_changes_no_setting(name: str) -> None:
    varied, _ = choices(plan(name, repeats=3))
    assert settings(varied, reference(varied)) == {}


def test_what_follows_from_a_condition_is_no_choice() -> None:
    varied, without = choices(plan("link-tension", repeats=1))
    keys = {choice.key for choice in varied}
    assert "herd.law.spring_per_s2" in keys
    assert not {"links.range_m", "links.stiffness_per_s2", "steps", "every"} & {*keys, *without}


def test_parameters_of_one_condition_alone_are_varied_too() -> None:
    keys = {choice.key for choice in choices(plan("detection-case-study"))[0]}
    assert {"herd.pipeline.threshold", "herd.pipeline.threshold_m", "formation.aside_m"} <= keys


def test_places_stand_for_values_of_their_kind() -> None:
    number = Choice("a", 1.0, "m", "", 0.5, 2.0)
    assert [number.at(0.0), number.at(1.0), number.at(number.place())] == [0.5, 2.0, 1.0]
    whole = Choice("b", 2, "", "", 1.0, 4.0)
    assert {whole.at(x) for x in np.linspace(0.0, 1.0, 50)} == {1, 2, 3, 4}
    named = Choice("c", "y", "", "", 0.0, 3.0, ("x", "y", "z"))
    assert [named.at(x) for x in (0.0, 0.34, 0.99, 1.0, named.place())] == ["x", "y", "z", "z", "y"]
    truth = Choice("d", True, "", "", 0.0, 2.0, (False, True))
    assert [truth.at(0.2), truth.at(0.7)] == [False, True]


@pytest.mark.parametrize(
    ("key", "told"),
    [
        ("herd.law.step", "did you mean herd.law.step_m"),
        ("herd.law.st_m", "its value was published"),
        ("formation", "its value was published"),
        ("herd.max_speed_m_s", "it has no plausible range"),
        ("every", "it follows from others"),
    ],
)
def test_a_key_that_cannot_be_varied_is_refused_with_the_reason(key: str, told: str) -> None:
    with pytest.raises(InputError, match=told):
        choices(plan("lch-table-4-1", repeats=1), [key])


def test_a_claim_on_other_trials_brings_their_experiment() -> None:
    varied, _ = choices(plan("detection-case-study", repeats=1))
    model = Model("detection-case-study", 1, 1, varied)
    assert [each.experiment for each in supplements(model, 9)] == ["detection-exclusion-sweep"]
    assert supplements(model, 3) == ()
    assert hasattr(load("detection-case-study"), "claims")
