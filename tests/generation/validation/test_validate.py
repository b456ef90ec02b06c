"""Validation: controls share the starts, behaviours keep their promise, perturbations of nothing change nothing."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
import pytest
from scipy import stats

from flocking.errors import InputError
from flocking.types import Floats
from generation.behaviours import Behaviour
from generation.environment import Environment
from generation.group import Job
from generation.primitives import Circle, Point, Polyline, Segment
from generation.validation.robustness import STARTS, WALLS, perturbed, ranked, robustness
from generation.validation.starts import Starts, axis, mirrored, poses
from generation.validation.uplift import over_environments, paired, rate
from generation.validation.validate import Plan, empty, jobs_of, overall, validate

FORK = Environment(
    workspace=(Segment(-50.0, -50.0, 50.0, -50.0),),
    construct=(Segment(10.0, -5.0, 10.0, 5.0), Polyline(((10.0, 5.0), (20.0, 9.0))), Circle(0.0, 30.0, 2.0)),
    markers={"start": Point(0.0, 0.0, 0.5)},
)


class Nothing(NamedTuple):
    """No parameters."""


class Straight:
    """A group that goes straight on, through everything, and keeps what it was asked."""

    count = 4

    def __init__(self) -> None:
        self.jobs: list[Job] = []

    def trajectories(self, jobs: Sequence[Job], iterations: int) -> Iterator[Floats]:
        for job in jobs:
            self.jobs.append(job)
            heading = job.poses_w[:, 2]
            step = np.column_stack([np.cos(heading), np.sin(heading)])
            yield job.poses_w[:, :2] + np.arange(iterations + 1)[:, None, None] * step


def behaviour(fitness: Any, iterations: int = 10) -> Behaviour:
    return Behaviour("made-up", "for a test", Nothing, iterations, 1.0, fitness)


def walled(positions: Floats, environment: Environment, parameters: Nothing) -> float:
    return float(len(environment.construct) > 0)


def test_the_control_has_the_same_starts_and_numbers_in_the_empty_world() -> None:
    group = Straight()
    found = list(validate([FORK, FORK], behaviour(walled), group, Plan(Starts(side_m=6.0), repeats=3)))
    assert [one.number for one in found] == [0, 1]
    for first in (0, 6):
        for job, control in zip(group.jobs[first : first + 3], group.jobs[first + 3 : first + 6], strict=True):
            np.testing.assert_array_equal(job.poses_w, control.poses_w)
            assert job.seed == control.seed
            assert job.environment == FORK
            assert control.environment == empty(FORK)
            assert control.environment.workspace == FORK.workspace
            assert control.environment.construct == ()
    starts = [job.poses_w.tobytes() for job in group.jobs]
    assert len(set(starts)) == 6  # of twelve simulations: all starts differ, but for the controls
    assert found[0].uplift.uplift == overall(found).uplift == 1.0


def test_blocks_and_their_numbers_change_nothing() -> None:
    plan = Plan(Starts(side_m=6.0), repeats=2)
    whole, parts = Straight(), Straight()
    list(validate([FORK] * 3, behaviour(walled), whole, plan))
    for number in range(3):
        list(validate([FORK], behaviour(walled), parts, plan, begin=number))
    for one, other in zip(whole.jobs, parts.jobs, strict=True):
        np.testing.assert_array_equal(one.poses_w, other.poses_w)
        assert one.seed == other.seed


def test_mirrored_starts_come_in_pairs() -> None:
    jobs = jobs_of(FORK, 0, 4, Plan(Starts(side_m=6.0), repeats=2, mirror=True))
    assert len(jobs) == 4
    for one, other in itertools.pairwise(jobs[:2]):
        np.testing.assert_allclose(mirrored(other.poses_w, axis(FORK)), one.poses_w, atol=1e-12)  # rounding
        assert one.seed == other.seed
    onto = mirrored(np.array([[math.cos(0.5), math.sin(0.5), 0.5]]), axis(FORK))[0]
    np.testing.assert_allclose(onto, [math.cos(0.5), math.sin(0.5), 0.5], atol=1e-12)  # the axis mirrors onto itself


@pytest.mark.parametrize(("value", "told"), [(1.7, "1.7"), (math.nan, "nan"), ("much", "'much'")])
def test_a_behaviour_that_returns_no_fitness_is_refused_and_what_came_before_stands(value: Any, told: str) -> None:
    calls = itertools.count()

    def fitness(positions: Floats, environment: Environment, parameters: Nothing) -> Any:
        return 0.5 if next(calls) < 4 else value

    tried = validate([FORK] * 4, behaviour(fitness), Straight(), Plan(Starts(side_m=6.0)))
    assert [next(tried).number, next(tried).number] == [0, 1]
    with pytest.raises(InputError, match=f"returned the fitness {told}"):
        next(tried)


def test_a_start_without_room_is_refused_after_the_environments_before_it() -> None:
    cage = dataclasses.replace(FORK, construct=tuple(Segment(x, -0.1, x, 0.1) for x in (-0.05, 0.05)))
    closed = dataclasses.replace(
        cage, construct=(*cage.construct, Segment(-0.05, -0.1, 0.05, -0.1), Segment(-0.05, 0.1, 0.05, 0.1))
    )
    tried = validate([FORK, closed], behaviour(walled), Straight(), Plan(Starts(side_m=60.0)))
    assert next(tried).number == 0
    with pytest.raises(InputError, match="environment 2: only 0 of 4 members fit"):
        next(tried)


def test_starts_are_where_they_should_be() -> None:
    wall = dataclasses.replace(FORK, construct=(Segment(2.0, -50.0, 2.0, 50.0),))
    starts = Starts(side_m=20.0, spread_rad=0.2, apart_m=1.0, clear_m=0.5)
    placed = poses(wall, 30, starts, np.random.default_rng(1))
    gaps = np.hypot(*(placed[:, None, :2] - placed[None, :, :2]).transpose(2, 0, 1)) + 9.0 * np.eye(30)
    assert gaps.min() >= 1.0
    assert placed[:, 0].max() <= 1.5  # on the marker's side of the wall, and clear of it
    c, s = math.cos(0.5), math.sin(0.5)
    along, across = c * placed[:, 0] + s * placed[:, 1], c * placed[:, 1] - s * placed[:, 0]
    assert max(np.abs(along).max(), np.abs(across).max()) <= 10.0  # in the square that is turned with the marker
    assert np.abs(placed[:, 2] - 0.5).max() <= 0.2


class TestPerturbed:
    def test_by_nothing_is_the_same(self) -> None:
        assert perturbed(FORK, 0.0, np.random.default_rng(1)) == FORK

    def test_ends_move_within_epsilon_and_those_that_meet_move_together(self) -> None:
        rng = np.random.default_rng(2)
        reached = []
        for _ in range(200):
            moved = perturbed(FORK, 0.3, rng)
            assert moved.workspace == FORK.workspace
            segment, line, circle = moved.construct
            assert isinstance(segment, Segment)
            assert isinstance(line, Polyline)
            assert isinstance(circle, Circle)
            assert (segment.x1_m, segment.y1_m) == line.points_m[0]
            assert circle.radius_m == 2.0
            reached.append(math.hypot(circle.x_m, circle.y_m - 30.0))
        assert max(reached) <= 0.3
        # uniform in a disc: the squared distance over epsilon squared is uniform; one seed in a thousand misses it
        assert stats.kstest((np.array(reached) / 0.3) ** 2, "uniform").pvalue > 1e-3

    def test_what_depends_on_nothing_succeeds_always_or_never_and_adds_nothing_to_the_empty_world(self) -> None:
        plan = Plan(Starts(side_m=6.0), repeats=5)
        always, never = (
            robustness(FORK, 0, behaviour(lambda *_, v=v: v), Straight(), plan, 0.5, {"others": Straight()})
            for v in (1.0, 0.0)
        )
        assert set(always.kinds) == {STARTS, WALLS, "others"}
        assert {found.rate.rate for found in always.kinds.values()} == {1.0}
        assert {found.rate.rate for found in never.kinds.values()} == {0.0}
        assert always.mean == never.mean == 0.0
        assert always.kinds[WALLS].rate.n == always.kinds[WALLS].uplift.n == 5

    def test_what_needs_the_construct_is_ranked_before_what_happens_anyway(self) -> None:
        plan = Plan(Starts(side_m=6.0), repeats=5)
        walls, anyway = (
            robustness(FORK, number, behaviour(of), Straight(), plan, 0.5)
            for number, of in enumerate((walled, lambda *_: 1.0))
        )
        assert [one.number for one in ranked([anyway, walls])] == [0, 1]
        assert (walls.mean, anyway.mean) == (1.0, 0.0)

    def test_all_kinds_are_tried_from_new_starts_which_moved_walls_and_the_empty_world_share(self) -> None:
        plan, group = Plan(Starts(side_m=6.0), repeats=2), Straight()
        robustness(FORK, 0, behaviour(walled), group, plan, 0.0)
        used = {job.poses_w.tobytes() for job in jobs_of(FORK, 0, 4, plan)}
        new = jobs_of(FORK, 0, 4, plan._replace(seed=plan.seed + 1))
        assert len(group.jobs) == 3 * len(new)
        for job, other in zip(group.jobs, 3 * new, strict=True):
            np.testing.assert_array_equal(job.poses_w, other.poses_w)
            assert job.poses_w.tobytes() not in used
        # walls that move by nothing are those that stand
        assert sum(job.environment == FORK for job in group.jobs) == 2 * len(new)
        assert sum(not job.environment.construct for job in group.jobs) == len(new)


class TestUplift:
    def test_rates_have_wilsons_interval(self) -> None:
        for k, n in ((0, 10), (3, 10), (10, 10), (1, 1)):
            found = rate(np.arange(n) < k)
            expected = stats.binomtest(k, n).proportion_ci(0.95, method="wilson")
            assert found.low == pytest.approx(expected.low, abs=1e-12)
            assert found.high == pytest.approx(expected.high, abs=1e-12)
        assert math.isnan(rate(np.zeros(0, np.bool_)).rate)

    def test_the_published_example_of_the_paired_interval(self) -> None:
        # Newcombe 1998, table II, method 10: 36 both, 12 and 2 discordant, 0 neither: 0.0569 to 0.3404
        with_it = np.repeat([True, True, False], [36, 12, 2])
        without = np.repeat([True, False, True], [36, 12, 2])
        found = paired(with_it, without)
        assert found.uplift == pytest.approx(0.2)
        assert (round(found.low, 4), round(found.high, 4)) == (0.0569, 0.3404)
        assert found.p == pytest.approx(stats.binomtest(12, 14, 0.5).pvalue)

    def test_the_interval_covers_the_truth_as_often_as_it_says(self) -> None:
        rng, covered, runs = np.random.default_rng(5), 0, 600
        for _ in range(runs):
            base = rng.random(40)
            with_it, without = base < 0.7, np.where(rng.random(40) < 0.5, base, rng.random(40)) < 0.4
            found = paired(with_it, without)
            covered += found.low <= 0.3 <= found.high
        # 95 %, and four standard errors of 600 runs
        assert covered / runs >= 0.95 - 4.0 * math.sqrt(0.05 * 0.95 / runs)

    def test_over_environments(self) -> None:
        rng = np.random.default_rng(6)
        with_it, without = rng.random(200), np.zeros(200)
        found = over_environments(with_it, without)
        spread = with_it.std(ddof=1) / math.sqrt(200)
        assert found.uplift == pytest.approx(with_it.mean())
        # percentiles of 2000 resamples against the normal interval, which 200 numbers justify to a tenth
        assert found.high - found.low == pytest.approx(2 * 1.96 * spread, rel=0.1)
        alike = over_environments(np.ones(10), np.zeros(10))
        assert alike.low < 0.9 < alike.uplift == alike.high  # ten that are alike prove no certainty
        assert overall([]).n == 0
