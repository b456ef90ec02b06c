"""Measures of flocks that come apart and join again, on numbers of flocks that are given."""

from __future__ import annotations

import math

import numpy as np

from trials.simulations.robots.measures_splitting import ABOUT, of_flocks


def measured(*stretches: tuple[int, float]) -> dict[str, float]:
    """Of a trial with so many flocks for so many seconds, one stretch after the other."""
    flocks = np.concatenate([np.full(round(seconds * 10), count) for count, seconds in stretches])
    found = of_flocks(np.arange(len(flocks)) * 0.1, flocks)
    assert set(found) == set(ABOUT)
    return found


def test_one_flock_throughout_never_splits() -> None:
    found = measured((1, 30.0))
    assert (found["split"], found["flocks_most"]) == (0.0, 1.0)
    assert all(math.isnan(found[name]) for name in ("split_s", "rejoined", "apart_s"))


def test_a_flock_that_parts_and_joins_again_was_apart_as_long_as_it_was() -> None:
    found = measured((1, 10.0), (2, 5.0), (3, 2.0), (1, 8.0))
    assert (found["split"], found["rejoined"], found["flocks_most"]) == (1.0, 1.0, 3.0)
    np.testing.assert_allclose((found["split_s"], found["apart_s"]), (10.0, 7.0), atol=1e-9)


def test_of_several_partings_the_first_and_the_last_joining_count() -> None:
    found = measured((1, 5.0), (2, 4.0), (1, 3.0), (2, 4.0), (1, 3.0))
    np.testing.assert_allclose((found["split_s"], found["apart_s"]), (5.0, 11.0), atol=1e-9)


def test_one_that_stays_apart_has_not_rejoined() -> None:
    found = measured((1, 10.0), (2, 10.0))
    assert (found["split"], found["rejoined"]) == (1.0, 0.0)
    assert math.isnan(found["apart_s"])


def test_what_lasts_less_than_a_second_does_not_count() -> None:
    found = measured((1, 10.0), (2, 0.9), (1, 10.0))
    assert (found["split"], found["flocks_most"]) == (0.0, 1.0)
    late = measured((1, 10.0), (2, 10.0), (1, 0.9))
    assert late["rejoined"] == 0.0


def test_a_herd_that_was_never_one_flock_cannot_split() -> None:
    found = measured((3, 5.0), (2, 5.0))
    assert math.isnan(found["split"])
    assert found["flocks_most"] == 3.0
