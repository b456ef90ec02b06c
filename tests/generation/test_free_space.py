"""Free space: clearances against closed forms, solids within rooms within solids, and what walls keep apart."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from generation.environment import Environment
from generation.free_space import clearance, crossed, distance, in_solid, reached
from generation.primitives import Circle, Polygon, Polyline, Segment, segments

SQUARE = ((-4.0, -4.0), (4.0, -4.0), (4.0, 4.0), (-4.0, 4.0))


def test_clearance_in_a_room_is_the_distance_of_the_nearest_side_and_negative_behind_it() -> None:
    rng = np.random.default_rng(0)
    points = rng.uniform(-6.0, 6.0, (500, 2))
    faces = segments(Polygon(SQUARE, "inside"))
    beyond = np.maximum(np.abs(points) - 4.0, 0.0)
    expected = np.where(np.abs(points).max(axis=1) < 4.0, 4.0 - np.abs(points).max(axis=1), -np.hypot(*beyond.T))
    assert_allclose(clearance(faces, points), expected, atol=1e-12)
    assert_allclose(distance(faces, points), np.abs(expected), atol=1e-12)


def test_without_walls_everything_is_infinitely_clear() -> None:
    none, points = np.empty((0, 4)), np.zeros((2, 2))
    assert np.isinf(clearance(none, points)).all()
    assert np.isinf(distance(none, points)).all()
    assert reached(none, np.zeros(2), points).all()


def test_a_place_is_in_a_solid_as_the_smallest_shape_about_it_says() -> None:
    """A building with a room in it, and a pillar in the room; another pillar overlaps the building's outline."""
    building = Polygon(tuple((2 * x, 2 * y) for x, y in SQUARE), "outside")
    environment = Environment((building, Polygon(SQUARE, "inside"), Circle(1.0, 1.0, 0.5), Circle(8.0, 0.0, 1.0)))
    places = np.array([(6.0, 6.0), (0.0, 0.0), (1.0, 1.0), (20.0, 0.0), (8.5, 0.0), (7.5, 0.0)])
    np.testing.assert_array_equal(in_solid(environment, places), [True, False, True, False, True, True])


def test_a_way_is_crossed_by_what_stands_between() -> None:
    walls = np.array([[1.0, -1.0, 1.0, 1.0]])
    points = np.array([(2.0, 0.0), (0.5, 0.0), (2.0, 3.0), (-2.0, 0.0), (2.0, 1.9)])
    np.testing.assert_array_equal(crossed(walls, np.zeros(2), points), [True, False, False, False, True])


@pytest.mark.parametrize("radius", [0.0, 0.2, 0.45, 0.55])
def test_a_disc_gets_through_a_door_that_is_wider_than_itself(radius: float) -> None:
    """Two rooms with a door of 1 m between them, and a third one without a door."""
    room = Polygon(((0, 0), (6, 0), (6, 4), (0, 4)), "inside")
    walls = Environment((room, Segment(2, 0, 2, 1.5), Segment(2, 2.5, 2, 4), Segment(4, 0, 4, 4))).walls()
    points = np.array([(1.0, 3.0), (3.0, 3.0), (3.0, 0.8), (5.0, 2.0)])
    found = reached(walls, np.array([1.0, 0.8]), points, radius)
    assert found.tolist() == [True, radius < 0.5, radius < 0.5, False]


def test_around_a_spiral_everything_is_one_region() -> None:
    turns = np.linspace(0.0, 6.0 * math.pi, 200)
    spiral = Polyline(tuple((t * math.cos(t) / 4, t * math.sin(t) / 4) for t in turns))
    walls = Environment((spiral,)).walls()
    inside, outside = np.array([0.0, -0.6]), np.array([[9.0, 9.0]])
    assert crossed(walls, inside, outside).all()
    assert reached(walls, inside, outside, 0.1).all()
    assert not reached(np.vstack([walls, segments(Circle(0, 0, 7.0, "both"))]), inside, outside, 0.1).any()
