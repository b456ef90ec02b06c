"""Where lasers are mounted, how much of the turn they see, other movers, and mountings that cannot be."""

import math

import mujoco
import numpy as np
import pytest

from flocking.errors import InputError
from sensing.laser.hokuyo import ANGLES, Lasers, Parameters
from sensing.types import NOBODY
from tests.sensing.laser.lasers import (
    BEAMS,
    EXACT,
    FRONT,
    HARSH,
    IDEAL,
    SHEET,
    for_light,
    for_ranges,
    lasers_of,
    wall_at,
)


@pytest.mark.parametrize("sweep", [False, True])
@pytest.mark.parametrize("view_deg", [0.0, 90.0, 150.0, 180.0, 239.0])
def test_nothing_is_seen_out_of_view_and_all_the_same_within(arena, view_deg, sweep):
    scene = arena([(0, 0, 0), (0.9, 0.5, 0), (-0.3, 1.0, 0), (-0.8, -0.5, 0)], [wall_at(2.0), (0, 2, 0, 5, 0.1)])
    laser = HARSH._replace(dropout=0.0, sweep=sweep)
    whole, narrow = lasers_of(scene, laser), lasers_of(scene, laser._replace(view_deg=view_deg))
    seen, truth = whole.read(scene.data, 0, 0.0, for_ranges(), for_light())
    part, part_truth = narrow.read(scene.data, 0, 0.0, for_ranges(), for_light())
    inside = np.abs(np.degrees(ANGLES)) <= view_deg / 2.0
    assert 0 < inside.sum() < BEAMS
    assert np.isinf(part.ranges[~inside]).all()
    assert np.all(part_truth.owners[~inside] == NOBODY)
    assert np.all(part.intensities[~inside] == 0.0)
    # the beams at the border have no neighbour beyond it to be mixed with
    deep = np.convolve(inside, [1, 1, 1], mode="same") == 3
    np.testing.assert_array_equal(part.ranges[deep], seen.ranges[deep])
    np.testing.assert_array_equal(part.intensities[deep], seen.intensities[deep])
    np.testing.assert_array_equal(part_truth.owners[deep], truth.owners[deep])
    hits = lasers_of(scene, IDEAL._replace(view_deg=view_deg)).read(scene.data, 0, 0.0, for_ranges())[1]
    assert [int((hits.owners == k).sum()) for k in range(1, 4)] == hits.lit[1:].tolist()


def test_the_usual_view_has_every_beam(arena):
    scene = arena([(0, 0, 0)], [(0, 1.5, 0, 9, 0.1), (0, -1.5, 0, 9, 0.1)])
    assert np.isfinite(lasers_of(scene, IDEAL).read(scene.data, 0, 0.0, for_ranges())[0].ranges[[0, -1]]).all()
    assert Parameters().view_deg >= 2.0 * np.degrees(np.abs(ANGLES).max())


def test_mounts_walls_and_silhouettes_are_told(arena):
    scene = arena([(1, 2, 3), (0, 0, 0)], [wall_at(1.0)], mount=(0.05, -0.02, 0.4))
    lasers = lasers_of(scene, SHEET)
    np.testing.assert_allclose(lasers.mounts, [[0.05, -0.02, 0.4]] * 2, atol=1e-12)
    assert lasers.walls_w.shape == (4, 4)
    np.testing.assert_allclose(lasers.silhouette_radii, 0.15)


def test_doors_and_mocap_bodies_are_seen_where_they_stand(arena):
    def add(spec):
        door = spec.worldbody.add_body(name="door", pos=[2.0, 0.0, 0.0])
        door.add_joint(name="hinge", axis=[0, 0, 1])
        door.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.05, 1, 0.3], pos=[0, 0, 0.3], userdata=[0.5, 0], mass=1)
        block = spec.worldbody.add_body(name="block", mocap=True, pos=[0.1, 1.0, 0.0])
        block.add_geom(type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=[0.2, 0.5, 0], userdata=[0.5, 0])

    scene = arena([(0, 0, 0)], edit=add)
    lasers = lasers_of(scene, IDEAL)
    scene.data.qpos[scene.model.joint("hinge").qposadr[0]] = 0.2
    scene.data.mocap_pos[0] = [0.1, 1.5, 0.0]
    distances, _ = lasers.cast(scene.data, 0)
    face = 2.0 - 0.05 / math.cos(0.2)  # where the turned door's face crosses the x axis
    assert distances[FRONT] == pytest.approx(face - 0.1, abs=EXACT)
    assert distances[FRONT + 256] == pytest.approx(1.3, abs=EXACT)
    assert lasers.walls_w.shape == (0, 4)


def test_a_robot_that_stands_fixed_scans_too():
    spec = mujoco.MjSpec()
    spec.nuser_geom = 2
    post = spec.worldbody.add_body(name="post", pos=[1.0, 0.0, 0.0])
    post.add_site(name="eye", pos=[0, 0, 0.2])
    post.add_geom(type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=[0.1, 0.5, 0], userdata=[0.5, 0])
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.5, 0, 0], pos=[3, 0, 0.2], userdata=[0.5, 0])
    model = spec.compile()
    lasers = Lasers(model, ["eye"], [model.body("post").id], [IDEAL])
    assert lasers.cast(mujoco.MjData(model), 0)[0][FRONT] == pytest.approx(1.5, abs=EXACT)


def test_wrong_mountings_are_named(arena):
    scene = arena([(0, 0, 0), (1, 0, 0)])
    model, sites, roots = scene.model, scene.sites, scene.roots
    with pytest.raises(InputError, match=r"unknown site 'robot-0/lasr'; did you mean robot-0/laser"):
        Lasers(model, ["robot-0/lasr"], roots[:1], [SHEET])
    with pytest.raises(InputError, match="'robot-0/laser' is not mounted on body 'robot-1'"):
        Lasers(model, sites[:1], roots[1:], [SHEET])
    with pytest.raises(InputError, match="2 sites, 2 roots and 1 sets"):
        Lasers(model, sites, roots, [SHEET])

    def raise_one(spec):
        spec.site("robot-1/laser").pos = [0.1, 0.0, 0.2]

    high = arena([(0, 0, 0), (1, 0, 0)], edit=raise_one)
    with pytest.raises(InputError, match=r"'robot-1/laser' scans at 0\.2 m"):
        lasers_of(high, SHEET)

    def hang(spec):
        spec.site("robot-1/laser").quat = [0, 1, 0, 0]

    with pytest.raises(InputError, match="'robot-1/laser' leans"):
        lasers_of(arena([(0, 0, 0), (1, 0, 0)], edit=hang), SHEET)
