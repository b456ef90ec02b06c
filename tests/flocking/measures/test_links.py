"""Links and the link tension index: the closed forms of the spring that it is derived from."""

from __future__ import annotations

import numpy as np
import pytest

from flocking.measures.links import link_lengths, link_outcomes, link_tension, links_within
from flocking.types import Floats

EXACT = 1e-12
"""Rounding of a few float64 operations on numbers of order 1."""


def _pair(length: float, speed: float = 0.0, across: float = 0.0) -> tuple[Floats, Floats]:
    """Two members `length` apart along a slanted line, parting at `speed`, passing at `across`."""
    along, aside = np.array([0.6, 0.8]), np.array([-0.8, 0.6])
    positions = np.stack([[2.0, 1.0], np.array([2.0, 1.0]) + length * along])
    drift = np.array([0.3, -0.2])  # common to both: no part of the relative motion
    return positions, np.stack([drift, drift + speed * along + across * aside])


LINK = np.array([[0, 1]])


@pytest.mark.parametrize(("range_m", "links"), [(1.0 - 1e-9, 0), (1.0 + 1e-9, 5)])
def test_links_are_the_pairs_within_range(range_m: float, links: int) -> None:
    chain = np.stack([np.arange(6.0), np.zeros(6)], axis=1)
    found = links_within(chain, range_m)
    assert len(found) == links
    assert found.tolist() == [[i, i + 1] for i in range(links)]


def test_a_lattice_of_ten_by_ten_has_261_links() -> None:
    """Rows of a triangular lattice: 9 links in each of 10 rows, 19 between two rows."""
    lattice = np.array([[x + 0.5 * (y % 2), y * np.sqrt(0.75)] for y in range(10) for x in range(10)])
    links = links_within(lattice, 1.3)
    assert len(links) == 10 * 9 + 9 * 19 == 261
    assert link_lengths(lattice, links) == pytest.approx(np.ones(261), abs=EXACT)


def test_links_and_their_tension_cross_the_seam() -> None:
    positions, velocities = _pair(1.2, speed=0.7)
    links = links_within(positions, 1.5)
    wrapped = np.mod(positions - [2.1, 1.1], 8.0)
    assert len(links_within(wrapped, 1.5)) == 0
    assert links_within(wrapped, 1.5, period_m=8.0).tolist() == links.tolist() == [[0, 1]]
    assert link_lengths(wrapped, links, period_m=8.0) == pytest.approx([1.2], abs=EXACT)
    here = link_tension(positions, velocities, links, range_m=1.5, rest_m=1.0)
    assert link_tension(wrapped, velocities, links, 1.5, 1.0, period_m=8.0) == pytest.approx(here, abs=EXACT)


def test_index_of_members_at_rest_relative_to_each_other_is_the_spring_turned_over() -> None:
    for length in (0.4, 1.0, 1.6):  # a compressed spring stretches as far as it was compressed
        index = link_tension(*_pair(length), LINK, range_m=1.5, rest_m=1.0)
        assert index == pytest.approx([1.0 + abs(length - 1.0) - 1.5], abs=EXACT)


def test_only_the_speed_along_the_link_counts() -> None:
    alone = link_tension(*_pair(1.3, speed=0.4), LINK, range_m=1.6, rest_m=1.0)
    passing = link_tension(*_pair(1.3, speed=0.4, across=9.0), LINK, range_m=1.6, rest_m=1.0)
    assert alone == pytest.approx([0.5 + 1.0 - 1.6], abs=EXACT)  # 3-4-5
    assert passing == pytest.approx(alone, abs=EXACT * 10)
    assert link_tension(*_pair(1.3, speed=-0.4), LINK, 1.6, 1.0) == pytest.approx(alone, abs=EXACT)


@pytest.mark.parametrize(("speed", "breaks"), [(np.sqrt(0.6**2 - 0.3**2) - 1e-9, False), (0.52, True)])
def test_the_sign_says_whether_the_link_breaks(speed: float, breaks: bool) -> None:
    index = link_tension(*_pair(1.3, speed), LINK, range_m=1.6, rest_m=1.0)
    assert (index[0] > 0.0) == breaks
    assert link_outcomes(index, np.array([breaks])) == ((1, 0, 0, 0) if breaks else (0, 0, 0, 1))


@pytest.mark.parametrize(("mass", "stiffness"), [(1.0, 1.0), (2.0, 0.5), (0.3, 4.0)])
def test_two_undamped_members_reach_the_predicted_distance(mass: float, stiffness: float) -> None:
    """Both free, each of `mass`: their gap oscillates about the rest length at sqrt(2 k / m)."""
    length, speed, rest, range_m = 1.2, 0.6, 1.0, 1.5
    frequency = np.sqrt(2.0 * stiffness / mass)
    times = np.linspace(0.0, 2.0 * np.pi / frequency, 200_001)
    gaps = rest + (length - rest) * np.cos(frequency * times) + speed / frequency * np.sin(frequency * times)
    index = link_tension(*_pair(length, speed), LINK, range_m, rest, mass=mass / 2.0, stiffness=stiffness)
    # a sampled maximum lies below the true one by at most its curvature times half a step squared: 1e-9 here
    assert index[0] + range_m == pytest.approx(gaps.max(), abs=1e-8)


def test_the_printed_form_is_that_of_unit_mass_and_stiffness() -> None:
    given = (*_pair(1.3, 0.4), LINK, 1.6, 1.0)
    assert link_tension(*given) == pytest.approx(link_tension(*given, mass=2.5, stiffness=2.5), abs=EXACT)
    assert link_tension(*given, mass=4.0, stiffness=1.0) == pytest.approx([np.hypot(0.3, 0.8) - 0.6], abs=EXACT)


def test_members_at_one_point_part_with_all_their_speed() -> None:
    positions, velocities = np.zeros((2, 2)), np.array([[0.0, 0.0], [0.3, 0.4]])
    assert link_tension(positions, velocities, LINK, 1.5, 1.2) == pytest.approx([1.3 - 0.3], abs=EXACT)


def test_outcomes_are_the_four_cells_of_the_published_tables() -> None:
    index = np.array([0.1, 0.2, -0.1, 0.3, -0.2, -0.3, 0.0])
    broken = np.array([True, False, True, False, False, False, False])
    assert link_outcomes(index, broken) == (1, 1, 2, 3)
    assert sum(link_outcomes(index, broken)) == len(index)
