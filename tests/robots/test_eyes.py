"""Bodies with eyes: where their cameras look, where their cones stand, and that one sees the other."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest

from robots import body as bodies
from robots import eyes
from robots.body import Body

NAMES = [name for name in bodies.names() if "cameras" in bodies.load(name).mounts]
SIDES = dict(zip(eyes.CAMERAS, (1.0, -1.0), strict=True))


@pytest.fixture(params=NAMES)
def body(request: pytest.FixtureRequest) -> Body:
    return bodies.load(request.param)


def at_rest(body: Body) -> tuple[mujoco.MjModel, mujoco.MjData]:
    model = body.spec().compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def cone_vertices(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
    """(V, 3) in the world, m."""
    geom = model.geom("cone")
    mesh = model.mesh(int(geom.dataid[0]))
    first, count = int(mesh.vertadr[0]), int(mesh.vertnum[0])
    turn = data.geom("cone").xmat.reshape(3, 3)
    return model.mesh_vert[first : first + count] @ turn.T + data.geom("cone").xpos


def test_there_are_bodies_with_eyes() -> None:
    assert "create-with-cameras" in NAMES


@pytest.mark.parametrize("camera", eyes.CAMERAS)
def test_cameras_look_level_and_to_their_sides(body: Body, camera: str) -> None:
    """Along −z with y up and x to the right, MuJoCo's convention, 47.5 degrees off the nose; their sites along x."""
    _, data = at_rest(body)
    yaw = SIDES[camera] * math.radians(47.5)
    ahead = np.array([math.cos(yaw), math.sin(yaw), 0.0])
    right = np.array([math.sin(yaw), -math.cos(yaw), 0.0])
    turn = data.camera(camera).xmat.reshape(3, 3)
    np.testing.assert_allclose(turn, np.column_stack([right, [0, 0, 1], -ahead]), atol=1e-12)
    np.testing.assert_allclose(data.site(camera).xmat.reshape(3, 3)[:, 0], ahead, atol=1e-12)
    np.testing.assert_allclose(data.site(camera).xpos, data.camera(camera).xpos, atol=1e-12)


def test_their_images_are_125_degrees_wide(body: Body) -> None:
    model, _ = at_rest(body)
    for name in eyes.CAMERAS:
        camera = model.camera(name).id
        width, height = model.cam_resolution[camera]
        assert (width, height) == (640, 480)
        tall = math.tan(math.radians(model.cam_fovy[camera]) / 2)
        assert math.degrees(2 * math.atan(tall * width / height)) == pytest.approx(125.0, abs=1e-6)
        assert model.cam_fovy[camera] == pytest.approx(110.472, abs=1e-3)


def test_the_cone_is_as_published_and_its_base_as_high_as_the_lenses(body: Body) -> None:
    model, data = at_rest(body)
    vertices = cone_vertices(model, data)
    base, top = vertices[:, 2].min(), vertices[:, 2].max()
    assert base == pytest.approx(data.camera("camera_left").xpos[2], abs=1e-6)
    assert top - base == pytest.approx(0.1524, abs=1e-6)
    rim = vertices[vertices[:, 2] < base + 1e-4]
    across = np.hypot(*(rim[:, :2] - rim[:, :2].mean(0)).T)
    np.testing.assert_allclose(across, 0.0508, atol=1e-6)
    assert body.silhouette_radius == pytest.approx(0.0508)
    geom = model.geom("cone")
    assert geom.contype == geom.conaffinity == 0
    np.testing.assert_allclose(geom.rgba, [1.0, 0.25, 0.0, 1.0])
    assert model.mat_specular[int(geom.matid[0])] == 0.0


@pytest.mark.parametrize("camera", eyes.CAMERAS)
def test_no_camera_sees_its_own_cone(body: Body, camera: str) -> None:
    model, data = at_rest(body)
    away = cone_vertices(model, data) - data.camera(camera).xpos
    seen = away @ data.camera(camera).xmat.reshape(3, 3)
    assert (np.degrees(np.arctan2(np.abs(seen[:, 0]), -seen[:, 2])) > 62.5).all()


@pytest.mark.parametrize("distance", [0.25, 0.5, 1.0, 3.0])
def test_a_cone_ahead_is_whole_in_the_image(body: Body, distance: float) -> None:
    """Of another robot of the kind, on a camera's axis: base and point are within the image, the base in its middle."""
    model, data = at_rest(body)
    cone = cone_vertices(model, data)
    camera = data.camera("camera_left")
    turn = camera.xmat.reshape(3, 3)
    ahead = -turn[:, 2]
    middle = cone[:, :2].mean(0)
    cone[:, :2] += camera.xpos[:2] + distance * ahead[:2] - middle
    seen = (cone - camera.xpos) @ turn
    wide, tall = math.tan(math.radians(62.5)), math.tan(math.radians(110.472 / 2))
    assert (seen[:, 2] < 0).all()
    assert (np.abs(seen[:, 0] / seen[:, 2]) < wide).all()
    assert (np.abs(seen[:, 1] / seen[:, 2]) < tall).all()
    assert np.abs(seen[:, 1] / seen[:, 2]).min() < 1e-6


def test_nothing_of_the_robot_hides_its_cones_base_but_a_camera_s_top(body: Body) -> None:
    """From any side, at the cameras' height: what stands higher than the lenses is the cone and 5 mm of housings."""
    model, data = at_rest(body)
    lens = data.camera("camera_left").xpos[2]
    for geom in range(model.ngeom):
        name = model.geom(geom).name
        if name == "cone" or model.geom_group[geom] == 3 or model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE:
            continue
        half = np.abs(data.geom_xmat[geom].reshape(3, 3)) @ model.geom_aabb[geom, 3:]
        top = data.geom_xpos[geom, 2] + half[2]
        assert top <= lens + (0.0050001 if name.endswith("_housing") else 1e-9), name
