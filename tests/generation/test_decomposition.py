"""Decompositions: a construct of two known pieces gives two clusters; windows and regions cut what they should."""

import math

import numpy as np
import pytest

from flocking.errors import InputError
from generation import decomposition
from generation.environment import START, Environment
from generation.primitives import Arc, Circle, Point, Polygon, Polyline, Segment
from generation.validation.starts import Starts

TWO = Environment(
    construct=(Segment(0.0, 0.0, 4.0, 0.0), Segment(0.0, 5.0, 0.0, 9.0)),
    markers={START: Point(0.0, -3.0, math.pi / 2)},
)
"""A fence along x and one along y."""


class Deflected:
    """Members that go 5 m along their pieces' mean direction, give or take by their seed; without any, ahead."""

    count = 3

    def trajectories(self, jobs, iterations):
        for job in jobs:
            walls = job.environment.construct_walls()
            way = (walls[:, 2:] - walls[:, :2]).sum(axis=0) if len(walls) else np.array([0.0, 1.0])
            way = 5.0 * way / np.hypot(*way) + np.random.default_rng(job.seed).normal(0.0, 0.3, 2)
            steps = np.linspace(0.0, 1.0, iterations + 1)[:, None, None]
            yield job.poses_w[None, :, :2] + steps * way


def elicited(pieces, whole=TWO, simulations=8):
    return decomposition.elicited(pieces, whole, Deflected(), Starts(1.0, 0.1), simulations, 20, 5.0, (1,))


def test_two_different_pieces_give_two_clusters_each_with_a_primitive_of_its_own():
    pieces = decomposition.windows(TWO.construct, 1.0, 0.5)
    done = elicited(pieces)
    found = decomposition.clustered(done.means, done.scales)
    along_x = np.array([piece.name.startswith("fence 1") for piece in pieces])
    assert len(found.medoids) == 2
    np.testing.assert_array_equal(found.labels, np.where(along_x, 0, 1))
    assert along_x[found.medoids[0]]
    assert not along_x[found.medoids[1]]
    # a metre to the right of where the herd looks, against straight on: 5 m each, noise of 0.3 m over 8 simulations
    np.testing.assert_allclose(done.means[found.medoids[0], :2], [0.0, -5.0], atol=0.5)
    np.testing.assert_allclose(done.effects[found.medoids[1], :2], [0.0, 0.0], atol=0.5)


def test_pieces_that_elicit_alike_are_one_cluster():
    whole = Environment(construct=(Segment(0.0, 0.0, 6.0, 0.0),), markers=TWO.markers)
    done = elicited(decomposition.windows(whole.construct, 1.0, 0.5), whole)
    assert len(decomposition.clustered(done.means, done.scales).medoids) == 1


def test_equal_seeds_elicit_equally():
    pieces = decomposition.windows(TWO.construct, 2.0, 2.0)
    np.testing.assert_array_equal(elicited(pieces).each, elicited(pieces).each)


@pytest.mark.parametrize("window", [0.3, 1.0, 2.5])
def test_windows_cover_each_fence_at_their_length_and_nothing_else(window):
    round_fence = (Arc(0.0, 0.0, 2.0, 0.0, math.pi), Polyline(((9.0, 0.0), (9.0, 2.0), (11.0, 2.0))))
    pieces = decomposition.windows(round_fence, window, window / 2)
    total = sum(Environment(construct=(each,)).fence_length() for each in round_fence)
    for piece in pieces:
        assert piece.length_m == pytest.approx(window, abs=1e-9)  # rounding alone
    once = decomposition.windows(round_fence, window, window)
    assert sum(piece.length_m for piece in once) >= total - 1e-9
    assert len(pieces) >= 2 * len(once) - 4


def test_joined_segments_are_one_fence_and_short_ones_are_one_piece():
    joined = (Segment(0.0, 0.0, 1.0, 0.0), Segment(1.0, 0.0, 1.0, 1.0), Segment(5.0, 5.0, 5.5, 5.0))
    assert [len(fence) for fence in decomposition.chains(joined)] == [3, 2]
    names = [piece.name for piece in decomposition.windows(joined, 2.0, 1.0)]
    assert names == ["fence 1, 0 to 2 m", "fence 2, 0 to 0.5 m"]


def test_regions_hold_what_lies_in_them():
    areas = {"left": Polygon(((-1.0, -1.0), (1.5, -1.0), (1.5, 7.0), (-1.0, 7.0)))}
    (piece,) = decomposition.regions(TWO.construct, areas)
    assert piece.name == "left"
    assert piece.length_m == pytest.approx(1.5 + 2.0, abs=1e-9)
    with pytest.raises(InputError, match="'far' holds nothing"):
        decomposition.regions(TWO.construct, {"far": Polygon(((20.0, 20.0), (21.0, 20.0), (21.0, 21.0)))})


def test_features_turn_with_the_herd():
    """A rigid motion of trajectories and start leaves all features as they are."""
    rng = np.random.default_rng(3)
    way = np.cumsum(rng.normal(0.1, 0.2, (30, 5, 2)), axis=0)
    c, s = math.cos(0.7), math.sin(0.7)
    turned = way @ np.array([[c, s], [-s, c]]) + np.array([4.0, -2.0])
    np.testing.assert_allclose(
        decomposition.features(way, 0.3, 1.0), decomposition.features(turned, 1.0, 1.0), rtol=0.0, atol=1e-9
    )


def test_features_of_a_straight_way():
    way = np.linspace(0.0, 1.0, 21)[:, None, None] * np.array([0.0, 2.0]) + np.array([[-1.0, 0.0], [1.0, 0.0]])
    np.testing.assert_allclose(
        decomposition.features(way, math.pi / 2, 1.5), [2.0, 0.0, 1.0, 0.0, 1.0, 2.0], atol=1e-12
    )
    np.testing.assert_allclose(decomposition.features(way, 0.0, 2.5), [0.0, 2.0, 0.0, 1.0, 1.0, 1.0], atol=1e-12)


def test_the_silhouette_of_four_points_by_hand():
    places = np.array([0.0, 1.0, 10.0, 12.0])
    distances = np.abs(places[:, None] - places)
    labels = np.array([1, 1, 2, 2])
    by_hand = np.mean([1 - 1 / 11, 1 - 1 / 10, 1 - 2 / 9.5, 1 - 2 / 11.5])
    assert decomposition.silhouette(distances, labels) == pytest.approx(by_hand)
    assert decomposition.silhouette(distances, np.ones(4, np.int64)) == 0.0
    assert decomposition.silhouette(distances, np.array([1, 1, 1, 2])) < by_hand


def test_bad_windows_are_refused():
    with pytest.raises(InputError, match="expected a construct"):
        decomposition.windows((), 1.0, 1.0)
    with pytest.raises(InputError, match="expected a stride of"):
        decomposition.windows(TWO.construct, 1.0, 1e-3)
    with pytest.raises(InputError, match="above 0"):
        decomposition.windows(TWO.construct, 0.0, 1.0)
    with pytest.raises(InputError, match="no pieces"):
        decomposition.clustered(np.empty((0, 6)), np.ones(6))
    assert len(decomposition.windows((Circle(0.0, 0.0, 1.0),), 1.0, 1.0)) == 7
