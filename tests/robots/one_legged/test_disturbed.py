"""Weak motors, noise, delay, pushes, slippery and uneven ground: a little is borne, a lot fells, off is off."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest

from flocking.errors import InputError
from robots.one_legged import model as one_legged
from robots.one_legged.control import Gains
from robots.one_legged.ground import FLAT, Ground, Surface, build
from robots.one_legged.imperfections import Imperfections
from robots.physics import DivergedError
from tests.robots.one_legged.running import heights, lined_up

COUNT = 4


def ran(
    imperfections: Imperfections = Imperfections(),  # noqa: B008 (immutable)
    surface: Surface = FLAT,
    seconds: float = 10.0,
    seed: int = 1,
) -> Ground:
    """Four robots after a run at 2 m/s; MuJoCo must not have warned."""
    rng = np.random.default_rng(seed)
    ground = build(lined_up(COUNT), heights(COUNT), imperfections=imperfections, surface=surface, rng=rng)
    ground.fleet.desire_all(np.tile([2.0, 0.0], (COUNT, 1)))
    ground.run(seconds)
    assert ground.data.warning.number.sum() == 0
    return ground


@pytest.mark.parametrize(
    ("little", "lot"),
    [
        (Imperfections(torque_n_m=20.0), Imperfections(torque_n_m=1.0)),
        (Imperfections(velocity_m_s=0.2), Imperfections(velocity_m_s=5.0)),
        (Imperfections(angle_rad=0.02), Imperfections(angle_rad=0.5)),
        (Imperfections(rate_rad_s=0.3), Imperfections(rate_rad_s=3.0)),
        (Imperfections(delay_s=0.005), Imperfections(delay_s=0.03)),
    ],
)
def test_a_little_is_borne_and_a_lot_fells(little: Imperfections, lot: Imperfections) -> None:
    """What was measured is in docs/one_legged.md: bounds here stand well to either side."""
    borne = ran(little)
    assert borne.fleet.upright.all()
    assert (borne.fleet.poses(borne.data)[:, 0] > 12.0).all()
    assert not ran(lot).fleet.upright.all()


def test_less_friction_than_the_stance_needs_fells() -> None:
    assert ran(surface=Surface(friction=0.5)).fleet.upright.all()
    assert not ran(surface=Surface(friction=0.05)).fleet.upright.any()


def test_uneven_ground_is_borne_up_to_a_few_centimetres() -> None:
    ground = ran(surface=Surface(uneven_m=0.03))
    assert ground.fleet.upright.all()
    field = ground.model.hfield_data
    spread = field.std() * ground.model.hfield_size[0, 2]
    assert spread == pytest.approx(0.03, rel=0.05)  # a few heights are cut off
    assert not ran(surface=Surface(uneven_m=0.25, bump_m=1.0)).fleet.upright.all()


def test_a_push_in_flight_changes_the_momentum_by_its_impulse() -> None:
    """Of the whole robot, that of its centre of mass; 20 N s."""
    grounds = [build(lined_up(1), [1.0]) for _ in range(2)]
    for ground in grounds:
        ground.step(10)
    grounds[1].fleet.push(grounds[1].data, 0, (12.0, -16.0, 0.0))
    velocities = []
    for ground in grounds:
        ground.step(10)
        mujoco.mj_subtreeVel(ground.model, ground.data)
        velocities.append(ground.data.subtree_linvel[1].copy())
    # the integrator's own error of the momentum is of the order of a thousandth (test_model)
    np.testing.assert_allclose((velocities[1] - velocities[0]) * one_legged.MASS, [12.0, -16.0, 0.0], atol=0.05)


def test_it_recovers_from_a_push_and_falls_after_a_hard_one() -> None:
    for impulse, stays in ((30.0, True), (300.0, False)):
        ground = ran(seconds=6.0)
        for k in range(COUNT):
            ground.fleet.push(ground.data, k, (0.0, impulse, 0.0))
        ground.run(6.0)
        assert ground.fleet.upright.all() == stays
        if stays:
            np.testing.assert_allclose(ground.fleet.velocities(ground.data), [[2.0, 0.0]] * COUNT, atol=0.2)


def test_off_is_off_and_noise_is_the_seeds() -> None:
    plain = ran(seconds=3.0).data.qpos
    np.testing.assert_array_equal(ran(seconds=3.0, seed=9).data.qpos, plain)
    noisy = Imperfections(velocity_m_s=0.1)
    first = ran(noisy, seconds=3.0).data.qpos
    np.testing.assert_array_equal(ran(noisy, seconds=3.0).data.qpos, first)
    assert np.abs(first - plain).max() > 1e-3
    assert np.abs(ran(noisy, seconds=3.0, seed=9).data.qpos - first).max() > 1e-3


def test_a_delay_reads_what_was() -> None:
    """The torques of the delayed controller are those of the prompt one, a step later, while both see the same."""
    prompt, late = (build(lined_up(1), [2.0], imperfections=Imperfections(delay_s=delay)) for delay in (0.0, 0.005))
    for ground in (prompt, late):
        ground.data.qvel[:2] = (0.5, 0.0)
        ground.fleet.before_step(ground.data)
    first = prompt.data.ctrl.copy()
    np.testing.assert_array_equal(late.data.ctrl, first)  # nothing older has been read yet
    late.data.qvel[:2] = (-0.5, 0.3)
    late.fleet.before_step(late.data)
    np.testing.assert_allclose(late.data.ctrl, first)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (Imperfections(torque_n_m=-1.0), "torque_n_m = -1.0: expected a number of at least 0"),
        (Imperfections(delay_s=math.nan), "delay_s = nan"),
        (Imperfections(delay_s=0.007), "expected a multiple of 0.005 s, such as 0.005"),
        (Imperfections(angle_rad=0.1), "noise without random numbers"),
    ],
)
def test_what_cannot_be_is_refused(given: Imperfections, told: str) -> None:
    with pytest.raises(InputError, match=told):
        build(lined_up(1), imperfections=given)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"attitude": math.nan}, "gain attitude = nan: expected a finite number"),
        ({"flight_s": -1.0}, "gain flight_s = -1.0: expected a finite number above 0"),
        ({"spring": 0.0}, "gain spring = 0.0"),
        ({"most_reach": 2.0}, "expected less than the leg's length"),
    ],
)
def test_gains_that_cannot_be_are_refused(change: dict[str, float], words: str) -> None:
    with pytest.raises(InputError, match=words):
        build(lined_up(1), heights(1), gains=Gains()._replace(**change))


def test_gains_that_make_it_fall_are_told_as_falls_and_those_that_end_physics_as_that() -> None:
    falling = build(lined_up(COUNT), heights(COUNT), gains=Gains(placement=-0.1))
    falling.fleet.desire_all(np.tile([2.0, 0.0], (COUNT, 1)))
    falling.run(6.0)
    assert not falling.fleet.upright.any()
    assert all(falling.fleet.causes)
    wild = build(lined_up(COUNT), heights(COUNT), gains=Gains(swing_damping=1e6))
    wild.fleet.desire_all(np.tile([3.5, 0.0], (COUNT, 1)))
    with pytest.raises(DivergedError, match="diverged"):
        wild.run(6.0)


def test_a_command_that_is_no_number_is_refused() -> None:
    ground = build(lined_up(COUNT), heights(COUNT))
    with pytest.raises(ValueError, match="finite"):
        ground.fleet.desire_all(np.full((COUNT, 2), np.nan))
