"""The contract's side of the fleet: commands in the robot's axes, odometry, what is refused."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest

from flocking.errors import InputError
from robots import body as bodies
from robots.fleets import fallen_at, fleet_of
from robots.one_legged.fleet import Fleet
from robots.one_legged.ground import Surface, build, specification
from robots.physics import apply_options
from tests.robots.one_legged.running import lined_up


def test_a_command_is_in_the_robots_own_axes() -> None:
    ground = build(lined_up(1, heading=0.5))
    ground.fleet.command(0, 1.0, 0.0)
    np.testing.assert_allclose(ground.fleet.desired[0], [math.cos(0.5), math.sin(0.5)])
    ground.fleet.command(0, 0.0, 2.0)
    np.testing.assert_allclose(ground.fleet.desired[0], [-2.0 * math.sin(0.5), 2.0 * math.cos(0.5)])


def test_what_it_knows_of_its_way_is_nearly_true() -> None:
    """By its leg in stance within 10 % (docs/one_legged.md: it counts about 5 % too little), by its commands too."""
    ground = build(lined_up(2, heading=0.5))
    fleet, data = ground.fleet, ground.data
    fleet.command(0, 1.5, 0.0)
    fleet.command(1, 1.0, -1.0)
    start = fleet.poses(data)
    ground.run(20.0)
    x, y = (fleet.poses(data) - start)[:, :2].T
    c, s = math.cos(0.5), math.sin(0.5)
    way = np.column_stack([c * x + s * y, c * y - s * x])
    far, motion = np.hypot(*way.T), np.empty(3)
    assert (np.hypot(*(fleet.odometry[:, :2] - way).T) < 0.1 * far).all()
    np.testing.assert_allclose(fleet.odometry[:, 2], [0.0, -math.pi / 4], atol=0.05)
    fleet.meant(1, motion)
    assert np.hypot(*(fleet.meant_pose(1)[:2] - way[1])) < 0.1 * far[1]
    assert fleet.meant_pose(1)[2] == pytest.approx(-math.pi / 4)
    contacts = np.ones(2, dtype=np.bool_)
    fleet.own(0, motion, contacts)
    assert motion[0] == pytest.approx(far[0] / 20.0, rel=0.1)
    assert not contacts.any()
    assert not fleet.bumpers.any()
    before = motion.copy()
    fleet.own(0, motion, contacts)  # no time has gone by
    np.testing.assert_array_equal(motion, before)


def test_a_wall_is_felt_and_a_robot_of_another_kind_is_met() -> None:
    spec = specification(lined_up(1))
    mask = {"contype": 2, "conaffinity": 2}
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=(0.1, 5.0, 0.25), pos=(2.0, 0.0, 0.25), **mask)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    fleet = Fleet(model, ["0/"])
    fleet.desire(0, 1.0, 0.0)
    pressed = False
    for _ in range(1000):
        fleet.before_step(data)
        mujoco.mj_step(model, data)
        pressed |= fleet.after_step(data)
    assert pressed
    assert fleet.poses(data)[0, 0] < 2.0


def test_who_has_fallen_is_told_among_robots_of_several_kinds() -> None:
    spec = mujoco.MjSpec()
    spec.copy_during_attach = True
    apply_options(spec, 0.005)
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=(0, 0, 1), contype=1, conaffinity=0)
    kinds = [bodies.load(name) for name in ("one-legged", "create", "one-legged")]
    for k, kind in enumerate(kinds):
        spec.attach(kind.spec(), prefix=f"{k}/", frame=spec.worldbody.add_frame(pos=(0.0, 2.0 * k, 0.0)))
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    fleet = fleet_of(model, kinds, ["0/", "1/", "2/"])
    np.testing.assert_array_equal(fallen_at(fleet), [math.nan] * 3)
    for step in range(800):
        fleet.before_step(data)
        data.xfrc_applied[fleet.root_bodies[2], 0] = 4000.0 if step == 200 else 0.0  # for 5 ms: nearly 1 m/s
        data.xfrc_applied[fleet.root_bodies[2], 4] = 4000.0 if step == 200 else 0.0
        mujoco.mj_step(model, data)
        fleet.after_step(data)
    fallen = fallen_at(fleet)
    assert fallen is not None
    np.testing.assert_array_equal(np.isfinite(fallen), [False, False, True])
    assert 1.0 < fallen[2] < 4.0
    create = fleet_of(model, [kinds[1]], ["1/"])
    assert fallen_at(create) is None


def test_what_is_no_such_robot_or_too_long_a_step_is_refused() -> None:
    spec = specification(lined_up(1))
    with pytest.raises(InputError, match="no one-legged robot with prefix '7/'"):
        Fleet(spec.compile(), ["7/"])
    spec.option.timestep = 0.01
    with pytest.raises(InputError, match=r"time step 0\.01 s: expected at most 0\.005 s"):
        Fleet(spec.compile(), ["0/"])


def test_what_cannot_be_of_a_ground_is_refused() -> None:
    with pytest.raises(InputError, match=r"poses of shape \(3,\): expected finite ones of shape \(N, 3\)"):
        build(np.zeros(3))
    with pytest.raises(InputError, match=r"heights of shape \(1,\): expected 2"):
        build(lined_up(2), [0.1])
    with pytest.raises(InputError, match="surface friction = -1"):
        build(lined_up(1), surface=Surface(friction=-1.0))
    with pytest.raises(InputError, match="uneven ground without random numbers"):
        build(lined_up(1), surface=Surface(uneven_m=0.02))
