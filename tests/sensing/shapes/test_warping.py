"""Dynamic time warping against a plain, uncompiled oracle, and its axioms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sensing.shapes.warping import nearest_shape, warp, warp_rows


def oracle(a: np.ndarray, b: np.ndarray, band: int) -> float:
    """The recursion of the symmetric step pattern with each step charged at both its ends, no bounds, no tricks."""
    n = len(a)
    distance = np.linalg.norm(a[:, None] - b[None], axis=2)
    cost = np.full((n, n), np.inf)
    for i in range(n):
        for j in range(n):
            if abs(i - j) > band:
                continue
            if i == j == 0:
                cost[i, j] = distance[i, j]
            for back_i, back_j in ((1, 0), (0, 1), (1, 1)):
                if i >= back_i and j >= back_j:
                    mean = (distance[i - back_i, j - back_j] + distance[i, j]) / 2
                    cost[i, j] = min(cost[i, j], cost[i - back_i, j - back_j] + (back_i + back_j) * mean)
    return float((cost[-1, -1] + distance[-1, -1]) / (2 * n))


def pairs(seed: int = 5):
    rng = np.random.default_rng(seed)
    for samples in (1, 2, 8, 16, 31):
        for band in (0, 1, 3, samples):
            yield rng.normal(size=(samples, 2)), rng.normal(size=(samples, 2)), band


# sums of at most 62 numbers near 1: rounding stays below 1e-13
CLOSE = 1e-12


def test_it_equals_the_plain_oracle():
    for a, b, band in pairs():
        assert warp(a, b, band, math.inf, warp_rows(len(a))) == pytest.approx(oracle(a, b, band), abs=CLOSE)


def test_abandoning_early_never_changes_a_cost_at_or_below_the_ceiling():
    for a, b, band in pairs(6):
        cost = oracle(a, b, band)
        rows = warp_rows(len(a))
        for share in (0.1, 0.5, 0.9, 1 - 1e-9):
            assert warp(a, b, band, share * cost, rows) == math.inf
        for share in (1 + 1e-9, 1.5, 100.0):
            assert warp(a, b, band, share * cost, rows) == pytest.approx(cost, abs=CLOSE)


def test_scratch_space_carries_nothing_from_one_call_to_the_next():
    rows = warp_rows(16)
    rng = np.random.default_rng(8)
    for _ in range(50):
        a, b = rng.normal(size=(2, 16, 2))
        band, ceiling = int(rng.integers(0, 6)), float(rng.uniform(0.2, 3.0))
        assert warp(a, b, band, ceiling, rows) == warp(a, b, band, ceiling, warp_rows(16))


def test_axioms_of_a_distance_between_shapes():
    for a, b, band in pairs(7):
        rows = warp_rows(len(a))
        there, back = warp(a, b, band, math.inf, rows), warp(b, a, band, math.inf, rows)
        assert there == pytest.approx(back, abs=CLOSE)
        assert warp(a, a, band, 0.0, rows) == 0.0
        assert warp(a[::-1].copy(), b[::-1].copy(), band, math.inf, rows) == pytest.approx(there, abs=CLOSE)
        assert 0.0 < there <= np.linalg.norm(a - b, axis=1).mean() + CLOSE  # the diagonal is one of the paths
        assert warp(a, b, band + 1, math.inf, rows) <= there + CLOSE


def test_the_cost_is_in_metres():
    # every sample 0.3 m from every other: each path costs 0.3 m on average, whatever its length
    a = np.zeros((8, 2))
    assert warp(a, a + np.array([0.3, 0.0]), 3, math.inf, warp_rows(8)) == pytest.approx(0.3, abs=CLOSE)


def test_the_nearest_shape_is_the_least_of_all():
    rng = np.random.default_rng(9)
    templates, a, rows = rng.normal(size=(7, 8, 2)), rng.normal(size=(8, 2)), warp_rows(8)
    costs = [oracle(a, t, 2) for t in templates]
    assert nearest_shape(a, templates, 2, math.inf, 0.0, rows) == pytest.approx(min(costs), abs=CLOSE)
    assert nearest_shape(a, templates, 2, min(costs) * (1 - 1e-9), 0.0, rows) == math.inf
    assert nearest_shape(a, templates, 2, math.inf, max(costs) + 1, rows) == pytest.approx(costs[0], abs=CLOSE)
    assert nearest_shape(a, templates[:0], 2, math.inf, 0.0, rows) == math.inf
