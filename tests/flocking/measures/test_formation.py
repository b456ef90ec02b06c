"""The measures of formations: closed forms, invariances, limits, an independent oracle."""

from __future__ import annotations

import numpy as np
import pytest

from flocking.measures import formation as measures
from flocking.types import Floats

EXACT = 1e-12
"""Rounding of a few float64 operations on numbers of order 1."""


def _turned(positions: Floats, angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return positions @ np.array([[c, s], [-s, c]])


def test_polarization_of_one_heading_and_of_opposite_headings() -> None:
    assert measures.polarization(np.full(5, 2.0)) == pytest.approx(1.0, abs=EXACT)
    assert measures.polarization(np.array([0.3, 0.3 + np.pi])) == pytest.approx(0.0, abs=EXACT)
    assert measures.polarization(np.array([0.0, np.pi / 2])) == pytest.approx(np.sqrt(0.5), abs=EXACT)


def test_polarization_knows_no_seam_at_half_a_turn() -> None:
    near = np.radians([179.0, -179.0])
    assert measures.polarization(near) == pytest.approx(np.cos(np.radians(1.0)), abs=EXACT)


def test_group_speed_cancels_opposite_velocities() -> None:
    velocities = np.array([[[3.0, 4.0], [3.0, 4.0]], [[1.0, 0.0], [-1.0, 0.0]]])
    assert measures.group_speed(velocities) == pytest.approx([5.0, 0.0], abs=EXACT)


def test_mmd_of_a_circle_is_its_radius() -> None:
    angles = 2 * np.pi * np.arange(8) / 8
    circle = 0.7 * np.stack([np.cos(angles), np.sin(angles)], axis=1) + [30.0, -5.0]
    assert measures.mmd(circle) == pytest.approx(0.7, abs=EXACT * 100)  # centre 30 m away: fewer digits remain


def test_mmd_is_a_median() -> None:
    """Four members at distance 1 and a pair far out on either side: the far pair does not move the median of
    six."""
    near = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    far = np.array([[100.0, 0.0], [-100.0, 0.0]])
    assert measures.mmd(np.concatenate([near, far])) == pytest.approx(1.0, abs=EXACT)


def test_nearest_neighbour_distance() -> None:
    line = np.array([[0.0, 0.0], [1.0, 0.0], [3.0, 0.0]])
    assert measures.nearest_neighbour_distance(line) == pytest.approx([1.0, 1.0, 2.0])
    assert np.isnan(measures.nearest_neighbour_distance(line[:1])).all()


@pytest.mark.parametrize(("gap", "groups"), [(1.0 - 1e-9, 1), (1.0 + 1e-9, 6)])
def test_a_chain_is_one_group_up_to_the_cut(gap: float, groups: int) -> None:
    chain = np.stack([gap * np.arange(6), np.zeros(6)], axis=1)
    assert measures.number_of_groups(chain, cut=1.0) == groups


def _groups_by_flooding(positions: Floats, cut: float) -> int:
    """An independent count: spread from member to member."""
    left, groups = set(range(len(positions))), 0
    while left:
        front, groups = [left.pop()], groups + 1
        while front:
            k = front.pop()
            reached = {j for j in left if np.linalg.norm(positions[j] - positions[k]) <= cut}
            left -= reached
            front += reached
    return groups


def test_groups_of_many_formations_at_once_equal_flooding() -> None:
    motion = np.random.default_rng(3).uniform(0, 6, (4, 5, 12, 2))
    counted = measures.number_of_groups(motion, cut=1.1)
    expected = [[_groups_by_flooding(formation, 1.1) for formation in row] for row in motion]
    assert counted.tolist() == expected
    assert counted.min() < counted.max()


def test_straightness_of_a_line_a_ring_and_an_ellipse() -> None:
    angles = 2 * np.pi * np.arange(12) / 12
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    line = np.stack([np.linspace(0, 5, 6), 2.0 * np.linspace(0, 5, 6)], axis=1)
    assert measures.straightness(line) == pytest.approx(1.0, abs=1e-7)  # a root of rounding (1e-16)
    assert measures.straightness(ring) == pytest.approx(0.0, abs=1e-7)
    assert measures.straightness(ring * [4.0, 1.0]) == pytest.approx(0.75, abs=EXACT)


def test_straightness_of_two_members_and_of_one_point() -> None:
    assert measures.straightness(np.array([[0.0, 1.0], [4.0, 2.0]])) == pytest.approx(1.0, abs=1e-7)
    assert np.isnan(measures.straightness(np.ones((4, 2))))


def test_formations_are_measured_alike_wherever_they_stand_and_face() -> None:
    rng = np.random.default_rng(5)
    formation = rng.normal(size=(9, 2))
    moved = _turned(formation, 1.1) + np.array([3.0, -7.0])
    shuffled = moved[rng.permutation(9)]
    for measure in (measures.mmd, measures.straightness):
        assert measure(shuffled) == pytest.approx(measure(formation), abs=1e-9)
    assert measures.straightness(5.0 * formation) == pytest.approx(measures.straightness(formation), abs=1e-9)
    assert measures.mmd(5.0 * formation) == pytest.approx(5.0 * measures.mmd(formation), abs=1e-9)


def test_leading_axes_pass_through() -> None:
    motion = np.random.default_rng(6).normal(size=(7, 5, 2))
    for measure in (measures.mmd, measures.straightness, measures.nearest_neighbour_distance):
        each = np.array([measure(formation) for formation in motion])
        assert measure(motion) == pytest.approx(each, abs=EXACT)


def test_path_length_of_a_polygon_nears_the_circle() -> None:
    angles = np.linspace(0, 2 * np.pi, 1001)
    circle = 2.0 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    inscribed = 1000 * 2 * 2.0 * np.sin(np.pi / 1000)
    assert measures.path_length(circle) == pytest.approx(inscribed, abs=1e-9)
    both = np.stack([circle, np.zeros_like(circle)], axis=1)
    assert measures.path_length(both) == pytest.approx([inscribed, 0.0], abs=1e-9)
    assert measures.path_length(circle[:1]) == 0.0


def test_order_of_velocities_is_that_of_their_headings_and_rest_adds_nothing() -> None:
    headings, speeds = np.random.default_rng(7).uniform(-3, 3, (4, 9)), np.array([0.1, 5.0, 1.0, 2.0, 0.3, 1, 1, 1, 9])
    velocities = speeds[:, None] * np.stack([np.cos(headings), np.sin(headings)], axis=-1)
    assert measures.velocity_order(velocities) == pytest.approx(measures.polarization(headings), abs=EXACT)
    assert measures.velocity_order(np.array([[2.0, 0.0], [0.0, 0.0]])) == pytest.approx(0.5, abs=EXACT)


def test_settled_mean_forgets_the_beginning() -> None:
    series = np.array([[9.0, 1.0], [7.0, 1.0], [2.0, 1.0], [4.0, 3.0]])
    assert measures.settled_mean(series) == pytest.approx([3.0, 2.0], abs=EXACT)
    assert measures.settled_mean(series, 0.0) == pytest.approx([4.0, 3.0], abs=EXACT)
    assert measures.settled_mean(series, 1.0) == pytest.approx([5.5, 1.5], abs=EXACT)


def test_net_displacement_is_that_of_the_centre() -> None:
    """Two members turn about each other while their centre goes straight: 3 in x, 4 in y."""
    times = np.linspace(0.0, 1.0, 101)
    centre = times[:, None] * [3.0, 4.0]
    arm = np.stack([np.cos(9 * times), np.sin(9 * times)], axis=1)
    motion = np.stack([centre + arm, centre - arm], axis=1)
    assert measures.net_displacement(motion) == pytest.approx(5.0 * times, abs=1e-11)
    assert measures.directedness(np.stack([centre, centre + 1.0], axis=1)) == pytest.approx(1.0, abs=1e-11)
    assert measures.directedness(motion - centre[:, None]) == pytest.approx(0.0, abs=1e-11)
    assert 0.0 < measures.directedness(motion) < 1.0
    assert np.isnan(measures.directedness(np.zeros((5, 3, 2))))


def test_mean_square_displacement_of_straight_motion_grows_with_the_square_of_time() -> None:
    motion = np.arange(5.0)[:, None, None] * np.array([[3.0, 4.0], [0.0, 1.0]])
    assert measures.mean_square_displacement(motion) == pytest.approx(13.0 * np.arange(5.0) ** 2, abs=1e-11)


def test_periodic_space_has_no_seam() -> None:
    """A small formation drifts round a periodic square: all measures as in unbounded space."""
    side = 7.0
    formation = np.random.default_rng(8).uniform(-1, 1, (6, 2))
    drift = np.linspace(0.0, 3 * side, 40)[:, None, None] * [1.0, 0.6]
    free = formation + drift
    wrapped = np.mod(free, side)
    rounding = 1e-9  # three laps of 7 added up in steps
    for measure in (
        measures.mmd,
        measures.nearest_neighbour_distance,
        measures.path_length,
        measures.net_displacement,
        measures.mean_square_displacement,
        measures.directedness,
    ):
        assert measure(wrapped, period_m=side) == pytest.approx(measure(free), abs=rounding)
        assert measure(wrapped) != pytest.approx(measure(free), abs=rounding)


def test_neighbours_across_the_corner_of_a_periodic_square() -> None:
    corners = np.array([[0.3, 0.4], [9.7, 9.6], [5.0, 5.0]])
    assert measures.nearest_neighbour_distance(corners, period_m=10.0)[:2] == pytest.approx([1.0, 1.0], abs=EXACT)


def test_a_nan_makes_the_nearest_distances_of_its_formation_nan_and_of_no_other() -> None:
    motion = np.random.default_rng(9).normal(size=(3, 4, 2))
    expected = measures.nearest_neighbour_distance(motion)
    motion[1, 0, 0] = np.nan
    found = measures.nearest_neighbour_distance(motion)
    assert np.isnan(found[1]).all()
    assert found[[0, 2]].tolist() == expected[[0, 2]].tolist()


def test_more_coincident_members_than_neighbours_asked_for() -> None:
    assert measures.nearest_neighbour_distance(np.zeros((9, 2))).tolist() == [0.0] * 9


def test_nearest_distances_equal_all_pairs() -> None:
    motion = np.random.default_rng(10).uniform(0, 5, (6, 11, 2))
    gaps = np.linalg.norm(motion[:, :, None] - motion[:, None], axis=-1) + np.where(np.eye(11), np.inf, 0.0)
    assert measures.nearest_neighbour_distance(motion) == pytest.approx(gaps.min(axis=-1), abs=EXACT)
