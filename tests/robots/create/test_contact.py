"""Walls and other robots: stalling, pushing, bumpers."""

import math

import mujoco
import numpy as np
import pytest

from robots.create import bumpers, model
from robots.create.model import RADIUS

WALL = (1.5, 0.0, 0.5, 5.0)
"""Its face stands at x = 1."""


def with_touch_sensors(spec: mujoco.MjSpec) -> None:
    """Adds MuJoCo's own touch sensors to all bumpers' zones."""
    for site in spec.sites:
        if "bumper" in site.name:
            kind, of = mujoco.mjtSensor.mjSENS_TOUCH, mujoco.mjtObj.mjOBJ_SITE
            spec.add_sensor(name=site.name, type=kind, objtype=of, objname=site.name)


def depth(arena):
    """How deep the outline stands in the wall, m."""
    return arena.data.qpos[0] + RADIUS - (WALL[0] - WALL[2])


@pytest.mark.parametrize("phase", np.linspace(0, 1, 8, endpoint=False))
def test_ramming_a_wall_at_full_speed_stays_out_of_it(build, phase):
    """Aim: less than 2 mm, no warning (the arena asserts that). A step covers 5 mm: every phase of it is tried."""
    arena = build((0.4 - 5e-3 * phase, 0.0, 0.0), walls=[WALL])
    arena.fleet.command(0, 0.5, 0.0)
    depths = []
    arena.run(4.0, watch=lambda: depths.append(depth(arena)))
    assert max(depths) < 2e-3


def test_pushing_a_wall_stalls_and_the_odometry_does_not_see_it(build):
    """The robot stands while its wheels slip and its odometry drives on.

    The servo's torque is in proportion to its error: commanded below about 0.2 m/s it would stall without slipping.
    """
    arena = build((0.7, 0.0, 0.0), walls=[WALL], change=with_touch_sensors)
    arena.fleet.command(0, 0.5, 0.0)
    arena.run(2.0)
    arena.fleet.velocity(0)
    start, seen, depths, tilts, forces = arena.pose(), arena.fleet.odometry[0, 0], [], [], []

    def watch():
        depths.append(depth(arena))
        tilts.append(2 * np.hypot(*arena.data.qpos[4:6]))
        forces.append(arena.data.sensordata.copy())

    arena.run(5.0, watch)
    moved = arena.pose() - start
    assert np.abs(moved[:2]).max() < 2e-3
    assert abs(moved[2]) < math.radians(1)
    assert -0.006 < min(depths) < max(depths) < 2e-3
    assert max(tilts) < math.radians(1.5)
    # Mean push: the tyres' grip (they carry about 93 % of the weight, more or less as the nose lifts); 25 % for hops.
    mass = arena.model.body_subtreemass[1]
    assert np.mean(forces, axis=0)[0] == pytest.approx(0.93 * model.TYRE_FRICTION * mass * 9.81, rel=0.25)
    assert arena.fleet.velocity(0)[0] > 0.05
    assert arena.fleet.odometry[0, 0] - seen > 0.25


def test_a_slippery_floor_slips(build):
    """With a third of the grip the same push is a third: the limit is friction, not the motor."""

    def ice(spec: mujoco.MjSpec) -> None:
        with_touch_sensors(spec)
        for geom in spec.geoms:
            if geom.name.endswith("_tyre"):
                geom.friction = (model.TYRE_FRICTION / 3, 0, 0)

    pushes = []
    for change in (with_touch_sensors, ice):
        arena = build((0.7, 0.0, 0.0), walls=[WALL], change=change)
        arena.fleet.command(0, 0.4, 0.0)
        arena.run(2.0)
        forces: list[float] = []
        arena.run(3.0, watch=lambda a=arena, f=forces: f.append(a.data.sensordata[0]))
        pushes.append(np.mean(forces))
    assert pushes[1] == pytest.approx(pushes[0] / 3, rel=0.25)


@pytest.mark.parametrize("offset", [0.0, 0.1, 0.25])
def test_two_robots_that_meet_at_full_speed_do_not_enter_each_other(build, offset):
    """1 m/s between them is 10 mm a step, of which the two bumpers' give takes 8: 3 mm here, in all phases."""
    for phase in np.linspace(0, 1, 5, endpoint=False):
        arena = build((0.0, 0.0, 0.0), (1.4 + 0.01 * phase, offset, math.pi))
        arena.fleet.command(0, 0.5, 0.0)
        arena.fleet.command(1, 0.5, 0.0)
        distances, speeds = [], []

        def watch(arena=arena, distances=distances, speeds=speeds):
            poses = arena.fleet.poses(arena.data)
            distances.append(np.hypot(*(poses[0, :2] - poses[1, :2])))
            speeds.append(np.abs(arena.fleet.velocities(arena.data)).max())

        arena.run(3.0, watch)
        assert min(distances) > 2 * RADIUS - 3e-3
        assert max(speeds) < 0.6  # nothing explodes


def test_a_robot_pushes_another_along(build):
    arena = build((0.0, 0.0, 0.0), (0.5, 0.0, math.pi / 2))
    arena.fleet.command(0, 0.2, 0.0)
    arena.run(5.0)
    poses = arena.fleet.poses(arena.data)
    # Sideways the pushed one's tyres must slide: the pusher's grip is the same, so it need not get far.
    assert np.hypot(*(poses[0, :2] - poses[1, :2])) > 2 * RADIUS - 1e-3
    assert poses[0, 0] < 0.5


@pytest.mark.parametrize(
    ("bearing_deg", "expected"),
    [
        (0, (True, True)),
        (45, (True, False)),
        (-45, (False, True)),
        (8, (True, True)),
        (80, (True, False)),
        (120, (False, False)),
        (180, (False, False)),
    ],
)
def test_bumpers_tell_the_side(build, bearing_deg, expected):
    """A wall at that bearing, touched by pressing against it for a moment."""
    heading = -math.radians(bearing_deg)
    arena = build((1.0 - RADIUS + 0.0015, 0.0, heading), walls=[WALL])
    arena.run(0.02)
    np.testing.assert_array_equal(arena.fleet.take_contacts(0), expected)


@pytest.mark.parametrize("seed", range(4))
def test_switches_feel_what_mujocos_touch_sensors_feel(build, seed):
    """Six robots driven about in a narrow pen: at every step and on every side the same force, by two ways."""
    rng = np.random.default_rng(seed)
    pen = [(0.0, 1.0, 1.0, 0.1), (0.0, -1.0, 1.0, 0.1), (1.0, 0.0, 0.1, 1.0), (-1.0, 0.0, 0.1, 1.0)]
    starts = [(x, y, rng.uniform(-math.pi, math.pi)) for x in (-0.5, 0.0, 0.5) for y in (-0.35, 0.35)]
    arena = build(*starts, walls=pen, change=with_touch_sensors)
    felt = []

    def watch():
        felt.append(arena.data.sensordata.reshape(6, 2).copy())
        np.testing.assert_allclose(arena.fleet.pressing, felt[-1], rtol=1e-12, atol=1e-12)  # sums in the same order
        np.testing.assert_array_equal(arena.fleet.bumpers, felt[-1] > bumpers.FORCE)

    for _ in range(10):
        for k in range(6):
            arena.fleet.command(k, rng.uniform(-0.1, 0.5), rng.uniform(-2.0, 2.0))
        arena.run(1.0, watch)
    pressed = np.array(felt) > bumpers.FORCE
    assert (pressed[..., 0] & ~pressed[..., 1]).any()  # a bumper was pressed alone,
    assert pressed.all(axis=2).any()  # and both at once


def test_contacts_are_latched_until_taken(build):
    arena = build((0.8, 0.0, 0.0), walls=[WALL])
    fleet = arena.fleet
    assert not fleet.take_contacts(0).any()
    fleet.command(0, 0.2, 0.0)
    arena.run(1.0)
    fleet.command(0, -0.2, 0.0)
    arena.run(1.5)
    assert not fleet.bumpers.any()
    assert fleet.take_contacts(0).all()
    assert not fleet.take_contacts(0).any()


def test_wheels_and_casters_touch_walls_as_little_as_hulls_touch_the_floor(build):
    """Contacts in a world of a robot at a wall: the running gear with the floor, the hull with the wall."""
    arena = build((1.0 - RADIUS, 0.0, 0.0), walls=[WALL])
    names = arena.model.geom
    pairs = {tuple(sorted((names(c.geom1).name, names(c.geom2).name))) for c in arena.data.contact}
    assert pairs <= {("0/front_caster", "floor"), ("0/left_tyre", "floor"), ("0/right_tyre", "floor"), ("", "0/hull")}
    assert ("", "0/hull") in pairs
