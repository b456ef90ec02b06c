"""Splitting a scan and resampling a segment, against cases worked out by hand and properties."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flocking.errors import InputError
from robots import body
from sensing.shapes.segments import beam_directions, laser_mount, shape_of, split

CREATE = body.load("create")

SPLIT_M = 0.05


def segments_of(ranges, angles, split_m: float = SPLIT_M, mount: tuple[float, float] = (0.0, 0.0)) -> list[list[int]]:
    """The beams of each segment."""
    ranges = np.asarray(ranges, dtype=float)
    count = len(ranges)
    points, readings, starts = np.zeros((count, 2)), np.zeros(count, np.int64), np.zeros(count + 1, np.int64)
    directions = beam_directions(np.asarray(angles, dtype=float))
    number, kept = split(ranges, directions, *mount, split_m, points, readings, starts)
    assert starts[number] == kept
    return [readings[starts[s] : starts[s + 1]].tolist() for s in range(number)]


def along_a_ray(ranges, **more) -> list[list[int]]:
    """Segments of readings whose beams all point ahead: distances between points are differences of ranges."""
    return segments_of(ranges, np.zeros(len(ranges)), **more)


def shape(points, samples: int, laser: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    points = np.ascontiguousarray(points, dtype=float)
    result = np.empty((samples, 2))
    shape_of(points, np.arange(len(points)), 0, len(points), *laser, result)
    return result


def test_points_no_further_apart_than_the_limit_stay_together():
    # bracket of 1e-9 m around the limit, far above the rounding of these sums (1e-16)
    assert along_a_ray([0.5, 0.5 + SPLIT_M - 1e-9]) == [[0, 1]]
    assert along_a_ray([0.5, 0.5 + SPLIT_M + 1e-9]) == [[0], [1]]


def test_the_limit_grows_in_proportion_to_the_nearer_range_beyond_one_metre():
    for near in (2.0, 4.0):
        assert along_a_ray([near, near * (1 + SPLIT_M) - 1e-9]) == [[0, 1]]
        assert along_a_ray([near * (1 + SPLIT_M) + 1e-9, near]) == [[0], [1]]


def test_distance_is_between_points_not_between_ranges():
    # same range, 0.1 rad apart at 0.9 m: the chord is 2 · 0.9 · sin(0.05) = 0.08996 m
    assert segments_of([0.9, 0.9], [0.0, 0.1], split_m=0.0899) == [[0], [1]]
    assert segments_of([0.9, 0.9], [0.0, 0.1], split_m=0.0900) == [[0, 1]]


def test_an_error_is_skipped_and_no_return_splits():
    nan, inf = math.nan, math.inf
    assert along_a_ray([1.0, nan, nan, 1.0]) == [[0, 3]]
    assert along_a_ray([1.0, inf, 1.0]) == [[0], [2]]
    assert along_a_ray([1.0, -inf, nan, 1.0]) == [[0], [3]]


@pytest.mark.parametrize("code", [math.nan, math.inf, -math.inf])
def test_a_scan_without_readings_has_no_segments(code):
    assert along_a_ray([code] * 7) == []


def test_limits_no_beam_and_one_beam():
    assert along_a_ray([]) == []
    assert along_a_ray([3.0]) == [[0]]


def test_the_mount_moves_points_but_not_segments():
    ranges = np.random.default_rng(1).uniform(0.5, 2.0, 50)
    angles = np.linspace(-2.0, 2.0, 50)
    assert segments_of(ranges, angles, mount=(0.1, -0.2)) == segments_of(ranges, angles)


RANGES = st.lists(
    st.one_of(st.floats(0.1, 5.6), st.sampled_from([math.nan, math.inf, -math.inf])), min_size=0, max_size=40
)


@settings(max_examples=200, deadline=None)
@given(RANGES, st.floats(0.01, 1.0))
def test_every_reading_is_in_one_segment_in_order_and_mirroring_keeps_segments(ranges, split_m):
    angles = np.linspace(-1.0, 1.0, len(ranges))
    found = segments_of(ranges, angles, split_m)
    assert [b for segment in found for b in segment] == np.flatnonzero(np.isfinite(ranges)).tolist()
    mirrored = segments_of(ranges[::-1], angles, split_m)
    assert [[len(ranges) - 1 - b for b in s[::-1]] for s in mirrored[::-1]] == found


@pytest.mark.parametrize("count", [1, 3, 7, 8, 9, 16, 61])
def test_each_sample_is_the_average_of_an_equal_share_of_the_readings(count):
    # oracle: every reading repeated 8 times, then cut into 8 blocks of equal length
    points = np.random.default_rng(count).uniform(-1.0, 1.0, (count, 2)) + np.array([3.0, 1.0])
    blocks = np.repeat(points, 8, axis=0).reshape(8, count, 2).mean(axis=1)
    mean = points.mean(axis=0)
    away = mean / np.hypot(*mean)
    expected = (blocks - mean) @ np.column_stack((away, (-away[1], away[0])))
    np.testing.assert_allclose(shape(points, 8), expected, atol=1e-12)  # sums of some 100 numbers near 1


def test_a_shape_knows_neither_bearing_nor_distance_and_mirrors():
    rng = np.random.default_rng(3)
    points = rng.uniform(-0.2, 0.2, (23, 2)) + np.array([2.0, 0.0])
    first = shape(points, 8)
    turn = np.array([[math.cos(1.1), -math.sin(1.1)], [math.sin(1.1), math.cos(1.1)]])
    np.testing.assert_allclose(shape(points @ turn.T, 8), first, atol=1e-12)
    away = points.mean(axis=0) / np.hypot(*points.mean(axis=0))
    np.testing.assert_allclose(shape(points + 1.5 * away, 8), first, atol=1e-12)
    np.testing.assert_allclose(shape(points[::-1] * (1, -1), 8), first[::-1] * (1, -1), atol=1e-12)


def test_a_segment_at_the_laser_itself_has_a_shape():
    assert np.array_equal(shape([[0.0, 0.0]], 4), np.zeros((4, 2)))


def robot_with_laser(x: float, y: float, yaw: float, name: str = "laser") -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    base = spec.worldbody.add_body(name="base", pos=(3.0, 4.0, 0.0), quat=(math.sqrt(0.5), 0, 0, math.sqrt(0.5)))
    base.add_freejoint()
    base.add_geom(size=[0.1, 0, 0])
    base.add_site(name=name, pos=(x, y, 0.1), quat=(math.cos(yaw / 2), 0, 0, math.sin(yaw / 2)))
    return spec.compile()


def test_the_laser_mount_is_read_from_the_model_wherever_the_robot_stands():
    np.testing.assert_allclose(laser_mount(robot_with_laser(0.1, -0.05, 0.3)), (0.1, -0.05, 0.3), atol=1e-12)
    np.testing.assert_allclose(
        laser_mount(CREATE.spec().compile()), (0.0, 0.0, 0.0), atol=1e-12
    )  # rounding of rotations only


def test_a_model_without_a_laser_is_an_error():
    with pytest.raises(InputError, match="laser"):
        laser_mount(robot_with_laser(0.0, 0.0, 0.0, name="sonar"))
