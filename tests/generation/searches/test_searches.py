"""Searches: with a group whose success is a closed form each finds the best, at its budget, the same each time."""

import math

import numpy as np
import pytest

from flocking.errors import InputError
from generation.searches import descriptors
from generation.searches.methods import METHODS, Answer, Grid
from generation.searches.robustness import Robustness
from generation.searches.searching import cells_of, coverage, search
from generation.searches.spaces import searchable, space_of, usual
from generation.validation.starts import Starts
from tests.generation.searches.synthetic import BEST_DEG, BEST_M, FAR, WALL, NoParameters, Walkers, Wall, score

SPACE = space_of(Wall())
GRID = Grid(np.array([[0.0, 4.0], [0.0, 360.0]]), (8, 12))


def robustness(group, schema=WALL, ends_m=0.0):
    return Robustness(
        schema, schema.workspace(), FAR, NoParameters(), (group,), Starts(1.0, 0.1), FAR.iterations, ends_m,
        ("fence_m", "angle_deg"),
    )  # fmt: skip


def found_by(method, seed, points=200, space=SPACE, pairs=10):
    goal = robustness(Walkers())
    judge = goal.judge(space, (seed, 1), 2 * pairs)
    return search(METHODS[method](space, GRID, np.random.default_rng(seed)), judge, points)


@pytest.mark.parametrize("method", METHODS)
def test_each_search_comes_near_the_best_wall(method):
    """Random points come nearer than 0.6 with a probability of 0.9999 in 200; ten pairs of starts resolve a tenth."""
    for seed in range(2):
        found = found_by(method, seed)
        angle, length = SPACE.values(found.points[found.best][None])[0]
        assert score(angle, length) > 0.6


def test_cma_es_comes_nearer_than_random_points_without_noise():
    """On the closed form itself: over ten seeds its mean gap is less than half that of random points."""

    def judge(points):
        values = SPACE.values(points)
        return Answer(np.array([score(*each) for each in values.tolist()]), values[:, ::-1])

    gaps = {}
    for method in ("random", "cma-es"):
        best = [
            search(METHODS[method](SPACE, GRID, np.random.default_rng(seed)), judge, 200).values.max()
            for seed in range(10)
        ]
        gaps[method] = 1.0 - np.mean(best)
    assert gaps["cma-es"] < 0.5 * gaps["random"]


@pytest.mark.parametrize("method", METHODS)
def test_equal_seeds_give_equal_searches_and_others_do_not(method):
    state = np.random.get_state()[1].copy()  # noqa: NPY002 (that no library draws from it)
    one, again, other = (found_by(method, seed, points=40, pairs=3) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one.points, again.points)
    np.testing.assert_array_equal(one.values, again.values)
    assert not np.array_equal(one.points, other.points)
    np.testing.assert_array_equal(state, np.random.get_state()[1])  # noqa: NPY002


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("points", [1, 7, 33])
def test_budgets_are_kept_exactly(method, points):
    group = Walkers()
    judge = robustness(group).judge(SPACE, (3,), 4)
    found = search(METHODS[method](SPACE, GRID, np.random.default_rng(3)), judge, points)
    assert found.points.shape == (points, 2)
    assert group.simulations == 4 * points
    assert ((found.points >= 0.0) & (found.points <= 1.0)).all()


@pytest.mark.parametrize("method", METHODS)
def test_one_parameter_alone_can_be_searched(method):
    space = space_of(Wall(angle_deg=BEST_DEG), ["length_m"])
    found = found_by(method, 1, points=60, space=space)
    assert abs(space.values(found.points[found.best][None])[0, 0] - BEST_M) < 0.5


def test_the_robustness_of_many_simulations_is_the_score():
    """4000 simulations, of which those of a pair share their draws: three standard errors are 0.034 at the most."""
    walls = [Wall(angle_deg=angle, length_m=length) for angle, length in ((10.0, 3.0), (30.0, 3.0), (350.0, 2.0))]
    found = robustness(Walkers()).robustness(walls, (7,), 4000)
    np.testing.assert_allclose(found, [score(wall.angle_deg, wall.length_m) for wall in walls], atol=0.034)


def test_the_control_has_no_construct():
    assert robustness(Walkers(noise=False)).control(Wall(BEST_DEG, BEST_M), (1,), 4) == 0.0


def test_points_do_not_change_one_anothers_luck():
    goal = robustness(Walkers(), ends_m=0.3)
    walls = [Wall(angle_deg=angle, length_m=2.0) for angle in (0.0, 20.0, 40.0)]
    together = goal.robustness(walls, (5,), 12)
    np.testing.assert_array_equal(together, [goal.robustness([wall], (5,), 12)[0] for wall in walls])


def test_group_sizes_have_simulations_in_turn():
    small, large = Walkers(2), Walkers(5)
    goal = robustness(small)
    goal = Robustness(*(getattr(goal, name) for name in goal.__dataclass_fields__ if name != "told"))
    both = Robustness(**{**vars(goal), "groups": (small, large)})
    both.robustness([Wall()], (1,), 12)
    assert (small.simulations, large.simulations) == (6, 6)


def test_parameters_that_a_schema_refuses_have_no_robustness_and_cost_as_much():
    def refuse(parameters, workspace, rng):
        raise InputError("no")

    group = Walkers()
    goal = robustness(group, WALL.__class__(**{**vars(WALL), "generate": refuse}))
    answer = goal.judge(SPACE, (1,), 4)(np.full((3, 2), 0.5))
    np.testing.assert_array_equal(answer.values, 0.0)
    assert np.isfinite(answer.descriptors).all()
    assert group.simulations == 0


def test_archives_keep_the_best_of_each_cell():
    rng = np.random.default_rng(1)

    def judge(points):
        return Answer(rng.random(len(points)), SPACE.values(points)[:, ::-1])

    found = search(METHODS["random"](SPACE, GRID, rng), judge, 300)
    cells, elites = found.elites(GRID)
    every = cells_of(found.descriptors, GRID)
    assert set(cells) == set(every)
    for cell, elite in zip(cells, elites, strict=True):
        assert found.values[elite] == found.values[every == cell].max()
    assert coverage(cells, GRID) == len(set(every)) / 96


def test_incumbents_are_the_running_maxima():
    def judge(points):
        return Answer(points[:, 0].copy(), points)

    found = search(METHODS["random"](SPACE, GRID, np.random.default_rng(2)), judge, 50)
    best, holders = -math.inf, found.holders()
    for number, value in enumerate(found.values):
        best = max(best, value)
        assert found.values[found.incumbents()[holders[number]]] == best


def test_whole_numbers_have_equal_shares_and_full_turns_have_no_end():
    space = space_of(Wall(), ["angle_deg", "number"])
    shares = np.linspace(0.0, 1.0, 301)
    numbers = space.values(np.column_stack([np.full(301, 0.5), shares]))[:, 1]
    assert np.abs(np.bincount(numbers.astype(int))[1:] - 100).max() <= 1
    np.testing.assert_allclose(space.folded(np.array([[1.25, 1.25], [-0.25, -0.25]])), [[0.25, 1.0], [0.75, 0.0]])
    assert isinstance(space.at(np.array([0.5, 0.9])).number, int)


def test_what_cannot_be_searched_is_refused_in_one_line():
    assert usual(Wall) == ["angle_deg", "length_m"]
    assert searchable(Wall) == ["angle_deg", "length_m", "number"]
    for searched, told in (
        (["colour"], "is text and cannot be searched: expected one of angle_deg, length_m, number"),
        (["angle"], "angle_deg"),
        (["number", "number"], "each parameter once"),
    ):
        with pytest.raises(InputError, match=told) as refused:
            space_of(Wall(), searched)
        assert "\n" not in str(refused.value)
    with pytest.raises(InputError, match="at least 1"):
        search(METHODS["random"](SPACE, GRID, np.random.default_rng(1)), lambda points: None, 0)
    with pytest.raises(InputError, match="two or more"):
        descriptors.checked(["fence_m"])
    with pytest.raises(InputError, match="fence_m"):
        descriptors.checked(["fence", "angle_deg"])


def test_angles_of_constructs_are_averaged_as_directions():
    mean = descriptors.mean(np.array([[1.0, 350.0], [3.0, 20.0], [np.nan, np.nan]]), ("fence_m", "angle_deg"))
    np.testing.assert_allclose(mean, [2.0, 5.0])
    assert math.isnan(descriptors.mean(np.array([[np.nan]]), ("centre_x_m",))[0])
