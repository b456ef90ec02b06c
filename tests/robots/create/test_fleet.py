"""All Creates of a world through one object."""

import math

import mujoco
import numpy as np
import pytest

from flocking.errors import InputError
from robots import physics
from robots.create import drive
from robots.create import model as create
from robots.create.fleet import Fleet

GEAR = create.DIMENSIONS.gear


def test_each_robot_obeys_its_own_commands(build):
    arena = build((0.0, 0.0, 0.0), (0.0, 2.0, math.pi / 2), (3.0, -2.0, math.pi))
    fleet = arena.fleet
    fleet.command(0, 0.2, 0.0)
    fleet.command(1, 0.0, 1.5)
    arena.run(2.0)
    speeds = fleet.velocities(arena.data)
    np.testing.assert_allclose(speeds, [(0.2, 0.0), (0.0, 0.0), (0.0, 0.0)], atol=2e-3)
    rates = [arena.data.qvel[arena.model.joint(f"{k}/root").dofadr[0] + 5] for k in range(3)]
    np.testing.assert_allclose(rates, (0.0, 1.5, 0.0), atol=0.02)
    np.testing.assert_allclose(fleet.odometry[2], 0.0)
    fleet.stop(0)
    arena.run(1.0)
    assert np.abs(fleet.velocities(arena.data)[0]).max() < 1e-3


def test_poses_are_those_of_the_state(build):
    starts = ((0.0, 0.0, 0.3), (1.0, -2.0, -3.0), (-4.0, 2.0, 3.1))
    arena = build(*starts)
    np.testing.assert_allclose(arena.fleet.poses(arena.data), starts, atol=1e-12)
    bodies = [arena.model.body(b).name for b in arena.fleet.root_bodies]
    assert bodies == ["0/base", "1/base", "2/base"]


def test_commands_pass_through_the_drive_command(build):
    """What a radius in whole mm cannot say is not driven: wheel targets are those of the nearest command."""
    arena = build()
    speed, turn_rate = 0.1234, 0.1234 / 3.1  # R = 3.1 m: beyond the Open Interface
    arena.fleet.command(0, speed, turn_rate)
    arena.run(3.0)
    left, right = drive.wheel_speeds(GEAR, *drive.meant(GEAR, 123, 2000))
    np.testing.assert_allclose(arena.data.ctrl * create.WHEEL_RADIUS, (left, right), rtol=1e-12)


def test_too_fast_keeps_the_radius(build):
    arena = build()
    arena.fleet.command(0, 2.0, 4.0)  # R = 0.5 m at four times what the wheels can
    arena.run(2.0)
    speed, turn_rate = drive.twist(GEAR, *(arena.data.ctrl * create.WHEEL_RADIUS))
    assert max(arena.data.ctrl) * create.WHEEL_RADIUS <= create.MAX_SPEED + 1e-12
    assert speed / turn_rate == pytest.approx(0.5, rel=0.01)  # whole mm and mm/s


def test_velocity_is_the_mean_since_last_asked(build):
    arena = build()
    fleet = arena.fleet
    assert fleet.velocity(0) == (0.0, 0.0)
    fleet.command(0, 0.4, 0.0)  # 6 mm a request: nothing lost once it runs
    arena.run(1.5)
    fleet.velocity(0)
    arena.run(0.6)
    first = fleet.velocity(0)
    assert first == (pytest.approx(0.4, rel=0.001 / 0.006), 0.0)
    assert fleet.velocity(0) == first  # no request in between: the last answer
    arena.run(0.3)
    fleet.command(0, 0.0, 0.0)
    arena.run(1.0)
    fleet.velocity(0)
    arena.run(0.5)
    assert fleet.velocity(0) == (0.0, 0.0)


def test_set_points_tell_of_slow_turns_that_the_encoders_lose(build):
    """30 degrees/s reads as no turn at all in whole degrees a request; the drive commands know of it."""
    arena = build((0.5, -1.0, 0.7))
    fleet, motion = arena.fleet, np.empty(3)
    fleet.command(0, 0.2, math.radians(30.0))
    for _ in range(20):
        arena.run(0.1)
        fleet.meant(0, motion)
    assert fleet.counted_pose(0)[2] == 0.0
    # the wheels follow their set-points within about 40 ms, in which they turn by 1.2 degrees and go 8 mm
    x, y, heading = fleet.meant_pose(0)
    assert heading == pytest.approx(arena.pose()[2] - 0.7, abs=math.radians(2.0))
    went = arena.pose()[:2] - (0.5, -1.0)
    c, s = math.cos(0.7), math.sin(0.7)
    np.testing.assert_allclose((c * x - s * y, s * x + c * y), went, atol=0.02)
    # steady: what the nearest drive command means
    speed, turn_rate = drive.meant(GEAR, *drive.nearest_command(GEAR, 0.2, math.radians(30.0)))
    np.testing.assert_allclose(motion, (speed, 0.0, turn_rate), atol=1e-12)
    fleet.meant(0, motion)  # no step in between: the last answer
    assert motion[0] == pytest.approx(speed)


def test_polling_instants_do_not_depend_on_the_timestep(build):
    """Wheel angles are read between steps: 15 ms requests from 10 ms steps see what those from 3 ms steps see."""
    ends = []
    for step in (0.01, 0.003):
        arena = build(timestep_s=step)
        arena.fleet.command(0, 0.4, 0.0)
        arena.run(3.0)
        ends.append(arena.fleet.odometry[0, 0])
    # The ramps' requests may differ by a unit each (0.44 s, 15 ms): in practice a few.
    assert ends[0] == pytest.approx(ends[1], abs=0.012)


def test_slower_polling_loses_less(build):
    """Polling every 0.2 s (5 Hz, as Player's driver): 0.25 m/s are 50 mm a request, nearly all of it seen."""
    arena = build()
    slow = Fleet(arena.model, ["0/"], polling_s=0.2)
    slow.command(0, 0.25, 0.0)
    for _ in range(600):
        slow.before_step(arena.data)
        mujoco.mj_step(arena.model, arena.data)
        slow.after_step(arena.data)
    # At most a millimetre lost each of 30 requests.
    assert 0.0 <= arena.pose()[0] - slow.odometry[0, 0] < 0.031


def test_the_same_commands_give_the_same_motion(build):
    """Bit for bit."""
    ends = []
    for _ in range(2):
        arena = build((0.0, 0.0, 0.1), (0.9, 0.05, 3.0))
        arena.fleet.command(0, 0.4, 0.3)
        arena.fleet.command(1, 0.3, -0.2)
        arena.run(4.0)
        ends.append(np.concatenate([arena.data.qpos, arena.fleet.odometry.ravel()]))
    np.testing.assert_array_equal(*ends)


def test_unknown_robots_are_named():
    spec = mujoco.MjSpec()
    physics.apply_options(spec)
    spec.attach(create.spec(), prefix="a/", frame=spec.worldbody.add_frame())
    model = spec.compile()
    with pytest.raises(InputError, match="'b/'"):
        Fleet(model, ["a/", "b/"])
    with pytest.raises(InputError, match="polling_s"):
        Fleet(model, ["a/"], polling_s=0.0)


def test_commands_must_be_finite(build):
    arena = build()
    with pytest.raises(ValueError, match="finite"):
        arena.fleet.command(0, math.nan, 0.0)
    with pytest.raises(ValueError, match="finite"):
        arena.fleet.command(0, 0.1, math.inf)
