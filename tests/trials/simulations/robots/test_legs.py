"""Trials of one-legged robots: the loop, laws and measures know nothing of legs."""

from __future__ import annotations

import math

import numpy as np
import pytest

from flocking.errors import InputError
from trials.simulations import run_trial
from trials.simulations.robots.fields import group, trial
from trials.types import TrialResult


def herd(law: str, count: int = 3, **setup: object) -> TrialResult:
    """A short trial, with a Create beside the herd where `creates` says so."""
    creates = int(setup.pop("creates", 0))  # type: ignore[call-overload]
    world = str(setup.pop("world", "open-floor"))
    groups = [group(law, count, body="one-legged", pipeline="perfect", speed_m_s=1.0, **setup)]
    if creates:
        groups.append(group("snn", creates, name="wheeled", body="create", pipeline="perfect"))
    return run_trial(trial("legs", 1, groups, world=world, duration_s=8.0, timestep_s=0.005), reraise=True)


@pytest.mark.parametrize("law", ["vicsek", "reynolds-boids", "hodgins-brogan", "extended-hamilton"])
def test_they_follow_laws_of_each_kind_of_motion(law: str) -> None:
    """Heading, acceleration, velocity and way-point: they leave their places, and nobody falls."""
    led = {"informed": 1, "goal_x_m": 20.0, "goal_y_m": 0.0} if law == "hodgins-brogan" else {}
    result = herd(law, **led)
    assert result.outcome == "done"
    assert result.measures["fallen"] == 0.0
    assert math.isnan(result.measures["first_fall"])
    way = np.hypot(*(result.poses_w[-1] - result.poses_w[0])[:, :2].T)
    assert way.max() > 0.3


def test_they_run_beside_creates() -> None:
    result = herd("vicsek", creates=2)
    assert result.outcome == "done"
    assert result.poses_w.shape[1] == 5
    assert result.measures["fallen"] == 0.0


def test_walls_stop_them_and_the_touch_is_noted() -> None:
    result = herd("to-goal", count=1, world="corridor", informed=1, goal_x_m=0.0, goal_y_m=30.0)
    assert result.outcome == "done"
    touched = result.contacts
    assert len(touched.times) >= 1
    assert (np.asarray(touched.others) == -1).all()
    assert np.abs(result.poses_w[-1, 0, 1]) < 5.0


def test_creates_cannot_fall_and_are_not_asked() -> None:
    result = run_trial(trial("wheels", 1, [group("snn", 2, pipeline="perfect")], duration_s=1.0))
    assert "fallen" not in result.measures


def test_too_long_a_step_and_a_sense_that_it_lacks_are_refused() -> None:
    legs = group("vicsek", 2, body="one-legged", pipeline="perfect")
    with pytest.raises(InputError, match=r"timestep_s = 0\.01: expected at most 0\.005 s with body 'one-legged'"):
        run_trial(trial("legs", 1, [legs], duration_s=1.0))
    lasers = group("vicsek", 2, body="one-legged")
    with pytest.raises(InputError, match="body 'one-legged' of herd carries no laser"):
        run_trial(trial("legs", 1, [lasers], duration_s=1.0, timestep_s=0.005))
