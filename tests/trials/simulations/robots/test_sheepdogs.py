"""Trials in which sheepdogs drive a herd: they start behind it, follow it by either rule, and what does not fit."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from flocking.errors import InputError
from generation.free_space import distance
from generation.piloting import task as tasks
from trials import simulations
from trials.studies.piloting import design
from trials.types import Trial, with_setup

RADIUS_M = 0.165


def driven(rule: str, count: int, **setup: object) -> Trial:
    """Four Creates and so many dogs in the first task, for a few seconds."""
    trial = dataclasses.replace(design.base("shepherding", 1), seed=1)
    groups = tuple(
        dataclasses.replace(group, count=count) if group.name == "pilots" else group for group in trial.groups
    )
    given = {"piloting.guides": "sheepdogs", "piloting.rule": rule, "duration_s": 8.0, **setup}
    return design.finish(with_setup(dataclasses.replace(trial, groups=groups), given))  # type: ignore[arg-type]


@pytest.mark.parametrize(("rule", "count"), [("vaughan", 1), ("strombom", 3)])
def test_dogs_follow_the_herd_from_behind(rule: str, count: int) -> None:
    trial = driven(rule, count)
    simulations.check(trial)
    result = simulations.run_trial(trial, reraise=True)
    herd, dogs = result.poses_w[:, :4, :2], result.poses_w[:, 4:, :2]
    assert dogs.shape[1] == count
    assert (dogs[0, :, 1] < herd[0, :, 1].min()).all()  # the task's start looks along y
    centre = herd.mean(axis=1)
    assert (dogs[..., 1].mean(axis=1) < centre[:, 1]).all()
    assert dogs[-1, :, 1].mean() > dogs[0, :, 1].mean() + 0.5  # 8 s at 0.4 m/s less what it takes to start and to wait
    walls = tasks.load("task-1").environment.walls()
    assert distance(walls, dogs.reshape(-1, 2)).min() > RADIUS_M
    assert result.measures["arrived_share"] == 0.0  # 8 s are too few
    assert result.measures["walls_cleared"] == 0.0  # there are none
    assert result.measures["pilot_way"] > 0.5
    assert len(result.tables["stages"]) == 1


@pytest.mark.parametrize("seed", [2, 3])
def test_a_herd_moves_alike_whether_dogs_behind_it_follow_or_not(seed: int) -> None:
    """BOIDS see nobody behind their view of 240 degrees: what drives from there goes unnoticed."""
    alone, followed = (
        simulations.run_trial(dataclasses.replace(driven("strombom", 1, **given), seed=seed), reraise=True)
        for given in ({"piloting.guides": "nothing"}, {})
    )
    herd, dog = followed.poses_w[:, :4], followed.poses_w[:, 4:, :2]
    way = dog - herd[..., :2]
    off = np.abs(np.angle(np.exp(1j * (np.arctan2(way[..., 1], way[..., 0]) - herd[..., 2]))))
    near = np.hypot(way[..., 0], way[..., 1])
    assert near.min() < 0.55  # it does follow, and comes near
    assert not ((off < np.radians(123.0)) & (near < 0.965)).any()  # none turns back so far that it comes into view
    # nobody touches anybody, and each robot has its own streams of noise: no more than rounding
    np.testing.assert_allclose(herd, alone.poses_w[:, :4], atol=1e-6)


def test_what_does_not_fit_is_refused_in_one_line() -> None:
    trial = driven("vaughan", 1)
    with pytest.raises(InputError, match="'sheepdogs' without a group 'pilots'"):
        simulations.check(dataclasses.replace(trial, groups=trial.groups[:1]))
    with pytest.raises(InputError, match="100 sheepdogs, and room for"):
        simulations.run_trial(driven("vaughan", 100), reraise=True)
    with pytest.raises(InputError, match=r"piloting\.rule"):
        simulations.check(driven("vaughn", 1))
