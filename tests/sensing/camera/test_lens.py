"""Lenses: known angles there and back, and the images of upright discs against geometry."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest

from flocking.errors import InputError
from sensing.camera.lens import (
    EQUAL_ANGLE,
    PINHOLE,
    PIXELS_PER_DEGREE,
    PROJECTIONS,
    Lens,
    column_angles,
    column_edges,
    pixels_per_degree,
    places,
    remap,
    remap_labels,
    remap_tables,
)

FIELD = math.radians(125.0)


def test_the_published_lens_has_5_12_pixels_a_degree():
    assert pixels_per_degree(Lens()) == pytest.approx(PIXELS_PER_DEGREE)
    assert np.diff(np.degrees(column_angles(Lens()))) == pytest.approx(-1.0 / 5.12)


def test_a_pinhole_of_125_degrees_at_640_x_480_is_fovy_110_472():
    assert math.degrees(remap_tables(Lens(projection=PINHOLE)).fovy_rad) == pytest.approx(110.472, abs=5e-4)


def test_an_equal_angle_image_is_made_of_1152_columns():
    tables = remap_tables(Lens())
    assert (tables.rendered_width, tables.rendered_height) == (1152, 480)
    assert math.tan(tables.fovy_rad / 2) / 480 == pytest.approx(math.tan(FIELD / 2) / 1152)  # square pixels


@pytest.mark.parametrize("projection", PROJECTIONS)
@pytest.mark.parametrize(("width", "degrees"), [(640, 125.0), (101, 60.0), (1, 90.0), (320, 170.0)])
def test_columns_and_bearings_are_inverse_symmetric_and_fill_the_field(projection, width, degrees):
    lens = Lens(width, 480, math.radians(degrees), projection=projection)
    angles, edges = column_angles(lens), column_edges(lens)
    np.testing.assert_allclose(places(lens, angles), np.arange(width) + 0.5, atol=1e-9)
    np.testing.assert_allclose(angles, -angles[::-1], atol=1e-12)  # left positive, mirrored
    assert np.all(np.diff(edges) < 0)
    assert edges[0] == pytest.approx(lens.field_of_view_rad / 2)
    assert edges[-1] == pytest.approx(-lens.field_of_view_rad / 2)
    assert np.all((edges[:-1] > angles) & (angles > edges[1:]))


def test_the_pinholes_columns_a_degree_at_the_centre_and_where_they_are_5_12():
    """Prototypes: 2.9 at the centre, 5.12 only at 41 degrees off it."""
    lens = Lens(projection=PINHOLE)
    angles = np.degrees(column_angles(lens))
    per_degree = -1.0 / np.gradient(angles)
    assert per_degree[320] == pytest.approx(2.9, abs=0.02)
    assert abs(angles[np.argmin(abs(per_degree[:320] - 5.12))]) == pytest.approx(41.0, abs=0.5)


def rendered(tables, bearing: float, half_width: float) -> np.ndarray:
    """A pinhole's image of something orange between two bearings, antialiased along the columns."""
    lens = Lens(tables.rendered_width, tables.rendered_height, FIELD, projection=PINHOLE)
    left, right = places(lens, np.array([bearing + half_width, bearing - half_width]))
    columns = np.arange(tables.rendered_width)
    cover = np.clip(np.minimum(columns + 1, right) - np.maximum(columns, left), 0.0, 1.0)
    image = np.zeros((tables.rendered_height, tables.rendered_width, 3), np.uint8)
    image[:] = np.round(cover[:, None] * np.array([255.0, 64.0, 0.0]))
    return image


@pytest.mark.parametrize("projection", PROJECTIONS)
@pytest.mark.parametrize("bearing_deg", [-50.0, -20.0, 0.0, 13.0, 47.5])
@pytest.mark.parametrize("distance", [0.25, 0.7, 1.5])
def test_a_disc_has_its_edges_where_geometry_says(projection, bearing_deg, distance):
    """A disc of radius r whose centre is at a distance D spans ±asin(r / D) about its bearing."""
    lens, radius, bearing = Lens(projection=projection), 0.0508, math.radians(bearing_deg)
    half = math.asin(radius / distance)
    tables = remap_tables(lens)
    image = remap(rendered(tables, bearing, half), tables)
    assert image.shape == (480, 640, 3)
    lit = np.flatnonzero(image[240, :, 0] > 127)
    edges = column_edges(lens)
    seen = max(bearing - half, -FIELD / 2), min(bearing + half, FIELD / 2)
    a_pixel = np.abs(np.diff(edges)).max()
    assert edges[lit[0]] == pytest.approx(seen[1], abs=a_pixel)
    assert edges[lit[-1] + 1] == pytest.approx(seen[0], abs=a_pixel)
    assert np.all(np.diff(lit) == 1)


def test_rows_stay_where_they_are_and_labels_are_not_blended():
    tables = remap_tables(Lens())
    rows = np.repeat(np.arange(480, dtype=np.uint8)[:, None, None], 1152, axis=1).repeat(3, axis=2)
    np.testing.assert_array_equal(remap(rows, tables), rows[:, :640])
    for lens in (Lens(), Lens(projection=PINHOLE)):
        upright = remap_tables(lens)
        picture = np.random.default_rng(2).integers(0, 256, (480, upright.rendered_width, 3), dtype=np.uint8)
        for blend in (False, True):
            np.testing.assert_array_equal(
                remap(picture[::-1].copy(), upright, blend, bottom_up=True), remap(picture, upright, blend)
            )
    owners = np.random.default_rng(1).integers(-1, 5, (480, 1152))
    made = remap_labels(owners, tables)
    assert made.shape == (480, 640)
    assert made.dtype == owners.dtype
    wide = Lens(1152, 480, FIELD, projection=PINHOLE)
    np.testing.assert_array_equal(tables.columns, np.floor(places(wide, column_angles(Lens()))))
    np.testing.assert_array_equal(made, owners[:, tables.columns])
    plain = remap_tables(Lens(projection=PINHOLE))
    assert remap_labels(owners[:, :640], plain).shape == (480, 640)


def test_columns_blend_as_the_float_maps_say():
    """Against OpenCV's own float maps, on a smooth image: fixed point is 1/32 px."""
    tables = remap_tables(Lens())
    ramp = np.tile(np.linspace(0, 255, 1152).astype(np.uint8)[None, :, None], (480, 1, 3))
    wide = Lens(1152, 480, FIELD, projection=PINHOLE)
    x = np.tile((places(wide, column_angles(Lens())) - 0.5).astype(np.float32), (480, 1))
    y = np.repeat(np.arange(480, dtype=np.float32)[:, None], 640, axis=1)
    reference = cv2.remap(ramp, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    assert np.abs(remap(ramp, tables, blend=True).astype(int) - reference).max() <= 1
    assert np.abs(remap(ramp, tables).astype(int) - reference).max() <= 1  # half a column of a slow ramp


@pytest.mark.parametrize(
    ("lens", "words"),
    [
        (Lens(projection="equalangle"), "did you mean equal-angle"),
        (Lens(width_px=0), "at least 1 x 1"),
        (Lens(field_of_view_rad=math.pi), "at most 170"),
        (Lens(field_of_view_rad=0.0), "more than 0"),
    ],
)
def test_a_lens_that_cannot_be_is_refused_in_one_line(lens, words):
    with pytest.raises(InputError, match=words) as refused:
        remap_tables(lens)
    assert "\n" not in str(refused.value)


def test_a_rendering_of_another_size_is_refused_in_one_line():
    tables = remap_tables(Lens(projection=EQUAL_ANGLE))
    with pytest.raises(InputError, match="640 x 480 px: expected 1152 x 480"):
        remap(np.zeros((480, 640, 3), np.uint8), tables)
    with pytest.raises(InputError, match="expected 1152 x 480"):
        remap_labels(np.zeros(5, np.uint8), tables)
