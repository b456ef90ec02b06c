"""Pioneers and a post: the plan, and what holds by perfect sensing, which needs no images."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from trials import simulations
from trials.simulations.robots.fields import world_of
from trials.studies.monocular import obstacle_split
from trials.types import Trial, with_setup


def by_perfect_sensing(repeat: int, world: str = obstacle_split.POST, obstacles: str = "avoid") -> Trial:
    made = dataclasses.replace(obstacle_split.base(repeat), world=world)
    herd = with_setup(dataclasses.replace(made.groups[0], pipeline="perfect"), {"obstacles": obstacles})
    return with_setup(obstacle_split.finish(dataclasses.replace(made, groups=(herd,))), {"duration_s": 30.0})


def test_the_post_stands_in_the_way_of_the_middle() -> None:
    """A flock that keeps its course would meet it: it is wider than two columns, and ahead of all."""
    made = obstacle_split.base(1)
    post = world_of(made).values({})
    start = simulations.run_trial(with_setup(by_perfect_sensing(1), {"duration_s": 0.1})).poses_w[0]
    assert (start[:, 0] < post["x_m"] - post["radius_m"] - 1.0).all()
    assert (np.abs(start[:, 1] - post["y_m"]) < post["radius_m"]).all()


@pytest.mark.parametrize("repeat", [1, 2])
def test_by_perfect_sensing_nobody_touches_the_post_that_they_meet_if_they_do_not_avoid_it(repeat: int) -> None:
    avoids = simulations.run_trial(by_perfect_sensing(repeat), reraise=True)
    blind = simulations.run_trial(by_perfect_sensing(repeat, obstacles="as-law"), reraise=True)
    assert avoids.measures["wall_collisions"] == 0.0
    assert blind.measures["wall_collisions"] >= 1.0
    # nobody is ever nearer to the post's middle than its radius and half of a robot's width
    assert np.hypot(*(avoids.poses_w[..., :2] - (4.0, 0.0)).T).min() > 1.0 + 0.25


def test_where_nothing_stands_avoidance_changes_nothing() -> None:
    """By perfect sensing only walls are obstacles."""
    plain, avoids = (
        simulations.run_trial(by_perfect_sensing(1, obstacle_split.OPEN, way), reraise=True)
        for way in ("as-law", "avoid")
    )
    assert np.array_equal(plain.poses_w, avoids.poses_w)
