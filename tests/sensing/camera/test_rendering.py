"""What cameras see, held against geometry: where a cone's edges must appear, and who hides whom."""

from __future__ import annotations

import math
import os

import cv2
import numpy as np
import pytest

from flocking.errors import InputError
from flocking.types import Floats
from robots import eyes
from robots.create_with_cameras.model import EYES
from sensing.camera import opengl
from sensing.camera.lens import PROJECTIONS, Lens, column_angles
from sensing.camera.rendering import Cameras
from worlds.assemble import World, build, prefix


@pytest.fixture(scope="module", autouse=True)
def rendering() -> None:
    """All of these need OpenGL."""
    try:
        opengl.library()
    except InputError as error:
        pytest.skip(str(error))


A_COLUMN = 1.5
"""Columns: an edge is drawn in the column that its middle falls into, in the wide image and in the lens's."""


A_PIXEL_AROUND = np.ones((3, 3), np.uint8)
"""At its edges a cone is mixed with what is behind it."""


def world_of(poses: list[tuple[float, float, float]]) -> World:
    names = [f"robot-{k}" for k in range(len(poses))]
    return build("open-floor", {}, ["create-with-cameras"] * len(poses), names, np.array(poses), 0.01)


def cameras_of(world: World, lens: Lens) -> Cameras:
    return Cameras(world.seen(), [prefix(name) for name in world.names], [lens] * len(world.names))


def lens_place(side: int) -> tuple[float, float, float]:
    """x, y and yaw of a lens in its robot's frame."""
    yaw = (1 - 2 * side) * eyes.YAW
    ahead = eyes.HOUSING[0] / 2 + eyes.LENS_AHEAD
    return EYES.camera_x + ahead * math.cos(yaw), (1 - 2 * side) * EYES.camera_y + ahead * math.sin(yaw), yaw


def edges(side: int, x: float, y: float) -> tuple[float, float]:
    """Bearings of both edges of the base of a cone at (x, y), in the frame of a camera of a robot at the origin."""
    at_x, at_y, yaw = lens_place(side)
    bearing = math.atan2(y - at_y, x - at_x) - yaw
    half = math.asin(eyes.CONE_RADIUS / math.hypot(x - at_x, y - at_y))
    return bearing + half, bearing - half


def column_of(lens: Lens, bearing: float) -> float:
    """Where a bearing falls, in columns from the left edge."""
    angles: Floats = column_angles(lens)
    return float(np.interp(-bearing, -angles, np.arange(lens.width_px) + 0.5))


@pytest.mark.parametrize("projection", PROJECTIONS)
@pytest.mark.parametrize(
    ("distance", "bearing_deg"), [(0.6, 20.0), (1.0, 47.5), (1.5, -80.0), (2.5, -30.0), (1.0, 90.0)]
)
def test_a_cone_takes_the_columns_that_geometry_says(projection: str, distance: float, bearing_deg: float) -> None:
    x, y = distance * math.cos(math.radians(bearing_deg)), distance * math.sin(math.radians(bearing_deg))
    world, lens = world_of([(0.0, 0.0, 0.0), (x, y, 2.0)]), Lens(projection=projection)
    truth = cameras_of(world, lens).truth(world.data, 0)
    side = 0 if bearing_deg > 0.0 else 1
    mine = np.flatnonzero(truth.owners[side * lens.width_px : (side + 1) * lens.width_px] == 1)
    left, right = (column_of(lens, each) for each in edges(side, x, y))
    assert mine[0] == pytest.approx(left, abs=A_COLUMN)
    assert mine[-1] + 1 == pytest.approx(right, abs=A_COLUMN)
    assert len(mine) == mine[-1] + 1 - mine[0]


def test_a_cone_behind_is_not_seen_and_nobody_sees_the_own_one() -> None:
    world = world_of([(0.0, 0.0, 0.0), (-1.0, 0.0, 0.0)])
    cameras = cameras_of(world, Lens())
    assert np.all(cameras.truth(world.data, 0).owners == -1)
    seen = cameras.truth(world.data, 1)
    assert seen.lit[0] > 0
    assert seen.lit[1] == 0


def test_a_nearer_cone_hides_the_one_behind_it() -> None:
    x, y, yaw = lens_place(0)
    behind_one_another = [(x + d * math.cos(yaw), y + d * math.sin(yaw), 0.0) for d in (1.0, 3.0)]
    world = world_of([(0.0, 0.0, 0.0), *behind_one_another])
    seen = cameras_of(world, Lens()).truth(world.data, 0)
    assert seen.lit[1] > 0
    assert seen.lit[2] == 0


def test_the_images_show_orange_where_the_truth_has_cones() -> None:
    world = world_of([(0.0, 0.0, 0.0), (0.8, 0.5, 1.0), (1.2, -0.9, 0.0)])
    cameras = cameras_of(world, Lens())
    images, shown = cameras.look(world.data, 0, 0.5), cameras.shown(world.data, 0)
    assert images.time == 0.5
    for picture, owners in ((images.left, shown.left), (images.right, shown.right)):
        red, green, blue = (picture[..., channel].astype(int) for channel in range(3))
        orange = (red > 3 * green) & (red > 100) & (blue < 30)
        cone = (owners >= 0).astype(np.uint8)
        inside, about = cv2.erode(cone, A_PIXEL_AROUND), cv2.dilate(cone, A_PIXEL_AROUND)
        assert inside.any()
        assert orange[inside > 0].all()
        assert not orange[about == 0].any()


def test_the_right_image_can_be_later() -> None:
    world = world_of([(0.0, 0.0, 0.0), (1.2, -0.9, 0.0)])
    cameras = cameras_of(world, Lens())
    world.data.qvel[-8 + 1] = 1.0  # the other robot's free joint: y
    still, later = cameras.look(world.data, 0, 0.0), cameras.look(world.data, 0, 0.0, lag_s=0.2)
    assert np.array_equal(still.left, later.left)
    assert not np.array_equal(still.right, later.right)
    again = cameras.look(world.data, 0, 0.0)
    assert np.array_equal(still.right, again.right)


def test_the_truth_of_a_later_right_image_is_later_too() -> None:
    """As if the right image were taken of a world in which 0.2 s have passed."""
    world, later = (world_of([(0.0, 0.0, 0.0), (1.2, y, 0.0)]) for y in (-0.9, -0.7))
    cameras = cameras_of(world, Lens())
    world.data.qvel[-8 + 1] = 1.0  # the other robot's free joint: y
    at_once, lagged = (cameras.truth(world.data, 0, lag_s).owners for lag_s in (0.0, 0.2))
    assert np.array_equal(lagged[:640], at_once[:640])
    expected = cameras_of(later, Lens()).truth(later.data, 0)
    assert np.array_equal(lagged[640:], expected.owners[640:])
    assert not np.array_equal(lagged[640:], at_once[640:])
    assert np.array_equal(cameras.shown(world.data, 0, 0.2).right, cameras_of(later, Lens()).shown(later.data, 0).right)
    for right, y in ((False, -0.9), (True, -0.7)):
        standing = cameras.standing(world.data, 0, right, 0.2)
        np.testing.assert_allclose(standing.robots_w, [(0.0, 0.0), (1.2, y)], atol=1e-6)
        np.testing.assert_allclose(standing.lens_w, lens_place(int(right)), atol=1e-6)


def test_each_cone_can_have_a_colour_of_its_own() -> None:
    world = world_of([(0.0, 0.0, 0.0), (0.8, 0.5, 1.0)])
    colours = [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
    cameras = Cameras(world.seen(), [prefix(name) for name in world.names], [Lens()] * 2, colours=colours)
    images, shown = cameras.look(world.data, 0, 0.0), cameras.shown(world.data, 0)
    mean = images.left[shown.left == 1].mean(axis=0)
    assert mean[2] > 3.0 * max(mean[0], mean[1])


def test_one_renderer_does_not_disturb_another() -> None:
    world = world_of([(0.0, 0.0, 0.0), (0.8, 0.5, 1.0)])
    first = cameras_of(world, Lens())
    before = first.look(world.data, 0, 0.0)
    cameras_of(world, Lens(width_px=320, height_px=240)).look(world.data, 0, 0.0)
    after = first.look(world.data, 0, 0.0)
    assert np.array_equal(before.left, after.left)


def test_a_library_that_renders_nothing_is_refused_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MUJOCO_GL", "glfw")
    with pytest.raises(InputError, match="expected osmesa or egl") as refused:
        opengl.library()
    assert "\n" not in str(refused.value)


def test_what_is_set_aside_is_still_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(opengl.ASIDE, raising=False)
    monkeypatch.setenv("MUJOCO_GL", "Nonsense ")
    opengl.set_aside()
    assert "MUJOCO_GL" not in os.environ
    assert opengl.asked_for() == "nonsense"
    opengl.set_aside()  # as a command that a command starts
    with pytest.raises(InputError, match="MUJOCO_GL = 'nonsense' renders nothing"):
        opengl.library()
    monkeypatch.setenv("MUJOCO_GL", "egl")
    assert opengl.asked_for() == "egl"
    monkeypatch.delenv(opengl.ASIDE)


def test_without_any_library_the_missing_packages_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.delenv("CREATE_HERD_GL", raising=False)
    monkeypatch.delenv(opengl.ASIDE, raising=False)
    monkeypatch.setattr(opengl, "_fault", lambda each: f"no {each} here")
    with pytest.raises(InputError, match="libosmesa6") as refused:
        opengl.library()
    assert "libegl1" in str(refused.value)
    assert "\n" not in str(refused.value)
