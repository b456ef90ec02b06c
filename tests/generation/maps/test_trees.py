"""Maps by refinement, on regions of known shape: what is split, what it costs, and what is measured of the region."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from flocking.types import Bools, Floats, Ints
from generation.maps.flips import flip
from generation.maps.regions import components, density, region
from generation.maps.spaces import Axis, Box
from generation.maps.trees import ALL, EDGES, NOWHERE, Judge, Judged, painted, refined, scattered

SQUARE = Box((Axis("x", "m", 0.0, 1.0, 8), Axis("y", "m", 0.0, 1.0, 8)))
TURN = Box((Axis("angle_deg", "deg", 0.0, 360.0, 8), Axis("y", "m", 0.0, 1.0, 8)))
N = 20


def certain(inside: Callable[[Floats], Bools], possible: Callable[[Floats], Bools] | None = None) -> Judge:
    """Judges points (C, d) as always successful inside of a region and never outside of it."""

    def judge(points: Floats, levels: Ints, cells: Ints) -> Judged:
        there = np.ones(len(points), np.bool_) if possible is None else possible(points)
        good = inside(points) & there
        fitness = np.where(there, good.astype(np.float64), np.nan)
        return Judged(N * there.astype(np.int64), N * good.astype(np.int64), fitness, np.zeros(len(points)))

    return judge


def disc(points: Floats) -> Bools:
    """A disc of radius 0.3 in the middle of the square."""
    return np.hypot(points[:, 0] - 0.5, points[:, 1] - 0.5) < 0.3


@pytest.mark.parametrize("splits", [EDGES, ALL])
def test_the_area_of_a_disc_is_found_and_better_with_each_refinement(splits: str) -> None:
    errors = []
    for refinements in (0, 2, 4):
        map_ = refined(SQUARE, certain(disc), refinements, 0.9, 0, np.random.default_rng(1), splits)
        found = region(map_)
        errors.append(abs(found.area - math.pi * 0.09))
        assert found.components == 1.0
        assert found.largest_share == 1.0
    # cells that the circle cuts are judged by their middle: the error is below half of their area, which is at most
    # the circumference in cells, times the square root of two, of cells of 1/128
    assert errors[2] < 0.5 * 2.0 * math.pi * 0.3 * math.sqrt(2.0) / 128.0
    assert errors[2] < errors[0] + 1e-12


def test_edges_cost_twice_as_much_a_level_and_all_four_times() -> None:
    counts = {}
    for splits in (EDGES, ALL):
        map_ = refined(SQUARE, certain(disc), 5, 0.9, 0, np.random.default_rng(1), splits)
        counts[splits] = np.bincount(map_.levels)
    assert counts[EDGES][5] / counts[EDGES][4] == pytest.approx(2.0, rel=0.15)  # the perimeter, in cells
    assert counts[ALL][5] / counts[ALL][4] == pytest.approx(4.0, rel=0.15)  # the area, in cells


def test_cells_of_a_map_tile_the_box_and_no_deeper_one_lies_far_from_a_success() -> None:
    map_ = refined(SQUARE, certain(disc), 3, 0.9, 0, np.random.default_rng(1))
    owner = painted(SQUARE, map_.cells, map_.levels, 3)
    assert (owner >= 0).all()
    deep = map_.points[map_.levels == 3]
    away = np.abs(np.hypot(*(deep - 0.5).T) - 0.3)
    assert away.max() < 3.0 / 32.0 * math.sqrt(2.0)  # a neighbour's child is within three cells of the level before


def test_a_budget_is_kept_and_is_drawn_without_preference() -> None:
    whole = refined(SQUARE, certain(disc), 3, 0.9, 0, np.random.default_rng(1))
    cut = refined(SQUARE, certain(disc), 3, 0.9, 200, np.random.default_rng(2))
    assert len(cut.points) == 200 < len(whole.points)
    known = {tuple(row) for row in np.column_stack([whole.levels, whole.cells]).tolist()}
    assert {tuple(row) for row in np.column_stack([cut.levels, cut.cells]).tolist()} <= known


def test_a_region_across_the_turn_is_one_region() -> None:
    def across(points: Floats) -> Bools:
        return (points[:, 0] < 60.0) | (points[:, 0] > 300.0)

    map_ = refined(TURN, certain(across), 2, 0.9, 0, np.random.default_rng(1))
    assert region(map_).components == 1.0
    straight = Box((TURN.axes[0]._replace(unit="m"), TURN.axes[1]))
    assert region(refined(straight, certain(across), 2, 0.9, 0, np.random.default_rng(1))).components == 2.0


def test_two_discs_are_two_components_with_their_shares() -> None:
    mask = np.zeros((64, 64), np.bool_)
    mask[4:12, 4:12] = True
    mask[30:46, 30:46] = True
    labels, sizes = components(mask, np.zeros(2, np.bool_))
    assert sorted(sizes) == [64.0, 256.0]
    assert set(np.unique(labels)) == {0, 1, 2}


def test_density_is_the_area_of_strewn_successes_and_one_inside_of_a_large_region() -> None:
    rng = np.random.default_rng(3)
    strewn = rng.random((256, 256)) < 0.2
    found = density(strewn, np.ones_like(strewn), 16, np.ones(2, np.bool_))
    # each window of 256 cells holds the success itself beside 255 of probability 0.2; all of them average 13,000
    assert found == pytest.approx(0.2 + 0.8 / 256.0, abs=0.01)
    assert density(np.ones((64, 64), np.bool_), np.ones((64, 64), np.bool_), 8, np.zeros(2, np.bool_)) == 1.0


def test_what_the_schema_refuses_counts_neither_as_success_nor_as_area() -> None:
    def simplex(points: Floats) -> Bools:
        return points.sum(axis=1) <= 1.0

    def half(points: Floats) -> Bools:
        return points[:, 0] <= 0.5

    map_ = refined(SQUARE, certain(half, simplex), 4, 0.9, 0, np.random.default_rng(1))
    # of the triangle of area 1/2 the part with x up to 1/2 is 3/8; refused cells are told apart to a coarse cell
    assert region(map_).area == pytest.approx(0.75, abs=0.08)
    assert not map_.possible.all()


def test_success_inside_and_outside_of_a_box() -> None:
    def left(points: Floats) -> Bools:
        return points[:, 0] < 0.5

    map_ = refined(SQUARE, certain(left), 2, 0.9, 0, np.random.default_rng(1))
    found = region(map_, {"x": (0.25, 0.75)})
    assert found.inside == pytest.approx(0.5)
    assert found.outside == pytest.approx(0.5)
    assert region(map_, {"x": (0.0, 0.5), "y": (0.1, 0.9)}).inside == pytest.approx(1.0)


def test_random_configurations_are_uniform_and_estimate_the_area() -> None:
    map_ = scattered(SQUARE, certain(disc), 4000, 0.9, np.random.default_rng(5))
    share = map_.successful.mean()
    area = math.pi * 0.09
    assert abs(share - area) < 4.0 * math.sqrt(area * (1.0 - area) / 4000)  # four standard errors
    assert (map_.levels == NOWHERE).all()
    assert math.isnan(region(map_).area)


def test_three_and_four_parameters_are_mapped_as_two_are() -> None:
    box = Box(tuple(Axis(name, "m", 0.0, 1.0, 4) for name in "abcd"))

    def ball(points: Floats) -> Bools:
        return np.linalg.norm(points - 0.5, axis=1) < 0.4

    map_ = refined(box, certain(ball), 1, 0.9, 0, np.random.default_rng(1))
    volume = math.pi**2 / 2.0 * 0.4**4
    assert region(map_).area == pytest.approx(volume, rel=0.25)  # cells of an eighth judge a ball of radius 0.4


def test_the_nearest_two_configurations_of_opposite_outcomes() -> None:
    map_ = refined(SQUARE, certain(disc), 3, 0.9, 0, np.random.default_rng(1))
    found = flip(map_)
    assert found is not None
    good, bad = found
    assert map_.successful[good]
    assert not map_.successful[bad]
    apart = np.linalg.norm(map_.points[map_.successful][:, None] - map_.points[~map_.successful][None], axis=2)
    assert np.linalg.norm(map_.points[good] - map_.points[bad]) == pytest.approx(apart.min())
    assert flip(refined(SQUARE, certain(lambda p: p[:, 0] < 2.0), 0, 0.9, 0, np.random.default_rng(1))) is None
