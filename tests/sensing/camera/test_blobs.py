"""Cones as blobs: whole ones as the runs have them, hidden ones by what is left of them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from flocking.types import Own
from sensing.camera.blobs import _peaks, blobs
from sensing.camera.lens import PROJECTIONS, Lens, column_angles, column_edges
from sensing.camera.palette import CALIBRATED, rgb
from sensing.camera.runs import longest
from sensing.camera.segmentation import segmented
from sensing.pipelines import cone_blobs, cone_member_based
from sensing.types import Senses
from tests.sensing.camera.scenes import MOUNTS, RADIUS, Bar, Cone, model_with_cameras, pictures

OWN = Own(np.zeros(2), 0.0, math.nan, np.full(2, np.nan), np.zeros(2, np.bool_), 0.1, 0, 0)
MODEL = model_with_cameras()
LENS = Lens()
ORANGE = CALIBRATED["hsv"]


def run(images, pipeline=cone_blobs, lens: Lens = LENS, **parameters):
    state = pipeline.start(pipeline.Parameters(**parameters), MODEL, 0.3, np.tile(column_angles(lens), (2, 1)))
    return pipeline.detect(Senses(None, None, images=images), OWN, state)[0]


def from_left_camera(distance: float, bearing_deg: float) -> Cone:
    bearing = math.radians(bearing_deg)
    return Cone(MOUNTS[0][0] + distance * math.cos(bearing), MOUNTS[0][1] + distance * math.sin(bearing))


def distances(members) -> np.ndarray:
    """From the left camera to where the axes of the cones are said to be."""
    return np.hypot(*(members.positions - MOUNTS[0][:2]).T) + RADIUS


@pytest.mark.parametrize("projection", PROJECTIONS)
@pytest.mark.parametrize("distance", [0.25, 0.5, 1.0, 2.0, 3.0])
@pytest.mark.parametrize("bearing", [20.0, 47.5, 90.0])
def test_a_cone_alone_is_its_longest_run(projection, distance, bearing):
    lens = Lens(projection=projection)
    images, _ = pictures([from_left_camera(distance, bearing)], lens)
    labels, edges = segmented(images.left, ORANGE), column_edges(lens)
    parts, borders = blobs(labels, 1, 5, 4, edges)
    run_of_it = longest(labels, 1)[0]
    assert parts.tolist() == [[0, run_of_it[2], run_of_it[3]]]
    np.testing.assert_array_equal(borders[0], edges[[run_of_it[2], run_of_it[3] + 1]])
    one, other = run(images, lens=lens), run(images, cone_member_based, lens, pixels_per_degree="lens")
    np.testing.assert_allclose(one.members.positions, other.members.positions, atol=1e-9)
    np.testing.assert_array_equal(one.beams, other.beams)


@pytest.mark.parametrize("apart_deg", [2.5, 4.0, 6.0])
def test_a_cone_half_behind_another_is_two_at_their_distances(apart_deg):
    near, far = from_left_camera(0.7, 50.0), from_left_camera(1.2, 50.0 + apart_deg)
    images, _ = pictures([far, near], LENS)
    assert len(blobs(segmented(images.left, ORANGE), 1, 0, 4, column_edges(LENS))[0]) == (1 if apart_deg < 3 else 2)
    if apart_deg < 3:  # its tip is behind the other's flank: one outline, one cone
        return
    found = np.sort(distances(run(images).members))
    assert found == pytest.approx([0.7, 1.2], rel=0.12)
    one_run = run(images, cone_member_based).members
    assert distances(one_run)[0] < 0.7 * 0.95  # what the longest run makes of both


@pytest.mark.parametrize("share", [-0.8, -0.5, -0.2, 0.2, 0.5, 0.8])
def test_a_cone_with_a_side_hidden_is_as_far_as_the_other_side_says(share):
    """Something upright hides the left side up to `share` of the radius from the axis, or (positive) the right side."""
    distance = 0.8
    half = math.asin(RADIUS / distance)
    axis = math.radians(50.0)
    bar = (
        Bar(axis + abs(share) * half, axis + 2 * half, 0.4)
        if share < 0
        else Bar(axis - 2 * half, axis - share * half, 0.4)
    )
    images, _ = pictures([from_left_camera(distance, 50.0), bar], LENS)
    found = run(images).members
    assert distances(found) == pytest.approx([distance], rel=0.08)
    off = found.positions[0] - MOUNTS[0][:2]
    assert math.degrees(math.atan2(off[1], off[0])) == pytest.approx(50.0, abs=0.4)
    narrow = distances(run(images, cone_member_based).members)[0]
    assert abs(distances(found)[0] - distance) <= abs(narrow - distance) + 1e-9


def test_a_cone_cut_by_the_images_border_is_as_far_as_its_other_side_says():
    lens = Lens()
    border = 47.5 + 62.5
    images, owners = pictures([from_left_camera(0.6, border - 1.0)], lens)
    assert (owners[0][:, 0] >= 0).any()
    assert distances(run(images).members) == pytest.approx([0.6], rel=0.08)


def test_several_cones_are_as_many_members_and_both_images_columns_are_theirs():
    cones = [from_left_camera(0.6, 80.0), from_left_camera(1.0, 5.0), from_left_camera(1.6, -60.0)]
    images, owners = pictures(cones, LENS)
    found = run(images)
    assert len(found.members.ids) == 3
    assert np.all(found.members.ids == -1)
    shown = (owners >= 0).any(axis=1).ravel()
    assert np.array_equal(found.beams >= 0, shown)
    for thing, cone in enumerate(cones):
        rows = np.unique(found.beams[(owners == thing).any(axis=1).ravel()])
        assert len(rows) == 1
        place = found.members.positions[rows[0]]
        assert math.atan2(*place[::-1]) == pytest.approx(math.atan2(cone.y, cone.x), abs=0.02)
        assert np.hypot(*(place - cone[:2])) < 0.05 + 0.08 * np.hypot(*cone[:2])


def test_a_colour_a_robot_names_them_though_they_touch():
    def coloured(cone: Cone, robot: int) -> Cone:
        return cone._replace(rgb=tuple(round(0.8 * 255 * c) for c in rgb(robot)))

    images, _ = pictures([coloured(from_left_camera(1.2, 52.5), 4), coloured(from_left_camera(0.7, 50.0), 7)], LENS)
    found = run(images, colours=8).members
    assert found.ids.tolist() == [7, 4]
    assert distances(found) == pytest.approx([0.7, 1.2], rel=0.12)


def test_noise_narrower_than_asked_for_is_none():
    images, _ = pictures([from_left_camera(0.6, 50.0)], LENS)
    left = images.left.copy()
    left[np.random.default_rng(1).random(left.shape[:2]) < 0.002] = (255, 64, 0)
    assert len(run(images._replace(left=left), largest_hole_px=0).members.ids) == 1


@pytest.mark.parametrize(
    ("heights", "peaks", "cuts"),
    [
        ([3, 6, 9, 12, 9, 6, 3], [3], [0, 7]),
        ([12, 9, 6, 3], [0], [0, 4]),
        ([3, 6, 9, 12], [3], [0, 4]),
        ([5, 5, 5, 5], [0], [0, 4]),
        ([3, 9, 15, 9, 3, 9, 12, 6], [2, 6], [0, 5, 8]),
        ([3, 9, 15, 14, 15, 9, 3], [2], [0, 7]),  # a dent is no valley
        ([9, 3, 9, 3, 9], [0, 2, 4], [0, 2, 4, 5]),
        ([4], [0], [0, 1]),
    ],
)
def test_outlines_are_cut_between_peaks(heights, peaks, cuts):
    found = _peaks(np.array(heights, dtype=float))
    assert (found[0].tolist(), found[1].tolist()) == (peaks, cuts)
