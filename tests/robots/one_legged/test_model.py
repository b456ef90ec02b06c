"""Tables 1 and 2 of Hodgins and Brogan 1994, read back from the compiled model; free flight of what they describe."""

from __future__ import annotations

import itertools
import math

import mujoco
import numpy as np
import pytest

from robots.one_legged import model as one_legged
from robots.one_legged.ground import build

TABLE_1 = {
    "base": (23.1, (0.9, 0.9, 0.602)),
    "upper_leg": (1.4, (0.018463, 0.017297, 0.001441)),
    "lower_leg": (0.64, (0.0197, 0.0197, 0.000176)),
}
"""Link → mass, kg, and moment of inertia about its centre of mass, kg m²."""


@pytest.fixture(scope="module")
def model() -> mujoco.MjModel:
    return one_legged.spec().compile()


@pytest.mark.parametrize("link", TABLE_1)
def test_masses_and_inertias_are_those_of_table_1(model: mujoco.MjModel, link: str) -> None:
    mass, inertia = TABLE_1[link]
    body = model.body(link)
    assert body.mass[0] == mass
    np.testing.assert_array_equal(body.inertia, inertia)
    np.testing.assert_array_equal(body.iquat, (1.0, 0.0, 0.0, 0.0))


def test_lengths_are_those_of_table_2(model: mujoco.MjModel) -> None:
    """The distance from each link's centre of mass to its joints, along z."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    centre = {link: data.xipos[model.body(link).id] for link in TABLE_1}
    hip, leg = data.xanchor[model.joint("hip_x").id], data.xanchor[model.joint("leg").id]
    for joint in ("hip_y", "hip_z"):
        np.testing.assert_array_equal(data.xanchor[model.joint(joint).id], hip)
    np.testing.assert_allclose(hip - centre["base"], 0.0, atol=1e-15)
    np.testing.assert_allclose(hip - centre["upper_leg"], (0.0, 0.0, 0.095), atol=1e-12)
    np.testing.assert_allclose(leg - centre["upper_leg"], (0.0, 0.0, -0.095), atol=1e-12)
    np.testing.assert_allclose(leg - centre["lower_leg"], (0.0, 0.0, 0.221), atol=1e-12)


def test_the_controlled_degrees_of_freedom_are_three_at_the_hip_and_the_legs_length(model: mujoco.MjModel) -> None:
    kinds = [model.joint(name).type[0] for name in one_legged.JOINTS]
    assert kinds == [mujoco.mjtJoint.mjJNT_HINGE] * 3 + [mujoco.mjtJoint.mjJNT_SLIDE]
    assert [model.actuator(k).name for k in range(model.nu)] == list(one_legged.JOINTS)
    assert model.nv == 6 + 4


def test_the_sole_stands_on_the_floor(model: mujoco.MjModel) -> None:
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    foot = model.geom("foot").id
    assert data.geom_xpos[foot, 2] - model.geom_size[foot, 0] == pytest.approx(0.0, abs=1e-12)
    assert data.xpos[model.body("base").id, 2] == pytest.approx(one_legged.LENGTH)


def test_what_is_derived_follows_from_the_tables() -> None:
    mass, (across, _, along) = TABLE_1["base"]
    assert 0.5 * mass * one_legged.RADIUS**2 == pytest.approx(along)
    assert mass * (3.0 * one_legged.RADIUS**2 + one_legged.HEIGHT**2) / 12.0 == pytest.approx(across)
    mass, (across, _, _) = TABLE_1["lower_leg"]
    rod = math.sqrt(12.0 * across / mass)  # the length of a thin uniform rod
    assert pytest.approx(rod / 2, abs=1e-3) == one_legged.LOWER_TO_FOOT


def in_flight(timestep_s: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Velocity of the centre of mass (2, 3), angular momentum (2, 3) about it and energy (2,) at the start and after
    0.5 s of a free flight in which body and leg turn against one another, short of all stops."""
    ground = build(np.zeros((1, 3)), heights=[10.0], timestep_s=timestep_s)
    model, data = ground.model, ground.data
    model.opt.enableflags |= int(mujoco.mjtEnableBit.mjENBL_ENERGY)
    data.qvel[:] = (1.0, -2.0, 3.0, 0.4, -0.6, 0.8, 0.5, -0.7, 1.0, -0.1)
    data.qpos[7:] = (0.1, -0.2, 0.3, 0.02)
    told = []
    for steps in (0, round(0.5 / timestep_s)):
        mujoco.mj_step(model, data, steps)
        assert data.nefc == 0, "it came to a stop of a joint, or to the ground"
        mujoco.mj_forward(model, data)
        mujoco.mj_subtreeVel(model, data)
        told.append((data.subtree_linvel[1].copy(), data.subtree_angmom[1].copy(), data.energy.sum()))
    velocity, turning, energy = (np.array(each) for each in zip(*told, strict=True))
    return velocity, turning, energy


def test_a_free_flight_keeps_momentum_and_energy() -> None:
    """Within the error of the integrator, which is of first order: it halves with the time step.

    In a fall it loses m g² h T / 2 of the energy in the time T, with h the time step. What turns and moves holds about
    190 J: a thousandth of it for the rest.
    """
    errors = []
    for timestep_s in (0.005, 0.0025, 0.00125):
        velocity, turning, energy = in_flight(timestep_s)
        np.testing.assert_allclose(velocity[1, :2], velocity[0, :2], rtol=1e-3)
        assert velocity[1, 2] == pytest.approx(velocity[0, 2] - 9.81 * 0.5, abs=2e-3)
        falling = one_legged.MASS * 9.81**2 * timestep_s * 0.5 / 2.0
        assert energy[1] - energy[0] == pytest.approx(-falling, abs=0.2 * timestep_s / 0.005)
        fallen = velocity[1] - velocity[0] + (0.0, 0.0, 9.81 * 0.5)
        errors.append((np.linalg.norm(turning[1] - turning[0]), np.linalg.norm(fallen)))
    for first, second in itertools.pairwise(errors):
        np.testing.assert_allclose(np.array(first) / second, 2.0, rtol=0.2)
