"""The evidence for the physics time step: motion, odometry and scans against half of it, contact against 1 ms.

Six robots drive the same scripted commands (no feedback, so that nothing amplifies a difference), and the worlds are
compared after five seconds of ramps, arcs, turns in place and stops. Others drive against walls and one another for
fifteen seconds.
"""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import mujoco
import numpy as np
import pytest

from flocking.types import Floats
from robots import body as bodies
from robots.create import model as create
from sensing.laser.draws import range_draws
from sensing.laser.hokuyo import SETTINGS, Lasers
from trials.simulations.robots import fields
from worlds import assemble

SCRIPT = ((0.0, 0.4, 0.0), (1.0, 0.25, 0.8), (2.2, 0.0, -1.5), (3.4, 0.3, -0.5), (4.6, 0.0, 0.0))
"""Time (s), speed (m/s), turn rate (rad/s); the robots take turns at being mirrored."""
SECONDS = 5.0
POSITION = 2e-3
"""m; a fifteenth of the laser's noise. Measured: 0.6 mm between 10 and 5 ms."""
HEADING = 2e-3
"""rad; a third of the angle between two beams. Measured: 0.9e-3."""
ODOMETRY_MM = 5.0
"""A request of 15 ms is truncated to 1 mm; both runs may truncate differently where a ramp crosses a whole mm."""


class Outcome(NamedTuple):
    """What is compared of one run."""

    poses_w: Floats
    odometry: Floats
    ranges: Floats


@cache
def driven(timestep: float) -> Outcome:
    poses_w = np.array([[1.4 * k - 3.5, 0.3 * (-1) ** k, 0.0] for k in range(6)])
    names = [f"herd-{k + 1}" for k in range(6)]
    world = assemble.build("corridor", {"width_m": 6.0}, ["create"] * 6, names, poses_w, timestep)
    for time, speed, turn_rate in SCRIPT:
        world.advance(to=round(time / timestep))
        for k in range(6):
            world.fleet.command(k, speed, turn_rate * (-1) ** k)
    world.advance(to=round(SECONDS / timestep))
    roots = [int(root) for root in world.fleet.root_bodies]
    lasers = Lasers(world.whole, [f"{name}/laser" for name in names], roots, [SETTINGS["ideal"]] * 6)
    draws = range_draws(np.random.default_rng(0))
    ranges = [lasers.read(world.data, k, world.data.time, draws)[0].ranges for k in range(6)]
    return Outcome(world.fleet.poses(world.data), world.fleet.odometry, np.array(ranges))


def chosen() -> float:
    return fields.TrialFields().timestep_s


def test_robots_move_and_see_one_another_in_the_script() -> None:
    outcome = driven(chosen())
    assert np.ptp(outcome.poses_w[:, 0]) > 5.0
    assert np.isfinite(outcome.ranges).mean() > 0.2


def test_motion_is_that_of_half_the_time_step() -> None:
    difference = np.abs(driven(chosen()).poses_w - driven(chosen() / 2).poses_w)
    assert difference[:, :2].max() < POSITION
    assert difference[:, 2].max() < HEADING


def test_odometry_is_that_of_half_the_time_step() -> None:
    difference = np.abs(driven(chosen()).odometry - driven(chosen() / 2).odometry)
    assert difference[:, :2].max() < ODOMETRY_MM / 1000


def test_scans_are_those_of_half_the_time_step() -> None:
    first, second = driven(chosen()).ranges, driven(chosen() / 2).ranges
    both = np.isfinite(first) & np.isfinite(second)
    # beams that graze an edge may hit in one run and miss in the other: below one in a hundred
    assert np.mean(np.isfinite(first) != np.isfinite(second)) < 0.01
    difference = np.abs(first[both] - second[both])
    assert np.median(difference) < POSITION
    assert np.mean(difference > 0.01) < 0.02


FINE = 0.001
"""s; a tenth of the default step: slips, slides and turns agree between it and 2 ms to 0.2 mm and 0.1 degrees."""
CONTACT_SECONDS = 15.0
SLIDE = 0.01
"""m. Measured: 0.4 mm at walls, 2 mm of a robot that is pushed."""
TURN = math.radians(2.0)
"""rad. Measured: 0.03 degrees at walls, 0.1 of two Creates and 0.9 of two small ones that push one another."""
STALL_ODOMETRY = 0.02
"""m in fifteen seconds, by wheels that slip. Measured: 3 mm."""
ROLLING = [name for name in bodies.names() if math.isinf(bodies.load(name).longest_timestep)]
"""Those that roll; one that hops has a step of its own (tests/robots/one_legged)."""
APART = 3.0
"""m along the corridor from one case to the next: none meets another."""


class Touch(NamedTuple):
    """Robots that drive against a wall or one another; x is counted from the case's own place."""

    name: str
    poses_w: tuple[tuple[float, float, float], ...]
    speeds: tuple[float, ...]


def touches(kind: str) -> list[Touch]:
    """Of a kind of robot, in a corridor whose wall stands at y = 1.155 m."""
    radius = bodies.load(kind).radius
    wall = 1.155 - radius - 0.1
    right = math.pi / 2
    pair = ((0.0, 0.0, 0.0), (2 * radius + 0.1, 0.05, math.pi))
    return [
        Touch("stall", ((0.0, wall, right),), (0.25,)),
        Touch("slow stall", ((0.0, wall, right),), (0.1,)),
        Touch("full stall", ((0.0, wall, right),), (bodies.load(kind).top_speed,)),
        Touch("slide at 30 degrees", ((0.0, wall, right - math.radians(30.0)),), (0.25,)),
        Touch("slide at 60 degrees", ((0.0, wall, right - math.radians(60.0)),), (0.25,)),
        Touch("push one another", pair, (0.25, 0.25)),
        Touch("push aside", (pair[0], (*pair[1][:2], right)), (0.15, 0.0)),
    ]


class Touched(NamedTuple):
    """Of the robots of one case, after all of it; rows as in `Touch`."""

    poses_w: Floats
    odometry: Floats


@cache
def pressed(kind: str, timestep: float) -> dict[str, Touched]:
    """How each case ends."""
    cases = touches(kind)
    starts = [(APART * (k - len(cases) / 2) + x, y, h) for k, case in enumerate(cases) for x, y, h in case.poses_w]
    names = [f"r{k}" for k in range(len(starts))]
    world = assemble.build("corridor", {}, [kind] * len(starts), names, np.array(starts), timestep)
    for k, speed in enumerate(speed for case in cases for speed in case.speeds):
        world.fleet.command(k, speed, 0.0)
    world.advance(to=round(CONTACT_SECONDS / timestep))
    poses_w, odometry = world.fleet.poses(world.data), world.fleet.odometry
    ends = np.cumsum([len(case.speeds) for case in cases])
    parts = zip(cases, np.split(poses_w, ends[:-1]), np.split(odometry, ends[:-1]), strict=True)
    return {case.name: Touched(poses, counted) for case, poses, counted in parts}


@pytest.mark.parametrize("kind", ROLLING)
@pytest.mark.parametrize("case", [case.name for case in touches("create")])
def test_contact_is_that_of_a_millisecond(kind: str, case: str) -> None:
    coarse, fine = pressed(kind, chosen())[case], pressed(kind, FINE)[case]
    apart = coarse.poses_w - fine.poses_w
    assert np.hypot(*apart[:, :2].T).max() < SLIDE
    assert np.abs(np.arctan2(np.sin(apart[:, 2]), np.cos(apart[:, 2]))).max() < TURN
    if "stall" in case:
        assert np.abs(coarse.odometry - fine.odometry).max() < STALL_ODOMETRY


@pytest.mark.parametrize("kind", ROLLING)
def test_the_cases_touch_slide_and_push(kind: str) -> None:
    """So that the agreement above is one of contact: turned to face the wall, turned by one another, pushed along."""
    ends = pressed(kind, chosen())
    assert abs(ends["slide at 60 degrees"].poses_w[0, 2] - math.pi / 2) < math.radians(5.0)
    assert abs(ends["push one another"].poses_w[0, 2]) > math.radians(10.0)
    aside = next(case for case in touches(kind) if case.name == "push aside")
    began = aside.poses_w[1][:2] + np.array([APART * (len(touches(kind)) / 2 - 1), 0.0])
    assert np.hypot(*(ends["push aside"].poses_w[1, :2] - began)) > 0.1


@pytest.mark.parametrize("timestep", [0.01, 0.005, 0.002])
@pytest.mark.parametrize(
    "kind", [name for name in bodies.names() if bodies.load(name).spec().joint("left") is not None]
)
def test_a_slipping_wheel_turns_where_servo_and_friction_balance(kind: str, timestep: float) -> None:
    """At a wall, commanded v: the rim runs at v − r τ / k with the tyre's friction torque τ = μ N r, for any step."""
    body, speed = bodies.load(kind), 0.25
    poses_w = np.array([[0.0, 1.155 - body.radius - 0.05, math.pi / 2]])
    world = assemble.build("corridor", {}, [kind], ["r"], poses_w, timestep)
    world.fleet.command(0, speed, 0.0)
    world.advance(to=round(5.0 / timestep))
    model, data = world.model, world.data
    wheel = model.joint("r/left")
    radius = float(model.geom("r/left_tyre").size[0])
    gain = float(model.actuator("r/left").gainprm[0])
    rims, loads, force = [], [], np.empty(6)
    for _ in range(round(2.0 / timestep)):
        world.advance(to=world.tick + 1)
        rims.append(float(data.qvel[wheel.dofadr[0]]) * radius)
        for c in range(data.ncon):
            if model.geom(data.contact[c].geom2).name == "r/left_tyre":
                mujoco.mj_contactForce(model, data, c, force)
                loads.append(force[0])
    assert len(loads) == len(rims)  # the tyre never leaves the floor,
    assert min(rims) > 0.0  # and never turns backwards
    balance = speed - radius * create.TYRE_FRICTION * np.mean(loads) * radius / gain
    assert np.mean(rims) == pytest.approx(balance, abs=1e-3)
