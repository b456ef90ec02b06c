"""Draws that follow from two: uniform, each independent of the others, the same for mirrored numbers."""

from __future__ import annotations

import math

import numpy as np
import pytest

from flocking.draws import MODULUS, drawn, seeded
from flocking.types import Floats

SEEDS, LENGTH, ERRORS = 2000, 6, 4.5
"""Standard errors that a statistic of a sample may be off: none of the some twenty is by chance, once in 7000 times."""


def several(u: float, v: float, count: int = LENGTH) -> list[float]:
    found, state = [], seeded(u, v)
    for _ in range(count):
        *state, uniform = drawn(*state)
        found.append(uniform)
    return found


@pytest.fixture(scope="module")
def table() -> Floats:
    """(SEEDS, LENGTH) draws."""
    rng = np.random.default_rng(1)
    return np.array([several(*rng.random(2)) for _ in range(SEEDS)])


def test_they_are_uniform_at_each_place(table: Floats) -> None:
    # mean 1/2 and variance 1/12; the square of the distance from 1/2 has variance 1/180
    assert np.abs(table.mean(axis=0) - 0.5).max() < ERRORS / math.sqrt(12.0 * SEEDS)
    assert np.abs(((table - 0.5) ** 2).mean(axis=0) - 1.0 / 12.0).max() < ERRORS / math.sqrt(180.0 * SEEDS)


def test_none_tells_of_another(table: Floats) -> None:
    correlations = np.corrcoef(table.T) - np.eye(LENGTH)
    assert np.abs(correlations).max() < ERRORS / math.sqrt(SEEDS)


def test_mirrored_numbers_lead_to_the_same_draws() -> None:
    for u, v in np.random.default_rng(2).random((50, 2)):
        assert several(1.0 - u, 1.0 - v) == several(u, v)


@pytest.mark.parametrize("u", [0.0, 0.5, np.nextafter(1.0, 0.0)])
def test_none_is_0_or_1(u: float) -> None:
    assert all(0.0 < uniform < 1.0 for uniform in several(u, u, 1000))


def test_compiled_or_plain() -> None:
    state = seeded.py_func(0.3, 0.9)
    assert state == seeded(0.3, 0.9)
    for _ in range(20):
        after = drawn.py_func(*state)
        assert after == drawn(*state)
        state = after[:2]
    assert 0 < state[0] < MODULUS
