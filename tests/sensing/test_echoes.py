"""What a robot makes of its echoes: obstacles on the axes, and none of a flockmate whose cone it sees."""

from __future__ import annotations

import math

import numpy as np
import pytest

from robots.pioneer.model import CONE_X
from sensing.camera.cones import RADIUS_M
from sensing.echoes import explained, obstacles
from sensing.sonar import HALF_WIDTH_RAD, RING
from sensing.types import Echoes
from tests.sensing.rooms import Room

CONE = (CONE_X, 0.0)
MATE_M = 0.47


def heard(ranges: np.ndarray, mate_m: float = MATE_M) -> Echoes:
    return Echoes(ranges, np.array(RING), mate_m)


def listened(room: Room) -> Echoes:
    return room.sonars.listen(room.data, 0, CONE)


def near_side(x: float, y: float, heading: float) -> np.ndarray:
    """(1, 2) where a robot at the origin sees the cone of a Pioneer there, on the side that it sees."""
    axis = np.array([x + CONE_X * math.cos(heading), y + CONE_X * math.sin(heading)])
    return (axis * (1.0 - RADIUS_M / np.hypot(*axis)))[None]


def test_obstacles_lie_on_the_axes_at_the_ranges() -> None:
    ranges = np.full(16, math.inf)
    assert obstacles(heard(ranges)).points.shape == (0, 2)
    ranges[0], ranges[12] = 1.0, 2.0
    found = obstacles(heard(ranges)).points
    np.testing.assert_allclose(found[0], (0.147, 1.136), atol=1e-12)
    c, s = math.cos(math.radians(170.0)), math.sin(math.radians(170.0))
    np.testing.assert_allclose(found[1], (-0.241 + 2.0 * c, 0.027 + 2.0 * s), atol=1e-12)


def test_a_walls_obstacles_lie_no_farther_off_it_than_a_cone_is_wide() -> None:
    """The robot takes each echo to have come along the axis: so a wall appears bent, and never farther off."""
    points = obstacles(listened(Room(boxes=((1.6, 0.0, 0.1, 40.0),)))).points
    assert len(points) >= 4
    assert (points[:, 0] <= 1.5 + 1e-9).all()
    assert points[:, 0].max() == pytest.approx(0.245 + (1.5 - 0.245) * math.cos(math.radians(10.0)), abs=1e-9)


def test_the_ring_and_the_size_of_a_flockmate_are_the_robots_own() -> None:
    """Farthest from the cone in the ring's plane are the front corners of the box that carries the sonars."""
    echoes = listened(Room((1.0, 2.0, 0.7)))
    np.testing.assert_allclose(echoes.ring, RING, atol=1e-12)
    farthest = math.hypot(0.24 - CONE_X, 0.13)
    assert farthest <= echoes.mate_m < farthest + 0.02  # the corner's distance from the middle, and the cone's
    assert math.isnan(Room().sonars.listen(Room().data, 0, (math.nan, math.nan)).mate_m)


def test_no_flockmate_whose_cone_is_seen_is_an_obstacle_and_each_is_one_if_it_is_not() -> None:
    """At all places around and in all headings, as the sonars hear its body."""
    rng = np.random.default_rng(5)
    met = 0
    for _ in range(60):
        way, bearing, heading = rng.uniform(0.7, 4.0), rng.uniform(-math.pi, math.pi), rng.uniform(-math.pi, math.pi)
        at = (way * math.cos(bearing), way * math.sin(bearing), heading)
        echoes = listened(Room((0.0, 0.0, 0.0), at))
        met += len(obstacles(echoes).points)
        assert len(obstacles(echoes, near_side(*at)).points) == 0
    assert met > 60  # nearly each is heard, most by two sonars


def test_an_echo_is_explained_where_its_arc_comes_near_a_cone() -> None:
    """Against points close together along each arc."""
    rng = np.random.default_rng(6)
    ranges = rng.uniform(0.1, 5.0, 16)
    ranges[5] = math.inf
    along = np.linspace(-HALF_WIDTH_RAD, HALF_WIDTH_RAD, 2001)
    for _ in range(50):
        cones = rng.uniform(-3.0, 3.0, (2, 2))
        found = explained(heard(ranges), cones)
        for k, (x, y, heading) in enumerate(RING):
            if not math.isfinite(ranges[k]):
                assert not found[k]
                continue
            arc = np.stack([x + ranges[k] * np.cos(heading + along), y + ranges[k] * np.sin(heading + along)], axis=1)
            gap = np.hypot(*(arc[:, None] - cones[None]).T).min()
            if abs(gap - MATE_M) > 1e-4:  # the arc's points are 1.3 mm apart at 5 m
                assert found[k] == (gap < MATE_M)


def test_a_wall_beyond_a_flockmate_is_an_obstacle_and_so_is_all_where_flockmates_have_no_cones() -> None:
    ranges = np.full(16, math.inf)
    ranges[3] = 2.0
    cone = np.array([[1.0, 0.0]])
    assert len(obstacles(heard(ranges), cone).points) == 1
    ranges[3] = 1.0
    assert len(obstacles(heard(ranges), cone).points) == 0
    assert len(obstacles(heard(ranges, math.nan), cone).points) == 1


def test_mirrored_echoes_are_mirrored_obstacles() -> None:
    rng = np.random.default_rng(7)
    mirror = [*range(7, -1, -1), *range(15, 7, -1)]
    for _ in range(20):
        ranges, cones = np.where(rng.random(16) < 0.8, rng.uniform(0.1, 3.0, 16), math.inf), rng.uniform(-2, 2, (2, 2))
        plain = obstacles(heard(ranges), cones).points
        turned = obstacles(heard(ranges[mirror]), cones * (1, -1)).points * (1, -1)
        order, flipped = np.lexsort(plain.round(9).T), np.lexsort(turned.round(9).T)
        np.testing.assert_allclose(turned[flipped], plain[order], atol=1e-9)
