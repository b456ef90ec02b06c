"""The pipelines that read images, on cones drawn by geometry."""

from __future__ import annotations

import math

import numpy as np
import pytest

from flocking.errors import InputError
from flocking.types import Own
from sensing.camera.images import Images
from sensing.camera.lens import EQUAL_ANGLE, PINHOLE, PROJECTIONS, Lens, column_angles
from sensing.camera.looking import camera_mounts
from sensing.camera.palette import rgb
from sensing.pipelines import cone_member_based, cone_member_extrapolated, cone_sensor_based
from sensing.types import NOBODY, Detection, Senses
from tests.sensing.camera.scenes import MOUNTS, ORANGE, RADIUS, Cone, model_with_cameras, pictures

OWN = Own(np.zeros(2), 0.0, math.nan, np.full(2, np.nan), np.zeros(2, np.bool_), 0.1, 0, 0)
MODEL = model_with_cameras()
LENS = Lens()
ALL = [cone_member_based, cone_member_extrapolated, cone_sensor_based]


def run(pipeline, images: Images, lens: Lens = LENS, model=MODEL, **parameters) -> Detection:
    state = pipeline.start(pipeline.Parameters(**parameters), model, 0.3, np.tile(column_angles(lens), (2, 1)))
    return pipeline.detect(Senses(None, None, images=images), OWN, state)[0]


def at(distance: float, bearing_deg: float, camera: int | None = None) -> Cone:
    """A cone with its axis there, from the robot's centre or from one of the cameras (bearing in the body frame)."""
    x, y = (0.0, 0.0) if camera is None else MOUNTS[camera][:2]
    bearing = math.radians(bearing_deg)
    return Cone(x + distance * math.cos(bearing), y + distance * math.sin(bearing))


def test_cameras_are_found_where_they_are_in_the_body_frame():
    np.testing.assert_allclose(camera_mounts(MODEL), MOUNTS, atol=1e-12)


@pytest.mark.parametrize("bearing", [-105.0, -80.0, -47.5, -3.0, 0.0, 20.0, 60.0, 100.0])
@pytest.mark.parametrize("distance", [0.3, 0.6, 1.2, 1.8])
def test_one_cone_is_one_member_on_its_near_side(distance, bearing):
    cone = at(distance, bearing, camera=0 if bearing >= 0 else 1)
    images, owners = pictures([cone], LENS)
    detection = run(cone_member_based, images)
    assert detection.members.positions.shape == (1, 2)
    if (owners[:, :, [0, -1]] >= 0).any():
        assert distance < 0.4  # it is cut by an image's border
        return
    fits = []
    for x, y, _ in MOUNTS:  # either camera may have the longer run, by a pixel
        found, axis = detection.members.positions[0] - (x, y), np.array(cone[:2]) - (x, y)
        angle = math.degrees(math.atan2(found[1], found[0]) - math.atan2(axis[1], axis[0]))
        near = np.hypot(*axis) - RADIUS
        fits.append(abs(angle) < 1.0 / 5.12 and np.hypot(*found) == pytest.approx(near, rel=0.08))
    assert any(fits)


def test_the_far_steps_are_those_of_one_pixel():
    """A run is whole pixels: only 3.5 of 15, 16, 17 … can come out, from the camera's place."""
    for distance in np.linspace(1.2, 2.5, 14):
        images, _ = pictures([at(distance, 47.5, camera=0)], LENS)
        found = run(cone_member_based, images).members.positions[0] - MOUNTS[0][:2]
        pixels = 2 * math.degrees(math.atan(RADIUS / (np.hypot(*found) + RADIUS))) * 5.12
        assert pixels == pytest.approx(round(pixels), abs=1e-6)


@pytest.mark.parametrize("bearing", [-12.0, -1.0, 0.0, 8.0])
def test_a_cone_in_both_images_is_one_member_of_both_images_columns(bearing):
    images, owners = pictures([at(0.8, bearing)], LENS)
    assert np.all((owners >= 0).any(axis=(1, 2)))
    for pipeline in ALL:
        detection = run(pipeline, images)
        seen = (owners == 0).any(axis=1).ravel()
        if pipeline is cone_member_based:
            assert len(detection.members.ids) == 1
            assert np.array_equal(detection.beams == 0, seen)
            continue
        made = detection.beams >= 0
        assert np.all(seen[made])
        bearings = np.add.outer([MOUNTS[0][2], MOUNTS[1][2]], column_angles(LENS))
        if pipeline is cone_member_extrapolated:
            assert made[:640].any() != made[640:].any()
        else:  # either camera's own side
            assert np.array_equal(made, seen & np.stack((bearings[0] >= 0, bearings[1] < 0)).ravel())


def test_two_cones_are_one_closest_member_or_all_their_columns():
    near, far = at(0.6, 30.0), at(1.5, -40.0)
    images, owners = pictures([far, near], LENS)
    one = run(cone_member_based, images)
    assert one.members.positions.shape == (1, 2)
    assert one.members.positions[0] @ near[:2] > 0
    assert np.array_equal(one.beams >= 0, (owners == 1).any(axis=1).ravel())
    many = run(cone_member_extrapolated, images)
    assert np.array_equal(many.beams >= 0, (owners >= 0).any(axis=1).ravel())
    for thing, cone in ((1, near), (0, far)):
        rows = many.beams[(owners == thing).any(axis=1).ravel()]
        distances = np.hypot(*(many.members.positions[rows] - (0.1, 0.0)).T)
        assert np.ptp(distances) < 0.06
        mean = many.members.positions[rows].mean(axis=0)
        assert np.hypot(*(mean - cone[:2])) < 0.12


def test_every_orange_column_is_an_input_even_a_lone_pixel():
    images, owners = pictures([at(0.6, 30.0), at(1.5, -40.0)], LENS)
    left = images.left.copy()
    left[3, 17] = ORANGE
    found = run(cone_sensor_based, images._replace(left=left))
    expected = (owners >= 0).any(axis=1).ravel()
    expected[17] = True
    assert np.array_equal(found.beams >= 0, expected)
    lone = found.members.positions[found.beams[17]] - MOUNTS[0][:2]
    assert np.hypot(*lone) == pytest.approx(29.8, abs=0.1)
    without = run(cone_member_extrapolated, images._replace(left=left))
    assert without.beams[17] == NOBODY
    same = [run(p, images).members.positions for p in (cone_sensor_based, cone_member_extrapolated)]
    np.testing.assert_array_equal(*same)  # whole cones, away from the middle


def test_short_runs_are_no_cone_where_a_least_length_is_asked_for():
    picture = np.full((40, 640, 3), 120, np.uint8)
    picture[10, 100:103] = ORANGE
    images = Images(0.0, picture, np.full_like(picture, 120))
    assert len(run(cone_member_based, images).members.ids) == 1
    assert len(run(cone_member_extrapolated, images).members.ids) == 0
    assert len(run(cone_member_extrapolated, images, minimum_run_px=3).members.ids) == 3


def test_holes_of_up_to_five_pixels_are_bridged():
    images, _ = pictures([at(0.6, 40.0)], LENS)
    whole = run(cone_member_based, images).members.positions
    left = images.left.copy()
    columns = np.flatnonzero((left[:, :, 0] == ORANGE[0]).any(axis=0))
    middle = int(columns.mean())
    left[:, middle : middle + 5] = 255  # glare
    np.testing.assert_array_equal(run(cone_member_based, images._replace(left=left)).members.positions, whole)
    left[:, middle : middle + 6] = 255
    split = run(cone_member_based, images._replace(left=left)).members.positions
    assert np.hypot(*split[0]) > 1.5 * np.hypot(*whole[0])
    wide = run(cone_member_based, images._replace(left=left), largest_hole_px=6).members.positions
    np.testing.assert_array_equal(wide, whole)


@pytest.mark.parametrize("projection", PROJECTIONS)
@pytest.mark.parametrize("bearing", [47.5, 5.0, 95.0, 70.0])
def test_each_columns_own_angle_is_right_in_either_lens(projection, bearing):
    lens = Lens(projection=projection)
    cone = at(0.7, bearing, camera=0)
    images, _ = pictures([cone], lens)
    found = run(cone_member_based, images, lens, pixels_per_degree="lens").members.positions[0]
    off = found - MOUNTS[0][:2]
    assert math.degrees(math.atan2(off[1], off[0])) == pytest.approx(bearing, abs=0.5)
    assert np.hypot(*off) == pytest.approx(0.7 - RADIUS, rel=0.08)
    same = run(cone_member_based, images, lens).members.positions[0]
    if projection == EQUAL_ANGLE:
        np.testing.assert_allclose(same, found, atol=1e-9)
    else:
        ratio = np.hypot(*(same - MOUNTS[0][:2])) / (0.7 - RADIUS)
        assert {47.5: ratio > 1.7, 70.0: 1.3 < ratio < 1.6, 5.0: ratio < 0.9, 95.0: ratio < 0.8}[bearing]


def test_without_offset_distances_are_from_the_robots_centre():
    images, _ = pictures([at(0.8, 47.5, camera=0)], LENS)
    plain = run(cone_member_based, images).members.positions[0]
    none = run(cone_member_based, images, offset="none").members.positions[0]
    np.testing.assert_allclose(plain - none, MOUNTS[0][:2], atol=1e-9)


@pytest.mark.parametrize("kind", ["rgb", "monochrome", "hsv"])
def test_published_and_calibrated_ranges_differ_by_row(kind):
    """The drawn cone (190, 47, 0) is in the calibrated ranges and in the published HSV range, not in the RGB mask."""
    images, _ = pictures([at(0.8, 47.5)], LENS)
    assert len(run(cone_member_based, images, segmentation=kind).members.ids) == 1
    published = run(cone_member_based, images, segmentation=kind, ranges="published")
    assert len(published.members.ids) == (kind == "hsv")


@pytest.mark.parametrize("kind", ["rgb", "monochrome", "hsv"])
def test_with_a_colour_a_robot_ids_are_the_colours_numbers(kind):
    def coloured(cone: Cone, robot: int) -> Cone:
        return cone._replace(rgb=tuple(round(0.8 * 255 * c) for c in rgb(robot)))

    cones = [coloured(at(0.6, 30.0), 3), coloured(at(1.2, -30.0), 0), coloured(at(1.0, 75.0), 5)]
    images, owners = pictures(cones, LENS)
    one = run(cone_member_based, images, segmentation=kind, colours=6)
    assert one.members.ids.tolist() == [3]
    many = run(cone_member_extrapolated, images, segmentation=kind, colours=6)
    for thing, robot in ((0, 3), (1, 0), (2, 5)):
        rows = many.beams[(owners == thing).any(axis=1).ravel()]
        assert set(many.members.ids[rows[rows >= 0]]) == {robot}


@pytest.mark.parametrize("pipeline", ALL)
def test_mirrored_images_give_the_mirrored_detection(pipeline):
    cones = [at(0.5, 33.0), at(1.4, -62.0), at(2.2, 81.0)]
    mirrored = [cone._replace(y=-cone.y) for cone in cones]
    plain, turned = run(pipeline, pictures(cones, LENS)[0]), run(pipeline, pictures(mirrored, LENS)[0])
    order = np.lexsort(plain.members.positions.round(6).T)
    flipped = turned.members.positions * (1, -1)
    np.testing.assert_allclose(flipped[np.lexsort(flipped.round(6).T)], plain.members.positions[order], atol=1e-9)
    assert np.array_equal(turned.beams >= 0, plain.beams[::-1] >= 0)


@pytest.mark.parametrize("pipeline", ALL)
def test_no_images_yet_is_nothing_seen(pipeline):
    state = pipeline.start(pipeline.Parameters(), MODEL, 0.3, np.tile(column_angles(LENS), (2, 1)))
    detection, _ = pipeline.detect(Senses(None, None), OWN, state)
    assert len(detection.members.ids) == 0
    assert np.all(detection.beams == NOBODY)
    assert detection.beams.shape == (1280,)


@pytest.mark.parametrize("pipeline", ALL)
def test_what_cannot_be_is_refused_in_one_line(pipeline):
    angles = np.tile(column_angles(LENS), (2, 1))
    with pytest.raises(InputError, match="expected \\(2, columns\\)"):
        pipeline.start(pipeline.Parameters(), MODEL, 0.3, angles[0])
    with pytest.raises(InputError, match="expected 'calibrated', or colours = 1"):
        pipeline.start(pipeline.Parameters(colours=3, ranges="published"), MODEL, 0.3, angles)
    with pytest.raises(InputError, match="leans"):
        pipeline.start(pipeline.Parameters(), model_with_cameras(pitch=0.1), 0.3, angles)
    state = pipeline.start(pipeline.Parameters(), MODEL, 0.3, angles)
    narrow = np.zeros((480, 320, 3), np.uint8)
    with pytest.raises(InputError, match="expected \\(H, 640, 3\\)"):
        pipeline.detect(Senses(None, None, images=Images(0.0, narrow, narrow)), OWN, state)


def test_a_body_without_cameras_is_refused_in_one_line():
    import mujoco

    blind = mujoco.MjModel.from_xml_string("<mujoco><worldbody><body><geom size='1'/></body></worldbody></mujoco>")
    with pytest.raises(InputError, match="exactly one named 'camera_left'"):
        run(cone_member_based, pictures([], LENS)[0], model=blind)


def test_a_pinhole_taken_for_equal_angles_is_biased_in_both_directions():
    lens = Lens(projection=PINHOLE)
    centre, _ = pictures([at(1.0, 47.5, camera=0)], lens)
    ahead, _ = pictures([at(1.0, 0.0, camera=0)], lens)
    far = run(cone_member_based, centre, lens).members.positions[0] - MOUNTS[0][:2]
    near = run(cone_member_based, ahead, lens).members.positions[0] - MOUNTS[1][:2]
    assert np.hypot(*far) / (1.0 - RADIUS) == pytest.approx(1.8, abs=0.15)
    # the right camera has the longer run: it sees the cone 51 degrees off its axis
    assert np.hypot(*near) / (1.0 - RADIUS) == pytest.approx(0.69, abs=0.04)
