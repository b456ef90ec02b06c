"""The database of members, made from models whose outlines are known in closed form."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest

from flocking.errors import InputError
from robots import body
from sensing.shapes import recognition
from sensing.shapes.segments import shape_of
from sensing.shapes.templates import DISTANCES, SAME_M, Templates, group_at, make_templates
from sensing.shapes.warping import nearest_shape, warp_rows

CREATE = body.load("create")

STEP = 2.0 * math.pi / 1024
SAMPLES, BAND = 16, 1


def boxy(a: float, b: float) -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    spec.nuser_geom = 2
    base = spec.worldbody.add_body(name="base")
    base.add_freejoint()
    base.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=(a, b, 0.2), pos=(0, 0, 0.2), userdata=(0.5, 0.0))
    return spec.compile()


def seen(ranges: np.ndarray, angles: np.ndarray) -> tuple[np.ndarray, float]:
    """The shape and the distance of its mean."""
    points = np.ascontiguousarray(ranges[:, None] * np.column_stack((np.cos(angles), np.sin(angles))))
    shape = np.empty((SAMPLES, 2))
    return shape, shape_of(points, np.arange(len(points)), 0, len(points), 0.0, 0.0, shape)


def arc(radius: float, distance: float, offset: float) -> tuple[np.ndarray, float]:
    """A disc ahead, its beams `offset` steps off its middle."""
    angles = STEP * (np.arange(-300, 300) + offset)
    angles = angles[np.abs(np.sin(angles)) < radius / distance]
    return seen(distance * np.cos(angles) - np.sqrt(radius**2 - (distance * np.sin(angles)) ** 2), angles)


def rectangle(a: float, b: float, distance: float, heading: float) -> tuple[np.ndarray, float]:
    """A rectangle of half sides a, b ahead and turned by `heading`: the slab method, beam by beam."""
    found = []
    for angle in STEP * np.arange(-400, 401):
        low, high = -math.inf, math.inf
        for axis, half in ((heading, a), (heading + math.pi / 2, b)):
            speed, start = math.cos(angle - axis), -distance * math.cos(axis)
            ends = sorted(((-half - start) / speed, (half - start) / speed))
            low, high = max(low, ends[0]), min(high, ends[1])
        if low < high:
            found.append((low, angle))
    return seen(*np.array(found).T)


def cost(sight: tuple[np.ndarray, float], templates: Templates) -> float:
    group = group_at(sight[1], templates.limits_m)
    alike = templates.shapes[templates.starts[group] : templates.starts[group + 1]]
    return nearest_shape(sight[0], alike, BAND, math.inf, 0.0, warp_rows(SAMPLES))


CREATES = make_templates(CREATE.spec().compile(), CREATE.mount("laser").height_m, STEP, SAMPLES, BAND)


def test_a_round_member_looks_alike_from_all_sides_and_is_known_at_all_distances():
    assert CREATES.starts.tolist() == list(range(DISTANCES + 1))  # one shape a distance
    for distance in (0.33, 0.4, 0.7, 1.0, 2.0, 3.0, 5.0):
        for offset in (0.0, 0.3, 0.5):
            # half a beam more or less at either end of an outline that is `beams` wide stretches it by 1 / beams of
            # its half width; between two distances of the grid, 1.5 apart, the width differs by 7 % at the nearest
            beams = 2.0 * math.asin(CREATE.silhouette_radius / distance) / STEP
            assert cost(arc(CREATE.silhouette_radius, distance, offset), CREATES) < 0.165 * (1 / beams + 0.07)


def test_each_distance_has_its_own_shapes():
    limits = CREATES.limits_m
    assert np.all(np.diff(limits) > 0)
    assert group_at(0.0, limits) == 0
    assert group_at(math.inf, limits) == DISTANCES - 1
    for k, limit in enumerate(limits):
        assert group_at(limit * (1 - 1e-9), limits) == k
        assert group_at(limit * (1 + 1e-9), limits) == k + 1
    widths = CREATES.shapes[:, -1, 1] - CREATES.shapes[:, 0, 1]
    assert widths[0] < 0.85 * widths[-1]  # touching, 120 degrees of the disc face the laser: its chord is 0.87 R


def test_it_is_symmetric_as_the_member_is():
    shapes = CREATES.shapes
    np.testing.assert_allclose(shapes[:, ::-1] * (1, -1), shapes, atol=1e-9)  # rays: rounding only
    assert np.all(np.abs(shapes[:, :, 1]) < CREATE.silhouette_radius)
    np.testing.assert_allclose(shapes.mean(axis=1), 0.0, atol=1e-12)


def test_a_member_with_corners_is_known_from_every_side():
    templates = make_templates(boxy(0.25, 0.1), 0.2, STEP, SAMPLES, BAND)
    for heading in np.radians([3.0, 15.0, 45.0, 100.0, 170.0, 260.0]):
        for distance in (0.8, 2.0, 3.5):
            assert cost(rectangle(0.25, 0.1, distance, heading), templates) < recognition.Parameters().threshold_m
    assert cost(rectangle(0.5, 0.1, 2.0, math.pi / 2), templates) > 0.05  # twice as long is another thing
    assert len(templates.shapes) > len(CREATES.shapes)


def test_no_two_shapes_of_a_distance_are_the_same():
    templates = make_templates(boxy(0.25, 0.1), 0.2, STEP, SAMPLES, BAND)
    rows = warp_rows(SAMPLES)
    for first, last in zip(templates.starts[:-1], templates.starts[1:], strict=True):
        for k in range(first + 1, last):
            shape, earlier = templates.shapes[k], templates.shapes[first:k]
            assert nearest_shape(shape, earlier, BAND, math.inf, 0.0, rows) > SAME_M


def test_a_plane_that_misses_the_member_is_an_error():
    with pytest.raises(InputError, match=r"0\.9 m above the floor"):
        make_templates(boxy(0.2, 0.2), 0.9, STEP, SAMPLES, BAND)
