"""Disturbed herds: each key reaches the robots, what it cannot reach is refused, pushes are spread over the test."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from flocking.errors import InputError
from robots.one_legged import ground as one_legged_ground
from robots.one_legged.model import FOOT_FRICTION
from robots.one_legged.stepping import MOST_TORQUE
from trials import simulations
from trials.simulations.running import disturbances, fields
from trials.types import Trial, TrialResult


def trial(body: str = "one-legged", count: int = 4, duration_s: float = 4.0, **keys: Any) -> Trial:
    """`keys` with `__` for dots; those of the herd begin with `imperfections`."""
    named = {key.replace("__", "."): value for key, value in keys.items()}
    own = {key: named.pop(key) for key in list(named) if key.startswith(disturbances.IMPERFECTIONS)}
    group = fields.herd(count, body=body, **own)
    return fields.trial("a-test", 1, group, duration_s=duration_s, **named)


def ran(**keys: Any) -> TrialResult:
    return simulations.run_trial(trial(**keys), reraise=True)


@pytest.fixture(scope="module")
def undisturbed() -> TrialResult:
    return ran()


# far beyond what the robots bear (docs/one_legged.md), so that some fall within 4 s
@pytest.mark.parametrize(
    "keys",
    [
        {"ground__friction": 0.05},
        {"ground__uneven_m": 0.3, "ground__bump_m": 1.0},
        {"push__impulse_n_s": 400.0, "push__every_s": 2.0},
        {"imperfections__torque_n_m": 1.0},
        {"imperfections__velocity_m_s": 6.0},
        {"imperfections__angle_deg": 30.0},
        {"imperfections__rate_deg_s": 200.0},
        {"imperfections__delay_s": 0.03},
    ],
    ids=lambda keys: next(iter(keys)),
)
def test_a_lot_of_each_fells_robots_that_run_on_without(keys: dict[str, Any], undisturbed: TrialResult) -> None:
    assert undisturbed.measures["upright"] == 1.0
    assert np.isnan(undisturbed.measures["first_fall"])
    disturbed = ran(**keys)
    assert disturbed.measures["falls"] > 0
    assert 0.0 < disturbed.measures["first_fall"] <= 4.0
    assert disturbed.measures["first_fall"] == np.nanmin(disturbed.tables["fallen_s"])
    assert all(
        cause for cause, at in zip(disturbed.tables["causes"], disturbed.tables["fallen_s"], strict=True) if at > 0
    )


def test_defaults_are_the_undisturbed_body() -> None:
    given = trial()
    assert disturbances.ground_of(given).friction == FOOT_FRICTION
    assert disturbances.imperfections_of(given).torque_n_m == MOST_TORQUE
    plain = one_legged_ground.build(np.zeros((2, 3)), np.zeros(2))
    made = disturbances.built(given, one_legged_ground, np.zeros((2, 3)), np.zeros(2))
    plain.run(0.6)
    made.run(0.6)
    assert_array_equal(plain.data.qpos, made.data.qpos)


def test_uneven_ground_reaches_as_far_as_the_herd_may_run() -> None:
    given = trial(ground__uneven_m=0.02, duration_s=20.0)
    made = disturbances.built(given, one_legged_ground, np.zeros((1, 3)), np.zeros(1))
    assert made.model.hfield_size[0, 0] == pytest.approx(disturbances.reach_m(given))
    assert disturbances.reach_m(given) > 2.0 * 20.0  # m/s told, for so long


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"body": "particles", "ground__friction": 0.3}, "ground.friction = 0.3 does nothing to point masses"),
        ({"body": "particles", "push__impulse_n_s": 5.0}, "expected herd.body=one-legged"),
        ({"body": "particles", "imperfections__delay_s": 0.005}, r"herd\.imperfections\.delay_s"),
        ({"imperfections__delay_s": 0.012}, "such as 0.01$"),
        ({"ground__uneven_m": 0.1, "duration_s": 5000.0}, "ground.bump_m = 2: expected at least"),
        ({"ground__friction": 0.0}, "expected a number from 0.01"),
        ({"imperfections__torque_n_m": -1.0}, "torque_n_m = -1"),
    ],
)
def test_what_does_nothing_or_does_not_fit_is_refused(keys: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        simulations.check(trial(**keys))


def test_each_robot_is_pushed_once_in_each_period_of_the_test() -> None:
    given = trial(count=50, duration_s=50.0, settle_s=10.0, push__impulse_n_s=60.0, push__every_s=20.0)
    found = disturbances.drawn_pushes(given)
    times = found.steps * 0.005
    assert (np.diff(times) >= 0.0).all()
    assert times.min() >= 10.0
    assert times.max() <= 50.0
    for robot in range(50):
        own = times[found.robots == robot]
        assert ((own - 10.0) // 20.0).tolist() == [0.0, 1.0]
    np.testing.assert_allclose(np.hypot(*found.impulses_w[:, :2].T), 60.0)
    # of 100 random directions the mean is within four standard errors of zero: 4 / sqrt(2 · 100)
    assert np.hypot(*(found.impulses_w[:, :2].mean(axis=0) / 60.0)) < 4.0 / np.sqrt(200.0)
    again = disturbances.drawn_pushes(given)
    assert_array_equal(found.steps, again.steps)
    other = disturbances.drawn_pushes(dataclasses.replace(given, repeat=2))
    assert not np.array_equal(found.steps, other.steps)
    assert len(disturbances.drawn_pushes(trial()).steps) == 0
