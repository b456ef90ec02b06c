"""Voronoi neighbours: whose cells touch, by bisectors, in degenerate places, in periodic space and in the herd."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from flocking.kinematic import Band, Space
from flocking.tessellation import tessellated
from flocking.types import Bools, Floats
from tests.flocking.kinematic.herds import TOLD, law_of, poses, run

NEGLIGIBLE = 1e-7
"""Voronoi cells that share an edge shorter than this part of the herd's width touch in a point, which is not enough."""


def touching_by_bisectors(points: Floats) -> tuple[Bools, Bools]:
    """Whose cells share a stretch of their bisector, and of whom that is too short or too far away to tell."""
    count = len(points)
    width = max(float(np.ptp(points, axis=0).max()), 1e-300)
    surely, hardly = np.zeros((2, count, count), dtype=np.bool_)
    for i, j in itertools.combinations(range(count), 2):
        middle, gap = (points[i] + points[j]) / 2.0, points[j] - points[i]
        along = np.array([-gap[1], gap[0]]) / math.hypot(*gap)
        low, high = -1e3 * width, 1e3 * width
        for k in range(count):
            if k in (i, j):
                continue
            # nearer to i than to k on the bisector: at + slope · t >= 0
            at = ((middle - points[k]) ** 2).sum() - ((middle - points[i]) ** 2).sum()
            slope = 2.0 * along @ (points[i] - points[k])
            if abs(slope) < 1e-12 * width:
                if at < 0.0:
                    high = -math.inf
            elif slope > 0.0:
                low = max(low, -at / slope)
            else:
                high = min(high, -at / slope)
        surely[i, j] = surely[j, i] = high - low > NEGLIGIBLE * width
        hardly[i, j] = hardly[j, i] = abs(high - low) <= 10.0 * NEGLIGIBLE * width or max(low, -high) > 900.0 * width
    return surely, hardly


class TestVoronoi:
    @pytest.mark.parametrize("count", [2, 3, 4, 10, 40])
    def test_cells_touch_where_the_bisector_says_so(self, count: int) -> None:
        rng = np.random.default_rng(count)
        for _ in range(5):
            points = rng.normal(0.0, 3.0, (count, 2))
            surely, hardly = touching_by_bisectors(points)
            found = tessellated(points)
            assert_array_equal(found[~hardly], surely[~hardly])
            assert hardly.mean() < 0.2

    @pytest.mark.parametrize("period", [0.0, 5.0])
    def test_the_two_nearest_of_any_place_are_neighbours(self, period: float) -> None:
        rng = np.random.default_rng(1)
        points = rng.uniform(0.0, 5.0, (15, 2))
        found = tessellated(points, period)
        seen = np.zeros_like(found)
        for place in rng.uniform(0.0, 5.0, (20_000, 2)):
            gaps = points - place
            if period:
                gaps -= period * np.round(gaps / period)
            one, other = np.argsort((gaps**2).sum(axis=1))[:2]
            seen[one, other] = seen[other, one] = True
        assert not (seen & ~found).any()
        if period:
            # in periodic space no cell reaches outside, so that all but the shortest edges are met
            assert (found & ~seen).sum() <= 6

    @pytest.mark.parametrize(
        ("kind", "make"),
        [
            ("square lattice", lambda: np.array([(x, y) for x in range(5) for y in range(4)], dtype=float)),
            ("ring", lambda: np.array([(math.cos(a), math.sin(a)) for a in np.arange(8) * math.pi / 4])),
            (
                "hexagon with its centre",
                lambda: np.array([(0, 0), *((math.cos(a), math.sin(a)) for a in np.arange(6) * math.pi / 3)]),
            ),
            ("line", lambda: np.array([(0.3 * x, 0.1 * x) for x in (3, 0, 2, 7, 5)])),
            ("level line", lambda: np.array([(x, 2.0) for x in (3.0, 0.0, 2.0, 7.0, 5.0)])),
            ("upright line", lambda: np.array([(2.0, y) for y in (3.0, 0.0, 2.0, 7.0, 5.0)])),
            ("far away", lambda: 1e7 + np.random.default_rng(3).uniform(0.0, 1.0, (12, 2))),
            ("tiny", lambda: 1e-9 * np.random.default_rng(4).uniform(0.0, 1.0, (12, 2))),
        ],
    )
    @pytest.mark.parametrize("turn", [0.0, 0.4])
    def test_degenerate_places_in_any_order(self, kind: str, make: Callable[[], Floats], turn: float) -> None:
        points = make()
        points = points @ np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
        surely, hardly = touching_by_bisectors(points)
        rng = np.random.default_rng(0)
        for _ in range(20):
            order = rng.permutation(len(points))
            found = np.zeros_like(surely)
            found[np.ix_(order, order)] = tessellated(points[order])
            if "line" in kind:
                ranks = np.argsort(points @ points.sum(axis=0))
                expected = np.zeros_like(surely)
                expected[ranks[:-1], ranks[1:]] = expected[ranks[1:], ranks[:-1]] = True
                assert_array_equal(found, expected)
            elif kind in ("far away", "tiny"):
                assert_array_equal(found[~hardly], surely[~hardly])
            else:  # cells that touch in a point do not touch
                assert_array_equal(found, surely)

    def test_lattice_neighbours_are_the_four_beside(self) -> None:
        points = np.array([(x, y) for x in range(6) for y in range(6)], dtype=float)
        gaps = np.abs(points[:, None] - points[None]).sum(axis=2)
        assert_array_equal(tessellated(points), gaps == 1.0)
        wrapped = np.minimum(np.abs(points[:, None] - points[None]), 6 - np.abs(points[:, None] - points[None]))
        assert_array_equal(tessellated(points, 6.0), wrapped.sum(axis=2) == 1.0)

    @pytest.mark.parametrize("offset", [0.0, 1e-17, 1e-15, 1e-13])
    def test_coincident_members_share_their_cell(self, offset: float) -> None:
        rng = np.random.default_rng(5)
        points = rng.uniform(1.0, 2.0, (10, 2))
        doubled = np.vstack([points, points[:3] + offset])
        found, single = tessellated(doubled), tessellated(points)
        for k in range(3):
            assert found[k, 10 + k]
            others = [j for j in range(10) if j != k]
            assert_array_equal(found[10 + k][others] | found[k][others], single[k][others])
            if offset == 0.0:
                assert_array_equal(found[10 + k][others], single[k][others])

    @pytest.mark.parametrize("count", [0, 1, 2])
    def test_few(self, count: int) -> None:
        found = tessellated(np.arange(2.0 * count).reshape(count, 2))
        assert_array_equal(found, ~np.eye(count, dtype=bool))

    def test_all_in_one_place_touch(self) -> None:
        assert_array_equal(tessellated(np.ones((5, 2))), ~np.eye(5, dtype=bool))

    def test_periodic_ones_do_not_touch_themselves(self) -> None:
        assert not tessellated(np.array([[0.5, 0.5]]), 1.0).any()
        assert_array_equal(tessellated(np.array([[0.2, 0.5], [0.7, 0.5]]), 1.0), [[0, 1], [1, 0]])

    def test_members_at_no_place_have_no_cell(self) -> None:
        points = np.array([[0.0, 0.0], [1.0, 0.0], [np.nan, 1.0], [0.0, 1.0]])
        found = tessellated(points)
        assert not found[2].any()
        assert not found[:, 2].any()
        assert found[0, 1]

    def test_in_the_herd_all_members_cells_count(self) -> None:
        """Voronoi first, then a range: a neighbour beyond it still bounds the cell."""
        counting = TOLD.replace(
            "return Motion(parameters.kind, x, y, 0)",
            "return Motion(3, float(sets[0].sum()) * math.cos(own.compass), 0.0, 0)",
        )
        points = np.random.default_rng(6).uniform(0.0, 4.0, (25, 2))
        for period in (0.0, 4.0):
            space = Space("periodic", 4.0) if period else Space()
            band = Band(law_of(counting), 25, {"see": 1.2}, selection="voronoi")
            history = run(band, poses(points), 1, space=space)
            gaps = points[:, None] - points[None]
            if period:
                gaps -= period * np.round(gaps / period)
            near = tessellated(points, period) & (np.hypot(gaps[..., 0], gaps[..., 1]) < 1.2)
            assert history.velocities_w[-1, :, 0].tolist() == near.sum(axis=1).tolist()
