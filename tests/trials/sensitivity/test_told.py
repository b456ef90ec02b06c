"""The text of a sensitivity analysis."""

from __future__ import annotations

import dataclasses
import shlex

import numpy as np
import pytest

from trials.design import plan
from trials.evidence.claims import Entry
from trials.sensitivity import told
from trials.sensitivity.choices import choices
from trials.sensitivity.explore import Explored, Flip
from trials.sensitivity.model import Model, supplements
from trials.sensitivity.quantity import NOTHING


def test_the_commands_of_a_flip_run_the_trials_that_the_point_had_with_those_of_the_supplement_first() -> None:
    varied, _ = choices(plan("detection-case-study", repeats=1), ["formation.spacing_m"])
    model = Model("detection-case-study", 2, 1, varied)
    model = dataclasses.replace(model, claims=(9,), supplements=supplements(model, 9))
    entries: list[Entry] = []
    context = told.Context(model, entries, 2, 96, 1000, (), (), ())
    place = np.array([0.25])
    _, *commands = told._flip(context, Flip(place, 0.5, NOTHING))
    parts = model.planned(place)
    assert [shlex.split(each)[2] for each in commands] == ["detection-exclusion-sweep", "detection-case-study"]
    for each, part in zip(commands, reversed(parts), strict=True):
        _, _, experiment, *words = shlex.split(each)
        given = dict(zip(words[::2], words[1::2], strict=True))
        assert given == {"--repeats": "2", "--set": "formation.spacing_m=0.9"}
        made = plan(experiment, repeats=2, settings={"formation.spacing_m": 0.9}).trials
        assert [dataclasses.replace(trial, index=0) for trial in made] == [
            dataclasses.replace(trial, index=0) for trial in part.trials
        ]


@pytest.mark.parametrize(
    ("repeats", "said"), [(1, "1 choice varied, 1 point of 9 trials (1 repeat, the"), (3, "(3 repeats, the")]
)
def test_a_single_repeat_is_said_to_tell_no_effect_from_noise(repeats: int, said: str) -> None:
    varied, _ = choices(plan("detection-case-study", repeats=1), ["formation.spacing_m"])
    model = dataclasses.replace(Model("detection-case-study", repeats, 1, varied), claims=())
    lines = told.told(
        told.Context(model, [], repeats, 9, 1000, (), (), ("another",)), Explored([], [], 4, 0, 1, [])
    ).splitlines()
    assert said in lines[0]
    assert (f"note: {told.SINGLE}" in lines) == (repeats == 1)
    assert "note: another" in lines
