"""Configurations are judged by mirrored starts: what a herd does by chance cancels, what the construct does stays."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np
import pytest

from flocking.errors import InputError
from flocking.types import Floats
from generation import behaviours
from generation.environment import Environment
from generation.found import load
from generation.group import Job
from generation.maps.judging import Judging, control, judge
from generation.maps.spaces import box_of, mappable
from generation.maps.trees import refined
from generation.validation.starts import Starts, axis, mirrored


class Walkers:
    """Members that walk straight on, whatever stands in their way; they remember what they were given."""

    count = 3

    def __init__(self) -> None:
        self.jobs: list[Job] = []

    def trajectories(self, jobs: Sequence[Job], iterations: int) -> Iterator[Floats]:
        self.jobs += jobs
        for job in jobs:
            x, y, heading = job.poses_w.T
            steps = 0.1 * np.arange(iterations + 1)[:, None]
            yield np.stack([x + steps * np.cos(heading), y + steps * np.sin(heading)], axis=-1)


def judging(schema: str, pairs: int = 4, **given: object) -> tuple[Judging, Walkers]:
    """Of a schema for the turn right."""
    loaded, behaviour, group = load(schema), behaviours.load("turn-right"), Walkers()
    fixed = loaded.parameters(**given)
    starts = Starts(1.0, math.radians(80.0))
    return Judging(loaded, fixed, behaviour, behaviour.parameters(), group, 100, pairs, starts, (1, 1)), group


def outcome(by: Judging, names: list[str], points: list[list[float]]) -> tuple[Floats, Floats]:
    box = box_of(by.schema.parameters, names, [8])
    levels, cells = np.zeros(len(points), np.int64), np.arange(2 * len(points)).reshape(-1, 2)
    found = judge(by, box, np.array(points), levels, cells, lambda _: None)
    return found.trials, found.fitness


def test_each_start_has_its_mirror_image_in_the_same_environment() -> None:
    by, group = judging("dirt")
    outcome(by, ["angle_deg", "length_m"], [[225.0, 2.5]])
    assert len(group.jobs) == 8
    mark = axis(by.schema.workspace())
    for one, other in zip(group.jobs[::2], group.jobs[1::2], strict=True):
        assert one.environment is other.environment
        assert other.poses_w == pytest.approx(mirrored(one.poses_w, mark))
        assert mirrored(other.poses_w, mark) == pytest.approx(one.poses_w)  # twice is as before
        assert one.poses_w[:, 0] == pytest.approx(-other.poses_w[:, 0])  # the junction's axis is x = 0
    starts = {tuple(job.poses_w.ravel().tolist()) for job in group.jobs}
    assert len(starts) == 8


def test_who_walks_on_through_walls_reaches_the_right_as_often_as_the_left() -> None:
    by, group = judging("dirt", pairs=50)
    _, fitness = outcome(by, ["angle_deg", "length_m"], [[225.0, 2.5]])
    goal = by.schema.workspace().markers["goal"]
    ways = list(group.trajectories(group.jobs, 100))
    other = goal._replace(x0_m=-goal.x0_m, x1_m=-goal.x1_m)  # type: ignore[union-attr]
    left = Environment(markers={"goal": other})
    assert fitness[0] == pytest.approx(np.mean([by.behaviour.judged(way, left) for way in ways]))


def test_a_schema_that_draws_makes_an_environment_anew_for_each_pair() -> None:
    by, group = judging("sirt")
    outcome(by, ["rule_1", "rule_2"], [[0.3, 0.3]])
    made = [job.environment for job in group.jobs]
    assert len({id(environment) for environment in made}) == 4
    assert all(one is other for one, other in zip(made[::2], made[1::2], strict=True))


def test_a_configuration_is_judged_alike_in_whatever_company() -> None:
    by, group = judging("sirt")
    outcome(by, ["rule_1", "rule_2"], [[0.3, 0.3], [0.1, 0.6]])
    together = group.jobs[:8]
    again, alone = judging("sirt")
    outcome(again, ["rule_1", "rule_2"], [[0.3, 0.3]])
    for one, other in zip(together, alone.jobs, strict=True):
        assert one.environment == other.environment
        assert (one.poses_w == other.poses_w).all()
        assert one.seed == other.seed


def test_what_the_schema_refuses_has_no_simulations_and_harms_no_other() -> None:
    by, _ = judging("sirt")
    trials, fitness = outcome(by, ["rule_1", "rule_2"], [[0.3, 0.3], [0.8, 0.8], [0.5, 0.1]])
    assert trials.tolist() == [8, 0, 8]
    assert np.isfinite(fitness).tolist() == [True, False, True]


def test_what_cannot_be_refined_is_refused_with_what_can() -> None:
    parameters = load("dirt").parameters
    assert mappable(parameters) == ["angle_deg", "length_m"]
    with pytest.raises(InputError, match="angle_deg"):
        box_of(parameters, ["angel_deg"], [8])
    with pytest.raises(InputError, match=r"cannot be refined.*angle_deg, length_m"):
        box_of(parameters, ["anchor"], [8])
    with pytest.raises(InputError, match="grid"):
        box_of(parameters, ["angle_deg", "length_m"], [8, 8, 8])
    with pytest.raises(InputError, match="once"):
        box_of(parameters, ["angle_deg", "angle_deg"], [8])
    with pytest.raises(InputError, match="refinements"):
        box_of(parameters, ["angle_deg", "length_m"], [8]).shape(12)


def test_the_control_has_the_starts_and_numbers_of_the_configurations_in_the_workspace_alone() -> None:
    """Members that walk through walls do there what they do with any construct."""
    by, group = judging("dirt", pairs=3)
    box = box_of(by.schema.parameters, ["angle_deg", "length_m"], [2])
    made = refined(box, partial(judge, by, box, breathe=lambda _: None), 0, 0.5, 100, np.random.default_rng(1))
    tried = list(group.jobs)
    found = control(by, made)
    assert found.success == made.judged.successes.sum() / made.judged.trials.sum()
    assert found.x_deviation == pytest.approx(made.judged.x_deviation.mean())
    assert len(group.jobs) == 2 * len(tried)
    for job, other in zip(group.jobs[len(tried) :], tried, strict=True):
        np.testing.assert_array_equal(job.poses_w, other.poses_w)
        assert job.seed == other.seed
        assert job.environment.construct == ()
        assert other.environment.construct != ()
