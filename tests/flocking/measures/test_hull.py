"""Convex hulls: closed forms, degenerate formations, periodic space."""

from __future__ import annotations

import numpy as np
import pytest

from flocking.measures.hull import convex_hull

EXACT = 1e-12
"""Rounding of some float64 operations on numbers of order 1."""


def _polygon(count: int, radius: float) -> np.ndarray:
    angles = 2 * np.pi * np.arange(count) / count
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def test_hull_of_a_rectangle_knows_nothing_of_who_stands_inside() -> None:
    corners = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [0.0, 2.0]])
    inside = np.random.default_rng(1).uniform([0.1, 0.1], [2.9, 1.9], (20, 2))
    hull = convex_hull(np.concatenate([corners, inside]))
    assert hull.area == pytest.approx(6.0, abs=EXACT)
    assert hull.perimeter == pytest.approx(10.0, abs=EXACT)


@pytest.mark.parametrize("count", [3, 7, 100])
def test_hull_of_a_regular_polygon(count: int) -> None:
    hull = convex_hull(_polygon(count, radius=2.0) + np.array([5.0, -3.0]))
    assert hull.area == pytest.approx(count / 2 * 4.0 * np.sin(2 * np.pi / count), abs=100 * EXACT)
    assert hull.perimeter == pytest.approx(2 * count * 2.0 * np.sin(np.pi / count), abs=100 * EXACT)


@pytest.mark.parametrize("members", [2, 3, 9])
def test_a_line_has_no_area_and_twice_its_length_as_perimeter(members: int) -> None:
    line = np.linspace([1.0, 2.0], [4.0, 6.0], members)
    hull = convex_hull(line)
    assert hull.area == pytest.approx(0.0, abs=EXACT)
    assert hull.perimeter == pytest.approx(10.0, abs=EXACT)


def test_a_thin_triangle_nears_the_line() -> None:
    hull = convex_hull(np.array([[0.0, 0.0], [5.0, 0.0], [2.0, 1e-6]]))
    assert hull.area == pytest.approx(2.5e-6, rel=1e-6)
    assert hull.perimeter == pytest.approx(10.0, abs=1e-9)


def test_one_point_has_neither() -> None:
    for members in (1, 4):
        assert convex_hull(np.ones((members, 2))) == (0.0, 0.0)


def test_leading_axes_and_nan() -> None:
    motion = np.stack([_polygon(4, 1.0), _polygon(4, 3.0), np.full((4, 2), np.nan)])
    assert convex_hull(motion[:, None]).area.shape == (3, 1)
    assert convex_hull(motion).area[:2] == pytest.approx([2.0, 18.0], abs=EXACT * 10)
    assert np.isnan(convex_hull(motion).perimeter[2])


def test_a_herd_across_the_seam_is_as_large_as_elsewhere() -> None:
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    assert convex_hull(np.mod(square, 10.0), period_m=10.0) == pytest.approx((4.0, 8.0), abs=EXACT * 10)
    assert convex_hull(np.mod(square, 10.0)).area == pytest.approx(64.0)
