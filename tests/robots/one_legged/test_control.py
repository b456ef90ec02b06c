"""The three parts of the control, each against a closed form or an oracle of its own."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest

from robots.one_legged import control, controller
from robots.one_legged import model as one_legged
from robots.one_legged.control import Gains

RNG = np.random.default_rng(3)
TURNS = [quaternion / np.linalg.norm(quaternion) for quaternion in RNG.normal(size=(8, 4))]


@pytest.mark.parametrize("flight_s", [0.1, 0.34, 0.6])
def test_thrust_gives_the_flight_that_is_wanted(flight_s: float) -> None:
    """A mass on a spring, integrated from the bottom in fine steps, leaves it with g T / 2."""
    mass, spring = 24.5, 16000.0
    short, speed, step = control.thrust(mass, spring, flight_s, 1.0), 0.0, 1e-6
    while short > 0.0:
        speed += (spring * short / mass - 9.81) * step
        short -= speed * step
    assert 2.0 * speed / 9.81 == pytest.approx(flight_s, rel=1e-3)  # the integration's error


def test_thrust_grows_with_what_is_lost() -> None:
    assert control.thrust(24.5, 16000.0, 0.34, 1.2) > control.thrust(24.5, 16000.0, 0.34, 1.0)


def test_the_trim_answers_a_flight_that_was_too_short_by_more_energy_within_bounds() -> None:
    assert control.trimmed(1.0, 0.1, 0.30, 0.34) == pytest.approx(1.0 + 0.1 * 0.04 / 0.34)
    assert control.trimmed(1.0, 0.1, 0.34, 0.34) == 1.0
    assert control.trimmed(1.99, 0.1, 0.0, 0.34) == 2.0
    assert control.trimmed(0.51, 1.0, 0.68, 0.34) == 0.5


def test_the_foot_goes_to_the_middle_of_the_way_of_a_stance() -> None:
    """At the speed that is wanted; nearer to the hip to go faster, further out to go slower (section 4.1)."""

    def place(wanted: float) -> float:
        return control.foot_place(2.0, 0.0, wanted, 0.0, 0.14, 0.1, 0.5, 0.45)[0]

    assert place(2.0) == pytest.approx(0.14)
    assert place(2.2) == pytest.approx(0.14 - 0.02)
    assert place(1.8) == pytest.approx(0.14 + 0.02)
    assert place(-9.0) == pytest.approx(0.14 + 0.05)  # the error that counts is limited


def test_the_foots_place_turns_with_the_velocities_and_stays_in_reach() -> None:
    for angle in RNG.uniform(-math.pi, math.pi, 20):
        turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        v, wanted = RNG.normal(0.0, 3.0, (2, 2))
        first = control.foot_place(*v, *wanted, 0.14, 0.1, 0.5, 0.3)
        second = control.foot_place(*(turn @ v), *(turn @ wanted), 0.14, 0.1, 0.5, 0.3)
        np.testing.assert_allclose(turn @ first, second, atol=1e-12)
        assert math.hypot(*first) <= 0.3 + 1e-12


@pytest.mark.parametrize("quaternion", TURNS)
def test_rotations_are_mujocos(quaternion: np.ndarray) -> None:
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, quaternion)
    turn = control.rotation(*quaternion)
    np.testing.assert_allclose(turn, matrix, atol=1e-12)
    vector = RNG.normal(size=3)
    np.testing.assert_allclose(control.to_world(turn, *vector), matrix.reshape(3, 3) @ vector, atol=1e-12)
    np.testing.assert_allclose(control.to_body(turn, *control.to_world(turn, *vector)), vector, atol=1e-12)


def posed() -> tuple[mujoco.MjModel, mujoco.MjData]:
    """The robot at any angles of its hip."""
    model = one_legged.spec().compile()
    data = mujoco.MjData(model)
    data.qpos[7:] = (0.4, -0.7, 0.3, 0.05)
    mujoco.mj_forward(model, data)
    return model, data


def test_the_legs_direction_is_that_of_the_model() -> None:
    model, data = posed()
    away = data.xpos[model.body("base").id] - data.geom_xpos[model.geom("foot").id]
    direction = control.leg_direction(*data.qpos[7:9])
    np.testing.assert_allclose(direction, away / np.linalg.norm(away), atol=1e-12)
    assert control.hip_angles(*direction) == pytest.approx(tuple(data.qpos[7:9]))


def test_hip_torques_put_the_opposite_on_the_leg() -> None:
    """The component about each hinge's axis as MuJoCo has it, in a body that stands straight."""
    model, data = posed()
    wanted = RNG.normal(0.0, 20.0, 3)
    axes = [data.xaxis[model.joint(name).id] for name in one_legged.JOINTS[:3]]
    expected = [-axis @ wanted for axis in axes]
    np.testing.assert_allclose(control.hip_torques(*data.qpos[7:9], *wanted), expected, atol=1e-12)


def test_the_bodys_reaction_is_the_torque_that_was_asked_for() -> None:
    """Without gravity, and against the leg held in place: the body starts to turn by the torque over its inertia."""
    model, data = posed()
    model.opt.gravity[:] = 0.0
    for leg in ("upper_leg", "lower_leg"):  # so heavy that it stays
        model.body(leg).mass *= 1e9
        model.body(leg).inertia *= 1e9
    mujoco.mj_setConst(model, mujoco.MjData(model))
    wanted = np.array([3.0, -2.0, 1.0])
    data.ctrl[:3] = control.hip_torques(*data.qpos[7:9], *wanted)
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(data.qacc[3:6], wanted / one_legged.BODY_INERTIA, rtol=1e-5)


@pytest.mark.parametrize(("axis", "component"), [(0, 0), (1, 1)])
def test_a_body_that_leans_is_turned_back(axis: int, component: int) -> None:
    lean = 0.2
    quaternion = np.zeros(4)
    quaternion[0], quaternion[1 + axis] = math.cos(lean / 2), math.sin(lean / 2)
    turn = control.rotation(*quaternion)
    torque = control.upright_torque(turn, 0.0, 0.0, 200.0, 50.0, math.inf)
    assert torque[component] == pytest.approx(-200.0 * math.sin(lean))
    assert torque[1 - component] == pytest.approx(0.0, abs=1e-12)
    assert control.upright_torque(turn, 0.0, 0.0, 200.0, 50.0, 5.0)[component] == pytest.approx(-5.0)


def test_an_upright_body_gets_damping_alone_whatever_its_heading() -> None:
    for heading in (0.0, 1.0, 3.0):
        turn = control.rotation(math.cos(heading / 2), 0.0, 0.0, math.sin(heading / 2))
        assert control.upright_torque(turn, 0.1, -0.2, 200.0, 50.0, math.inf) == pytest.approx((-5.0, 10.0))


def test_yaw_is_limited_by_the_feet_s_grip() -> None:
    assert control.yaw_torque(0.1, 0.5, 60.0, 4.0, 10.0) == pytest.approx(4.0)
    assert control.yaw_torque(1.0, 0.0, 60.0, 4.0, 10.0) == 10.0
    assert control.yaw_torque(-1.0, 0.0, 60.0, 4.0, 10.0) == -10.0


def test_the_gains_ask_no_more_of_the_foot_than_its_friction() -> None:
    gains = Gains()
    assert gains.grip < one_legged.FOOT_FRICTION
    assert gains.yaw_grip < one_legged.FOOT_TORSION


@pytest.mark.parametrize(
    ("kind", "x", "y", "expected"),
    [
        (0, math.nan, math.nan, (math.hypot(1.0, 0.5), 0.0)),  # hold: as fast as now
        (1, math.nan, math.nan, (0.0, 0.0)),  # stop
        (2, 3.0, 4.0, (0.6 * 1.5, 0.8 * 1.5)),  # way-point: at the cruise speed
        (2, 0.3, 0.4, (0.3, 0.4)),  # nearer, slower
        (2, 0.05, 0.0, (0.0, 0.0)),  # there
        (3, -1.0, 2.0, (-1.0, 2.0)),  # velocity, in any direction
        (3, 0.0, 7.0, (0.0, controller.MAX_SPEED)),
        (4, math.pi / 2, 1.2, (0.0, 1.2)),  # heading
        (5, 2.0, -1.0, (1.2, 0.4)),  # acceleration, over a tenth of a second
    ],
)
def test_what_a_motion_means(kind: int, x: float, y: float, expected: tuple[float, float]) -> None:
    assert controller.follow(kind, x, y, 1.5, 1.0, 0.5, 0.1) == pytest.approx(expected, abs=1e-12)
