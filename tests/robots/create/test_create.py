"""The Create's model: what it weighs, where things are, and that the committed file is the code's."""

import inspect
import re

import mujoco
import numpy as np
import pytest

from robots import body
from robots.create import BODY
from robots.create import model as create


@pytest.fixture(scope="module")
def model() -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_path(str(body.xml_path("create")))


def test_the_committed_xml_is_what_the_code_makes():
    assert body.xml_path("create").read_text(encoding="utf-8") == body.xml(BODY)


def test_the_xml_loads_alone_and_rests_on_its_wheels(model):
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 300)
    assert data.warning.number.sum() == 0
    # Sinkage is some 0.01 mm; the pitch is what the caster's lighter load leaves of it.
    assert np.abs(data.qpos[:3]).max() < 1e-4
    assert np.abs(data.qpos[4:7]).max() < 1e-3
    assert np.abs(data.qvel).max() < 1e-6


def test_every_constant_has_its_grade():
    lines = inspect.getsource(create).splitlines()
    constants = [line for line in lines if re.match(r"[A-Z_]+ = [(0-9A-Z]", line)]
    constants = [line for line in constants if not line.startswith(("PARTS", "DIMENSIONS"))]
    assert len(constants) > 35
    for line in constants:
        assert re.search(r"[;#] (\?|[PCSD])(:|;|$)", line), line


def test_mass_and_inertia_follow_from_the_parts(model):
    expected = create.base_inertia()
    base = model.body("base")
    assert base.mass[0] == pytest.approx(expected.mass, rel=1e-12)
    np.testing.assert_allclose(base.ipos, expected.centre, atol=1e-12)
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, base.iquat)
    axes = rotation.reshape(3, 3)
    # The principal axes are found by iteration: 1e-6 of the largest is its accuracy.
    np.testing.assert_allclose(
        axes @ np.diag(base.inertia) @ axes.T, expected.tensor, atol=1e-6 * expected.tensor.max()
    )
    payload = create.LAPTOP_MASS + create.LASER_MASS + create.SILHOUETTE_MASS
    assert model.body_subtreemass[1] == pytest.approx(create.BASE_MASS + payload, rel=1e-12)


def test_the_yaw_inertia_is_near_half_m_r_squared_and_far_from_the_published_ones():
    """A disc of the base's radius bounds it (all mass lies within); published models give 0.5 and more."""
    inertia = create.base_inertia()
    disc = 0.5 * inertia.mass * create.RADIUS**2
    assert 0.5 * disc < inertia.tensor[2, 2] < disc


def test_the_wheel_is_a_disc(model):
    wheel = model.body("left")
    assert wheel.mass[0] == pytest.approx(create.WHEEL_MASS)
    assert max(wheel.inertia) == pytest.approx(0.5 * create.WHEEL_MASS * create.WHEEL_RADIUS**2)
    # and half of a step's share of the servo (`physics.take_servos_implicitly`): 0.06 × 0.01 / 2
    assert model.joint("left").armature[0] == pytest.approx(create.ROTOR_INERTIA + 3e-4, rel=1e-12)


def test_drive_is_read_back_from_the_model(model):
    for name, y in (("left", create.AXLE_TRACK / 2), ("right", -create.AXLE_TRACK / 2)):
        np.testing.assert_allclose(model.body(name).pos, (0, y, create.WHEEL_RADIUS))
        assert model.actuator(name).forcelimited[0]
        np.testing.assert_allclose(model.actuator(name).forcerange, (-create.MAX_WHEEL_TORQUE, create.MAX_WHEEL_TORQUE))
        assert model.actuator(name).gainprm[0] == create.WHEEL_SERVO_GAIN
        assert model.actuator(name).biasprm[2] == -create.WHEEL_SERVO_GAIN


def test_the_wheels_carry_most_of_the_weight_and_the_rear_caster_hangs_free(model):
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 300)
    loads = {}
    for c in range(data.ncon):
        force = np.empty(6)
        mujoco.mj_contactForce(model, data, c, force)
        loads[model.geom(data.contact[c].geom2).name] = force[0]
    weight = model.body_subtreemass[1] * -model.opt.gravity[2]
    assert set(loads) == {"left_tyre", "right_tyre", "front_caster"}
    assert sum(loads.values()) == pytest.approx(weight, rel=1e-6)
    # Lever rule: the caster carries what keeps the moment about the axle.
    ahead = sum(part.mass * part.position[0] for part in create.PARTS)
    assert loads["front_caster"] == pytest.approx(ahead * -model.opt.gravity[2] / create.CASTER_X, rel=1e-3)
    grip = create.TYRE_FRICTION * (loads["left_tyre"] + loads["right_tyre"])
    thrust = 2 * create.MAX_WHEEL_TORQUE / create.WHEEL_RADIUS
    assert grip < thrust < 1.5 * grip


def test_only_the_drum_stands_at_the_lasers_height(model):
    """So that lasers see one circle a robot; everything visible carries a reflectance."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    height = data.site("laser").xpos[2]
    assert height == pytest.approx(create.LASER_HEIGHT)
    at_height = []
    for k in range(model.ngeom):
        geom = model.geom(k)
        if geom.name == "floor" or geom.rgba[3] == 0.0:
            continue
        assert geom.user[0] > 0.0
        assert geom.contype[0] == 0
        extent = {
            mujoco.mjtGeom.mjGEOM_SPHERE: geom.size[0],
            mujoco.mjtGeom.mjGEOM_CYLINDER: geom.size[:2].max() if geom.name.endswith("_rim") else geom.size[1],
            mujoco.mjtGeom.mjGEOM_BOX: geom.size[2],
        }
        half = extent[mujoco.mjtGeom(geom.type[0])]
        if abs(height - data.geom_xpos[k, 2]) < half:
            at_height.append(geom.name)
    assert at_height == ["sheeting"]
    drum = model.geom("sheeting")
    assert drum.size[0] == create.SILHOUETTE_RADIUS
    assert drum.user[1] == create.SHEETING[1]
