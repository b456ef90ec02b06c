"""Heterogeneous groups: parameters that differ from member to member."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from flocking.errors import InputError
from trials import keys, simulations
from trials.design import plan
from trials.simulations.kinematic import fields
from trials.simulations.kinematic.herd import assemble
from trials.simulations.robots import herd as robots
from trials.types import Trial

MEMBERS = 200


def kinematic(**law: float) -> Trial:
    return fields.trial("made-up", 1, [fields.group("vicsek", MEMBERS, law_parameters=dict(law))], steps=5)


def values(trial: Trial, name: str) -> np.ndarray:
    (band,) = assemble(trial).bands
    assert isinstance(band.parameters, list)
    return np.array([one[name] for one in band.parameters])


def test_each_member_has_its_own_value_within_the_share() -> None:
    trial = keys.put(kinematic(range_m=10.0), "herd.spread.range_m", 0.2)
    found = values(trial, "range_m")
    assert len(set(found)) == MEMBERS
    assert (found >= 8.0).all()
    assert (found <= 12.0).all()
    # uniform over 4 m: the mean of 200 has a standard error of 4/sqrt(12·200) = 0.082 m
    assert abs(found.mean() - 10.0) < 4.0 * 0.082


def test_the_same_seed_gives_the_same_members_however_many_they_are() -> None:
    trial = keys.put(kinematic(range_m=10.0), "herd.spread.range_m", 0.2)
    fewer = keys.put(trial, "herd.count", 5)
    assert values(trial, "range_m")[:5].tolist() == values(fewer, "range_m").tolist()
    other = dataclasses.replace(trial, seed=2)
    assert values(trial, "range_m")[0] != values(other, "range_m")[0]


def test_values_keep_within_the_parameters_bounds_and_whole_numbers_stay_whole() -> None:
    trial = fields.trial("made-up", 1, [fields.group("snn", 50)])
    wide = keys.put(trial, "herd.spread.repulsion_m", 1.0)
    assert [row.key for row in keys.rows(wide) if ".spread." in row.key] == ["herd.spread.repulsion_m"]
    assert (values(wide, "repulsion_m") >= 0.0).all()


def test_the_members_run_by_their_own_values() -> None:
    """A herd whose members differ moves differently; one whose spread is 0 moves the same."""
    trial = kinematic(noise_rad=0.0)
    alike = simulations.run_trial(trial).poses_w
    same = simulations.run_trial(keys.put(trial, "herd.spread.range_m", 0.0)).poses_w
    apart = simulations.run_trial(keys.put(trial, "herd.spread.range_m", 0.5)).poses_w
    assert (same == alike).all()
    assert (apart[-1] != alike[-1]).any()


def test_robots_too_have_values_of_their_own() -> None:
    trial = plan("detection-case-study", repeats=1).trials[0]
    alike = robots.assemble(trial, record=False).robots
    assert len({tuple(robot.law_parameters) for robot in alike}) == 1
    apart = robots.assemble(keys.put(trial, "herd.spread.repulsion_m", 0.3), record=False).robots
    assert len({tuple(robot.law_parameters) for robot in apart}) == len(apart)


def test_members_whose_values_rule_each_other_out_are_refused_before_the_trial_runs() -> None:
    """Ranges of 1.2 m, a fifth to either side, stay above springs of 0.9 m; half to either side they do not."""
    law = {"range_m": 1.2, "length_m": 0.9}
    trial = fields.trial("made-up", 1, [fields.group("akama-naruse", MEMBERS, law_parameters=law)], steps=5)
    near = keys.put(trial, "herd.spread.range_m", 0.2)
    simulations.check(near)
    assert values(near, "range_m").min() > 0.9
    far = keys.put(trial, "herd.spread.range_m", 0.5)
    for refuse in (simulations.check, assemble):
        with pytest.raises(InputError, match=r"length_m at most range_m, which herd.spread.range_m = 0.5 breaks for"):
            refuse(far)


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("herd.spread.rnge_m", 0.1, "herd.spread.range_m"),
        ("herd.spread.range_m", -0.1, "expected a number from 0 to 1"),
        ("herd.spread.range_m", "wide", "expected a number"),
    ],
)
def test_what_cannot_be_is_refused(key: str, value: object, said: str) -> None:
    with pytest.raises(InputError, match=said):
        keys.put(kinematic(), key, value)
