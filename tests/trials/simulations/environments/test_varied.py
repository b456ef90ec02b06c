"""Parameters that are drawn anew for each environment, the stages of schemas that combine others, and own schemas."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from flocking.errors import InputError
from generation import candidates, found
from trials import keys
from trials.simulations import check, run_trial, settled
from trials.simulations.environments import fields, herds
from trials.simulations.kinematic.fields import group
from trials.types import Trial, with_setup


def trial(schema: str, **setup: float | str) -> Trial:
    herd = group("random-motion", 2, law_parameters={"speed_m_s": 0.1, "turn_rad": 0.5}, obstacles="avoid")
    return fields.trial("some", 1, [herd], schema, formation_parameters={"size_m": 1.0}, environments=4, **setup)


def drawn(made: Trial, number: int) -> dict[str, float]:
    return dict(herds.environment(made, number, fields.chosen_by(made)).origin["parameters"])


def test_each_environment_has_parameters_of_its_own_and_the_same_again() -> None:
    made = trial("dirt", varied="all")
    every = [drawn(made, number) for number in range(40)]
    assert every == [drawn(made, number) for number in range(40)]
    assert len({each["angle_deg"] for each in every}) == 40
    assert {each["anchor"] for each in every} == {1, 2, 3, 4}
    angles = np.array([each["angle_deg"] for each in every])
    assert (angles < 90.0).any()
    assert (angles > 270.0).any()


def test_what_is_not_varied_stays_and_a_range_is_kept_to() -> None:
    made = trial("galton", varied="rows=2..3, peg_m=4..5")
    every = [drawn(made, number) for number in range(20)]
    assert {each["rows"] for each in every} == {2, 3}
    assert all(4.0 <= each["peg_m"] <= 5.0 for each in every)
    assert {each["gap_m"] for each in every} == {20.0}


def test_without_varied_parameters_environments_are_what_they_were() -> None:
    chosen = fields.chosen_by(trial("splitting"))
    first = herds.environment(trial("splitting"), 3, chosen)
    assert first.construct
    assert herds.environment(trial("splitting"), 3, chosen) is first  # made once
    herds.forget()
    again = herds.environment(trial("splitting", varied=""), 3, chosen)
    assert again is not first
    assert again == first


def test_what_is_remembered_of_one_trial_is_not_given_to_another_one() -> None:
    chosen = fields.chosen_by(trial("splitting"))
    first = herds.environment(trial("splitting"), 3, chosen)
    other = dataclasses.replace(trial("splitting"), repeat=2)
    assert herds.environment(other, 3, chosen) != first
    assert herds.environment(trial("splitting"), 4, chosen) != first
    varied = trial("splitting", varied="all")
    assert herds.environment(varied, 3, fields.chosen_by(varied)) != first


@pytest.mark.parametrize(
    ("varied", "told"),
    [
        ("angel_deg", "angle_deg"),
        ("angle_deg=90", r"NAME=LOW\.\.HIGH"),
        ("angle_deg=90..400", r"within 0\.\.360"),
        ("angle_deg=90..80", r"within 0\.\.360"),
        ("angle_deg=a..b", r"NAME=LOW\.\.HIGH"),
    ],
)
def test_what_cannot_be_varied_is_refused(varied: str, told: str) -> None:
    with pytest.raises(InputError, match=told):
        check(trial("dirt", varied=varied))


def test_all_are_those_that_have_bounds() -> None:
    assert candidates.bounded(found.load("dirt")) == ["angle_deg", "length_m", "anchor"]
    assert candidates.bounded(found.load("hierarchical")) == []


def test_stages_stand_beside_those_of_the_empty_world() -> None:
    classes = [
        group("random-motion", 2, name=name, law_parameters={"speed_m_s": 0.1, "turn_rad": 0.5}, obstacles="avoid")
        for name in ("one", "other")
    ]
    made = fields.trial("some", 1, classes, "cattle", formation_parameters={"size_m": 4.0}, environments=2)
    made = with_setup(made, {"iterations": 30, "varied": "corral_m"})
    result = run_trial(settled(made), reraise=True)
    assert [name for name in result.measures if "stage" in name] == [
        name for stage in (1, 2, 3) for name in (f"stage_{stage}", f"control_stage_{stage}")
    ]
    assert result.tables["stages"].shape == result.tables["control_stages"].shape == (2, 3)
    assert result.measures["stage_1"] == result.measures["control_stage_1"] == 0.0  # in 3 m nobody reaches the pen


def test_a_schema_of_the_users_own_travels_as_text(tmp_path: Path) -> None:
    grammar = tmp_path / "tree.toml"
    grammar.write_text((found.FOLDER / "splitting.toml").read_text())
    python = tmp_path / "wall.py"
    python.write_text((found.FOLDER / "dirt.py").read_text())
    for path, name in ((grammar, "splitting"), (python, "dirt")):
        made = keys.put(trial("weiring"), "world", str(path))
        assert made.world_source == path.read_text()
        path.unlink()
        assert fields.schema_of(made).parameters().__class__.__name__ == "Parameters"
        own, published = (herds.environment(each, 2, fields.chosen_by(each)).construct for each in (made, trial(name)))
        assert own == published


def test_a_grammar_is_no_world_of_robots_or_of_one_herd(tmp_path: Path) -> None:
    from worlds import known

    (tmp_path / "tree.toml").write_text((found.FOLDER / "splitting.toml").read_text())
    with pytest.raises(InputError, match="a herd needs one environment"):
        known.load(str(tmp_path / "tree.toml"))
