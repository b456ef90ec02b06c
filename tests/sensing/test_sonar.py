"""Sonar: closed forms of walls and poles, its limits, what it does not hear, and what a robot makes of it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from flocking.errors import InputError
from robots import body as bodies
from sensing.sonar import HALF_WIDTH_RAD, LEAST_M, MOST_M, RAYS, RING, Sonars
from tests.sensing.rooms import Room
from worlds import assemble

HEIGHT = bodies.load("pioneer").mount("sonar").height_m
HEADINGS = np.array([heading for _, _, heading in RING])
ANGLES = HEADINGS[:, None] + np.linspace(-HALF_WIDTH_RAD, HALF_WIDTH_RAD, RAYS)
"""(S, R) of all rays, with a Pioneer that faces +x."""


def expected_of_wall(distance: float) -> np.ndarray:
    """(S,) ranges to a wall across the x axis at that distance from the middle: the ray nearest to its normal."""
    way = np.full(ANGLES.shape, math.inf)
    ahead = np.cos(ANGLES) > 1e-9
    x = np.array([at for at, _, _ in RING])[:, None]
    way[ahead] = ((distance - x) / np.where(ahead, np.cos(ANGLES), 1.0))[ahead]
    nearest = way.min(axis=1)
    return np.where(nearest <= MOST_M, np.maximum(nearest, LEAST_M), math.inf)


@pytest.mark.parametrize("distance", [0.4, 1.0, 2.5, 4.9])
def test_a_wall_ahead_is_heard_at_its_distance(distance: float) -> None:
    ranges = Room(boxes=((distance + 0.1, 0.0, 0.1, 40.0),)).read()
    np.testing.assert_allclose(ranges, expected_of_wall(distance), atol=1e-9)
    assert ranges[3] == pytest.approx(distance - 0.245, abs=1e-9)  # 10 degrees off, and its cone holds the normal
    assert ranges[2] == pytest.approx((distance - 0.227) / math.cos(math.radians(15.0)), abs=1e-9)
    assert np.isinf(ranges[9:15]).all()  # the rear ring; its sides still hear the wall far ahead


def test_it_is_the_same_in_whatever_direction_the_robot_faces() -> None:
    wall = Room((0.0, 0.0, 0.0), boxes=((2.1, 0.0, 0.1, 40.0),)).read()
    turned = Room((1.0, -2.0, math.pi / 2), boxes=((1.0, 0.1, 40.0, 0.1),)).read()
    np.testing.assert_allclose(turned, wall, atol=1e-9)


def test_front_and_rear_left_and_right_are_where_they_belong() -> None:
    """A wall on each side in turn: the sonars that look at it hear it, and none of those that look away."""
    for angle in (0.0, 90.0, 180.0, -90.0):
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        half = (0.1, 40.0) if abs(c) > 0.5 else (40.0, 0.1)
        ranges = Room(boxes=((2.0 * c, 2.0 * s, *half),)).read()
        off = np.abs(np.degrees(np.angle(np.exp(1j * (HEADINGS - math.radians(angle))))))
        assert np.isfinite(ranges[off <= 50.0]).all()
        assert np.isinf(ranges[off >= 110.0]).all()


def test_a_pole_on_an_axis_is_heard_where_it_begins_and_by_no_other_that_looks_away() -> None:
    x, y, heading = RING[2]
    pole = (x + 1.5 * math.cos(heading), y + 1.5 * math.sin(heading), 0.1)
    ranges = Room(poles=(pole,)).read()
    assert ranges[2] == pytest.approx(1.4, abs=1e-9)
    assert np.isinf(ranges[7:]).all()


def test_nothing_is_nearer_than_ten_centimetres_or_farther_than_five_metres() -> None:
    near = Room(boxes=((0.245 + 0.03 + 0.1, 0.0, 0.1, 5.0),)).read()
    assert near[3] == LEAST_M
    inside = Room(boxes=((0.245, 0.0, 0.1, 5.0),)).read()
    assert inside[3] == LEAST_M
    far = Room(boxes=((0.245 + MOST_M + 0.01 + 0.1, 0.0, 0.1, 40.0),)).read()
    assert np.isinf(far).all()


def test_a_robot_hears_others_and_not_itself() -> None:
    assert np.isinf(Room((0.0, 0.0, 0.0)).read()).all()
    room = Room((0.0, 0.0, 0.0), (2.0, 0.0, math.pi))
    for k in range(2):  # each other's ring, a box 0.48 m long
        ranges = room.read(k)
        assert ranges[3] == pytest.approx(2.0 - 0.24 - 0.245, abs=0.01)
        assert np.isinf(ranges[7:]).all()


def test_it_follows_what_moves() -> None:
    room = Room((0.0, 0.0, 0.0), (2.0, 0.0, math.pi))
    before = room.read()
    room.data.qpos[7 + 4] += 1.0  # the second robot's x, behind the first one's joint and wheels
    np.testing.assert_allclose(room.read()[3:5], before[3:5] + 1.0, atol=0.02)


def test_what_is_lower_than_the_ring_is_not_heard() -> None:
    assert np.isinf(Room(boxes=((1.0, 0.0, 0.1, 5.0),), top=0.2).read()).all()


def test_a_robot_that_leans_is_told() -> None:
    room = Room()
    room.data.qpos[3:7] = (math.cos(0.1), 0.0, math.sin(0.1), 0.0)
    with pytest.raises(InputError, match=r"0/base.* leans by more than 3 degrees"):
        room.read()


def test_the_ring_is_symmetric_and_its_angles_are_arias() -> None:
    degrees = np.round(np.degrees(HEADINGS)).astype(int).tolist()
    assert degrees == [90, 50, 30, 10, -10, -30, -50, -90, -90, -130, -150, -170, 170, 150, 130, 90]
    ring = np.array(RING)
    np.testing.assert_allclose(ring[:8] * (1, -1, -1), ring[7::-1], atol=1e-12)
    np.testing.assert_allclose(ring[8:] * (1, -1, -1), ring[:7:-1], atol=1e-12)


def test_bad_sites_are_named() -> None:
    room = Room()
    with pytest.raises(InputError, match="0/sonat"):
        Sonars(room.model, ["0/sonat"], [room.model.body("0/base").id])
    with pytest.raises(InputError, match="1 sites and 0 roots"):
        Sonars(room.model, ["0/sonar"], [])
    pair = Room((0.0, 0.0, 0.0), (2.0, 0.0, 0.0))
    with pytest.raises(InputError, match="is not mounted on"):
        Sonars(pair.model, ["1/sonar"], [pair.model.body("0/base").id])


def test_in_an_assembled_world_of_both_kinds_with_eyes() -> None:
    """Cones are above the ring, masts and walls in its plane."""
    poses_w = np.array([[0.0, 0.0, 0.0], [1.5, 0.0, math.pi]])
    world = assemble.build("corridor", {}, ["pioneer", "create-with-cameras"], ["a", "b"], poses_w, 0.01)
    sonars = Sonars(world.whole, ["a/sonar"], [world.whole.body("a/base").id])
    ranges = sonars.read(world.data, 0)
    assert np.isfinite(ranges[[0, 7]]).all()  # the corridor's walls to both sides
    x, y, _ = RING[3]
    mast = math.hypot(1.5 - x, y) - 0.015
    assert mast <= ranges[3] < mast + 0.015
