"""Contract tests: every experiment that exists is found by itself, and its plan is what it says."""

from __future__ import annotations

import math

import pytest

from flocking.errors import InputError
from trials import design, simulations
from trials.batch import asked
from trials.commands.listing import planned
from trials.simulations.robots import fields
from trials.types import Trial

EXPERIMENTS = design.experiment_names()


@pytest.mark.parametrize("name", EXPERIMENTS)
class TestEveryExperiment:
    def test_its_plan_is_a_full_factorial_design_unless_it_names_its_cells(self, name: str) -> None:
        plan = design.plan(name, repeats=2)
        cells = math.prod(len(values) for values in plan.conditions.values())
        if hasattr(design.load(name), "cells"):
            cells = len(design.load(name).cells(plan.conditions))
        assert len(plan.trials) == 2 * cells
        assert [trial.index for trial in plan.trials] == list(range(1, 2 * cells + 1))
        assert all(trial.experiment == name for trial in plan.trials)
        assert len({(t.repeat, tuple(t.conditions.items())) for t in plan.trials}) == 2 * cells

    def test_more_repeats_keep_the_numbers(self, name: str) -> None:
        few, many = design.plan(name, repeats=1).trials, design.plan(name, repeats=3).trials
        assert many[: len(few)] == few

    def test_every_parameter_has_a_source(self, name: str) -> None:
        rows = design.plan(name, repeats=1).parameters
        assert len({row.key for row in rows}) == len(rows)
        assert all(row.source for row in rows)

    def test_its_trials_survive_json(self, name: str) -> None:
        import json

        for trial in design.plan(name, repeats=1).trials:
            assert Trial.from_dict(json.loads(json.dumps(trial.as_dict()))) == trial


class TestCaseStudy:
    def test_has_63_trials_of_six_robots(self) -> None:
        plan = design.plan("detection-case-study")
        assert len(plan.trials) == 63
        assert {sum(g.count for g in t.groups) for t in plan.trials} == {6}
        assert {t.formation for t in plan.trials} == {"single-file", "staggered-file", "split-file"}
        assert min(t.setup["duration_s"] for t in plan.trials) >= 60.0

    def test_set_on_a_condition_replaces_its_values(self) -> None:
        plan = design.plan("detection-case-study", settings={"herd.law.exclusion_m": 0.3})
        assert len(plan.trials) == 21
        assert {t.groups[0].law_parameters["exclusion_m"] for t in plan.trials} == {0.3}

    def test_sweep_of_another_key_makes_arms(self) -> None:
        plan = design.plan("detection-case-study", sweep={"herd.sensors": ["ideal", "harsh"]})
        assert len(plan.trials) == 126
        assert plan.sweep == {"herd.sensors": ["ideal", "harsh"]}
        assert {t.conditions["herd.sensors"] for t in plan.trials} == {"ideal", "harsh"}

    def test_another_law_leaves_out_what_it_lacks_and_says_so(self) -> None:
        plan = design.plan("detection-case-study", law="snn")
        assert len(plan.trials) == 21
        assert any("exclusion_m" in note for note in plan.notes)

    def test_a_pipeline_by_one_word(self) -> None:
        plan = design.plan("detection-case-study", pipeline="perfect")
        assert {t.groups[0].pipeline for t in plan.trials} == {"perfect"}
        assert len(plan.trials) == 21

    @pytest.mark.parametrize(
        ("settings", "words"),
        [
            ({"herd.law.repulsion": 0.5}, r"herd\.law\.repulsion_m"),
            ({"herd.speed_m_s": 0.0}, "at least 0.001 in m/s"),
            ({"herd.speed_m_s": math.nan}, "at least 0.001 in m/s"),
            ({"herd.pipeline": "sensorbased"}, "sensor-based"),
            ({"herd.sensors": "idael"}, "ideal"),
            ({"world": "coridor"}, "corridor"),
            ({"world.width_m": -1}, "from 0.5"),
            ({"herd.body": "fleet"}, "create"),
            ({"flock.count": 3}, "herd.count"),
            ({"herd.count": 0}, "expected a whole number of robots from 1 to 1000"),
            ({"herd.count": "six"}, "expected a whole number of robots"),
            ({"herd.count": 2.5}, "expected a whole number of robots"),
            ({"herd.rate_hz": "fast"}, "expected a number in Hz"),
            ({"formation": "line"}, "single-group"),
        ],
    )
    def test_wrong_keys_and_values_are_refused(self, settings: dict[str, object], words: str) -> None:
        with pytest.raises(InputError, match=words):
            design.plan("detection-case-study", settings=settings)

    def test_one_trial_is_not_told_as_several(self) -> None:
        one = {"herd.pipeline": "perfect", "herd.law.exclusion_m": 0.5}
        made = design.plan("detection-case-study", repeats=1, settings=one)
        assert "\n1 trial, 1 repeat of each cell:\n" in planned(made, made.trials)
        made = design.plan("detection-case-study", repeats=2)
        assert "\n1 of 18 trials, 2 repeats of each cell:\n" in planned(made, made.trials[:1])

    def test_a_key_cannot_be_both_set_and_swept(self) -> None:
        with pytest.raises(InputError, match="both set and swept"):
            design.plan("detection-case-study", settings={"herd.speed_m_s": 0.1}, sweep={"herd.speed_m_s": [0.1, 0.2]})

    @pytest.mark.parametrize("where", ["settings", "sweep"])
    def test_a_swap_and_a_key_for_the_same_are_refused(self, where: str) -> None:
        value = {"herd.law": "snn" if where == "settings" else ["snn"]}
        with pytest.raises(InputError, match="expected one of the two"):
            design.plan("detection-case-study", law="extended-hamilton", **{where: value})  # type: ignore[arg-type]

    def test_what_the_user_set_is_no_longer_called_published(self) -> None:
        rows = {row.key: row for row in design.plan("detection-case-study", settings={"herd.count": 4}).parameters}
        assert not rows["herd.count"].published
        assert "in place of 6" in rows["herd.count"].source
        assert rows["world.width_m"].published

    def test_names_are_put_before_the_parameters_that_belong_to_them(self) -> None:
        settings = {"herd.law.repulsion_m": 0.4, "herd.law": "snn"}
        group = design.plan("detection-case-study", settings=settings).trials[0].groups[0]
        assert (group.law, group.law_parameters["repulsion_m"]) == ("snn", 0.4)


def test_too_many_trials_of_one_repeat_are_refused_with_what_makes_them_fewer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(design, "MAX_TRIALS", 8)
    with pytest.raises(InputError, match="9 trials of 1 repeat: expected at most 8, as by fewer values of what is var"):
        design.plan("detection-case-study", repeats=1)
    with pytest.raises(InputError, match="18 trials of 2 repeats: expected at most 8"):
        design.plan("detection-case-study", repeats=2)


def test_what_trials_have_in_common_is_looked_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """A plan of thousands of trials is made and checked by its cells, not by its repeats."""
    looked_at: list[Trial] = []
    monkeypatch.setattr(simulations, "_check", looked_at.append)
    simulations._check_kind.cache_clear()
    made, chosen = asked.planned(asked.Asked("information-abstraction", repeats=5))
    simulations._check_kind.cache_clear()
    assert len(chosen) > 2000
    assert len(looked_at) == len(chosen) // 5
    assert {trial.repeat for trial in made.trials} == {1, 2, 3, 4, 5}
    assert {trial.repeat for trial in looked_at} == {1}


def test_show_gives_the_values_of_the_named_sensor_setting() -> None:
    rows = {row.key: row.value for row in design.plan("detection-case-study").parameters}
    ideal = {
        row.key: row.value for row in design.plan("detection-case-study", settings={"herd.sensors": "ideal"}).parameters
    }
    assert rows["herd.sensors"] == "datasheet"
    assert rows.keys() == ideal.keys()
    assert rows != ideal
    assert {"create", "create-small"} <= set(fields.body_names())


def test_a_parameter_that_only_some_formations_have_is_left_out_elsewhere() -> None:
    made = design.plan("detection-case-study", settings={"formation.aside_m": 0.3, "formation.jitter_m": 0.0})
    given = {trial.repeat: trial.formation_parameters for trial in made.trials}
    assert given[1] == {"jitter_m": 0.0}  # a single file
    assert given[2] == {"aside_m": 0.3, "jitter_m": 0.0}
    assert made.notes == ["formation.aside_m is left out where the formation has no such parameter"]
    with pytest.raises(InputError, match=r"unknown parameter 'formation\.aside_m'"):
        design.plan("detection-case-study", settings={"formation.aside_m": 0.3, "formation": "single-file"})
    with pytest.raises(InputError, match=r"unknown parameter 'formation\.aside'; did you mean formation\.aside_m"):
        design.plan("detection-case-study", settings={"formation.aside": 0.3, "formation": "staggered-file"})


def test_the_parameters_of_every_formation_are_shown() -> None:
    rows = {row.key: row for row in design.plan("detection-case-study", settings={"formation.gap_m": 2.0}).parameters}
    shown = [key for key in rows if key.startswith("formation.")]
    assert shown == [
        f"formation.{name}" for name in ("spacing_m", "jitter_m", "heading_spread_deg", "aside_m", "gap_m")
    ]
    assert rows["formation.gap_m"].source == "set here in place of 3.0"
