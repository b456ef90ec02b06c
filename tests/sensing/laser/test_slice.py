"""What stands at the laser's height, against the geoms it was cut from."""

import mujoco
import numpy as np
import pytest

from flocking.errors import InputError
from sensing.laser import planar
from sensing.laser.slice import CLEARANCE_M, slice_at

BOX, CYLINDER, SPHERE, CAPSULE, ELLIPSOID = (
    mujoco.mjtGeom.mjGEOM_BOX,
    mujoco.mjtGeom.mjGEOM_CYLINDER,
    mujoco.mjtGeom.mjGEOM_SPHERE,
    mujoco.mjtGeom.mjGEOM_CAPSULE,
    mujoco.mjtGeom.mjGEOM_ELLIPSOID,
)
EXACT = 1e-12  # round-off of a few rotations of numbers near 1


def world(**geom):
    spec = mujoco.MjSpec()
    spec.nuser_geom = 2
    spec.worldbody.add_geom(**({"name": "it", "userdata": [0.8, 0.0]} | geom))
    return spec.compile()


def about(axis, angle):
    return [np.cos(angle / 2), *(np.sin(angle / 2) * np.array(axis))]


def test_a_box_turned_about_z_gives_its_rectangle():
    model = world(type=BOX, size=[1.0, 0.2, 0.5], pos=[2.0, 3.0, 0.4], quat=about([0, 0, 1], 0.7))
    cut = slice_at(model, 0.2)
    assert cut.rectangles == 1
    np.testing.assert_allclose(cut.shapes[0], [2, 3, np.cos(0.7), np.sin(0.7), 1.0, 0.2], atol=EXACT)


@pytest.mark.parametrize(("axis", "halves"), [([1, 0, 0], {1.0, 0.5}), ([0, 1, 0], {0.5, 0.2})])
def test_a_box_on_its_side_is_still_a_prism(axis, halves):
    cut = slice_at(world(type=BOX, size=[1.0, 0.2, 0.5], quat=about(axis, np.pi / 2)), 0.1)
    assert {round(float(half), 12) for half in cut.shapes[0, 4:]} == halves


def test_round_geoms_give_the_radius_of_their_section():
    cylinder = slice_at(world(type=CYLINDER, size=[0.3, 0.5, 0]), 0.4)
    sphere = slice_at(world(type=SPHERE, size=[0.5, 0, 0]), 0.3)
    capsule = slice_at(world(type=CAPSULE, size=[0.5, 1.0, 0]), 1.3)
    waist = slice_at(world(type=CAPSULE, size=[0.5, 1.0, 0]), 0.9)
    radii = [cut.shapes[0, 4] for cut in (cylinder, sphere, capsule, waist)]
    np.testing.assert_allclose(radii, [0.3, 0.4, 0.4, 0.5], atol=EXACT)  # 3-4-5 triangles
    assert all(cut.rectangles == 0 for cut in (cylinder, sphere, capsule, waist))


def test_what_ends_below_the_plane_is_missed_and_what_ends_at_it_is_refused():
    model = world(type=BOX, size=[1, 1, 0.5], pos=[0, 0, 0.5])
    assert len(slice_at(model, 1.0 + CLEARANCE_M + 1e-6).shapes) == 0
    assert len(slice_at(model, 1.0 - CLEARANCE_M - 1e-6).shapes) == 1
    for height in (1.0 - CLEARANCE_M + 1e-6, 1.0 + CLEARANCE_M - 1e-6):
        with pytest.raises(InputError, match="geom 'it' ends"):
            slice_at(model, height)


@pytest.mark.parametrize(
    "geom",
    [
        {"type": BOX, "size": [1, 1, 1], "quat": about([1, 0, 0], 0.1)},
        {"type": CYLINDER, "size": [0.5, 1, 0], "quat": about([1, 0, 0], np.pi / 2)},
        {"type": CAPSULE, "size": [0.5, 1, 0], "quat": about([1, 0, 0], 0.2)},
        {"type": ELLIPSOID, "size": [0.5, 1, 1]},
        {"type": mujoco.mjtGeom.mjGEOM_PLANE, "size": [1, 1, 1], "quat": about([1, 0, 0], np.pi / 2)},
    ],
)
def test_no_prism_is_an_error_that_names_the_other_method(geom):
    with pytest.raises(InputError, match=r"geom 'it'.*sensing\.laser\.reference"):
        slice_at(world(**geom), 0.1)


@pytest.mark.parametrize("userdata", [[0.0, 0.0], [1.5, 0.0], [-0.1, 5.0], [0.5, np.nan]])
def test_a_geom_without_sensible_reflectance_is_named(userdata):
    with pytest.raises(InputError, match=r"geom 'it'.*reflectance"):
        slice_at(world(type=SPHERE, size=[1, 0, 0], userdata=userdata), 0.1)


def test_a_model_without_user_data_is_named():
    spec = mujoco.MjSpec()
    spec.worldbody.add_body(name="post").add_geom(type=SPHERE, size=[1, 0, 0])
    with pytest.raises(InputError, match=r"geom 0 of body 'post'.*reflectance"):
        slice_at(spec.compile(), 0.1)


def test_the_wholly_transparent_is_not_there():
    assert len(slice_at(world(type=ELLIPSOID, size=[1, 1, 2], rgba=[1, 1, 1, 0], userdata=[0, 0]), 0.1).shapes) == 0


def test_shapes_follow_their_bodies_as_the_geoms_do(arena):
    """Frames from qpos against MuJoCo's own kinematics, a pole on a welded child and a turned start included."""

    def pole(spec):
        arm = spec.body("robot-1").add_body(pos=[0.0, 0.1, 0.0], quat=about([0, 0, 1], 0.3))
        arm.add_geom(name="pole", type=BOX, size=[0.02, 0.03, 0.3], pos=[0.1, 0, 0.2], userdata=[0.5, 0])
        spec.body("robot-0").pos = [1.0, 2.0, 0.0]
        spec.body("robot-0").quat = about([0, 0, 1], 1.0)

    rng = np.random.default_rng(1)
    scene = arena([(0, 0, 0), (1, 1, 1)], edit=pole)
    model, data = scene.model, scene.data
    cut = slice_at(model, 0.18, scene.roots)
    assert sorted(cut.owners) == [0, 1, 1]
    assert set(cut.bodies) == set(scene.roots)
    shapes = planar.Shapes(cut.shapes, cut.rectangles, cut.frames, cut.owners, cut.materials)
    for _ in range(20):
        for k in range(2):
            scene.put(k, *rng.uniform(-3, 3, 3))
        mujoco.mj_kinematics(model, data)
        poses = np.empty((2, 4))
        assert planar.place(data.qpos, planar.Frames(cut.addresses, cut.levels_m, 0.18), poses) == planar.LEVEL
        for p, geom in enumerate(cut.geoms):
            x, y, ux, uy = planar.in_laser_frame(shapes, p, poses, planar.Pose(0.0, 0.0, 1.0, 0.0))
            np.testing.assert_allclose([x, y], data.geom_xpos[geom][:2], atol=EXACT)
            if p < cut.rectangles:
                np.testing.assert_allclose([ux, uy], data.geom_xmat[geom].reshape(3, 3)[:2, 0], atol=EXACT)


def test_walls_are_the_closed_outlines_of_what_is_fixed(arena):
    scene = arena([(0, 0, 0)], walls=[(2.0, 1.0, 0.5, 1.0, 0.1)])
    walls = slice_at(scene.model, 0.18, scene.roots).walls_w()
    assert walls.shape == (4, 4)
    np.testing.assert_allclose(walls[:, 2:], np.roll(walls[:, :2], -1, axis=0), atol=EXACT)
    lengths = np.hypot(*(walls[:, 2:] - walls[:, :2]).T)
    np.testing.assert_allclose(np.sort(lengths), [0.2, 0.2, 2.0, 2.0], atol=EXACT)
    np.testing.assert_allclose(walls[:, :2].mean(axis=0), [2.0, 1.0], atol=EXACT)


def test_silhouettes_reach_to_the_farthest_point(arena):
    def fin(spec):
        spec.body("robot-1").add_geom(type=BOX, size=[0.3, 0.4, 0.3], pos=[0, 0, 0.2], userdata=[0.5, 0])

    scene = arena([(0, 0, 0), (2, 2, 0.5)], edit=fin)
    radii = slice_at(scene.model, 0.18, scene.roots).silhouette_radii(scene.roots, scene.model)
    np.testing.assert_allclose(radii, [0.15, 0.5], atol=EXACT)  # a 3-4-5 triangle
