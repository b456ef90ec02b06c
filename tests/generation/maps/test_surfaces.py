"""The probability surface and the intervals, against closed forms and SciPy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from generation.maps.spaces import Axis, Box
from generation.maps.surfaces import interval, surface
from generation.maps.trees import Judged, ParameterMap, refined, scattered

BOX = Box((Axis("x", "m", 0.0, 1.0, 1), Axis("y", "m", 0.0, 1.0, 1)))


def test_one_configuration_alone_gives_jeffreys_posterior() -> None:
    judged = Judged(np.array([20]), np.array([18]), np.array([0.9]), np.zeros(1))
    map_ = ParameterMap(BOX, np.array([[0.5, 0.5]]), np.zeros(1, np.int64), np.zeros((1, 2), np.int64), judged, 0.9)
    found = surface(map_, np.array([[0.5, 0.5], [0.5, 1.0]]))
    assert found.probability[0] == pytest.approx(18.5 / 21.0)
    weight = math.exp(-0.5 * 0.5**2)  # half a cell away
    assert found.probability[1] == pytest.approx((0.5 + 18 * weight) / (1.0 + 20 * weight))
    low, high = interval(judged.successes, judged.trials)
    expected = stats.beta(18.5, 2.5).ppf([0.025, 0.975])
    assert [low[0], high[0]] == pytest.approx(expected)
    assert [found.low[0], found.high[0]] == pytest.approx(expected)


def test_of_one_probability_everywhere_the_unequal_samples_of_a_tree_make_no_other() -> None:
    rng, box = np.random.default_rng(7), Box((Axis("x", "m", 0.0, 1.0, 8), Axis("y", "m", 0.0, 1.0, 8)))

    def judge(points, levels, cells):  # type: ignore[no-untyped-def]
        won = rng.binomial(20, 0.8, len(points))
        return Judged(np.full(len(points), 20), won, won / 20, np.zeros(len(points)))

    map_ = refined(box, judge, 2, 0.9, 0, np.random.default_rng(1))
    places = np.random.default_rng(2).random((400, 2))
    found = surface(map_, places)
    # one configuration has a standard error of sqrt(0.8 * 0.2 / 20) = 0.09, and a hundred stand for the box; that
    # a chance success is split and judged anew bends the mean by less than that
    assert found.probability.mean() == pytest.approx(0.8, abs=0.02)
    assert ((found.low < 0.8) & (found.high > 0.8)).mean() > 0.85


def test_of_random_configurations_the_surface_follows_a_slope() -> None:
    rng = np.random.default_rng(11)

    def judge(points, levels, cells):  # type: ignore[no-untyped-def]
        won = rng.binomial(20, points[:, 0])
        return Judged(np.full(len(points), 20), won, won / 20, np.zeros(len(points)))

    map_ = scattered(BOX, judge, 600, 0.9, np.random.default_rng(1))
    places = np.column_stack([np.linspace(0.1, 0.9, 9), np.full(9, 0.5)])
    found = surface(map_, places)
    # some 2 pi of 600 configurations count, of 20 simulations each: standard error 0.045 at the most, and three of them
    assert np.abs(found.probability - places[:, 0]).max() < 0.14


def test_a_finely_sampled_region_does_not_outweigh_its_surroundings() -> None:
    box = Box((Axis("x", "m", 0.0, 1.0, 8), Axis("y", "m", 0.0, 1.0, 8)))

    def judge(points, levels, cells):  # type: ignore[no-untyped-def]
        won = np.where(np.abs(points[:, 0] - 0.3) < 0.1, 20, 4)
        return Judged(np.full(len(points), 20), won, won / 20, np.zeros(len(points)))

    map_ = refined(box, judge, 4, 0.9, 0, np.random.default_rng(1), "all")
    found = surface(map_, np.array([[0.3, 0.5], [0.7, 0.5]]))
    assert found.probability[0] > 0.95
    assert found.probability[1] == pytest.approx(0.2, abs=0.03)  # what lies two cells and more away adds a bit


def test_there_is_no_probability_where_the_schema_makes_nothing() -> None:
    box = Box((Axis("x", "m", 0.0, 1.0, 8), Axis("y", "m", 0.0, 1.0, 8)))

    def judge(points, levels, cells):  # type: ignore[no-untyped-def]
        trials = np.where(points.sum(axis=1) <= 1.0, 20, 0)
        return Judged(trials, trials, np.where(trials > 0, 1.0, np.nan), np.zeros(len(points)))

    found = surface(refined(box, judge, 0, 0.9, 0, np.random.default_rng(1)), np.array([[0.2, 0.2], [0.9, 0.9]]))
    assert np.isfinite(found.probability).tolist() == [True, False]
    assert np.isfinite(found.low).tolist() == [True, False]
