"""Walls that rise and vanish: robots meet them, and lasers see them, while they stand and only then."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest

from flocking.types import Floats
from generation.environment import Environment
from generation.files import to_json
from generation.primitives import Polygon, Segment
from sensing.laser.hokuyo import ANGLES, MAX_RANGE_M, SETTINGS, Lasers
from sensing.laser.reference import Rays, difference
from worlds import assemble
from worlds.walls import FENCE

ROOM = Polygon(((-3.0, -3.0), (3.0, -3.0), (3.0, 3.0), (-3.0, 3.0)), "inside")
ACROSS = np.array([1.0, -1.0, 1.0, 1.0])
"""A wall across the way of a robot that starts at the origin along x."""
BEYOND = np.array([2.0, -1.0, 2.0, 1.0])


def world(*walls: Floats, construct: tuple[Segment, ...] = ()) -> assemble.World:
    """A Create at the origin that looks along x, in a room 6 m wide, with walls that can stand."""
    text = to_json(Environment((ROOM,), construct))
    return assemble.build("a.json", {}, ["create"], ["herd-1"], np.zeros((1, 3)), 0.01, text, np.array(walls))


def lasers(of: assemble.World) -> Lasers:
    return Lasers(of.whole, ["herd-1/laser"], of.fleet.root_bodies.tolist(), [SETTINGS["ideal"]])


def seen(of: assemble.World) -> Floats:
    return lasers(of).cast(of.data, 0)[0]


@pytest.mark.parametrize("beside", [0, 40])
def test_a_robot_is_stopped_by_a_wall_that_stands_and_goes_on_once_it_has_vanished(beside: int) -> None:
    """Whether each box is tried or, among many, the tree of boxes is asked."""
    others = tuple(Segment(-2.5, -1.0 + 0.05 * k, -2.0, -1.0 + 0.05 * k) for k in range(beside))
    built = world(ACROSS, construct=others)
    built.standing.put(built.data, 0, True)
    built.fleet.command(0, 0.3, 0.0)
    built.advance(to=800)
    radius = built.bodies[0].radius
    # the bumper's travel and a press into the box of some millimetres
    assert built.fleet.poses(built.data)[0, 0] == pytest.approx(1.0 - FENCE / 2 - radius, abs=0.01)
    assert [row[2] for row in built.contacts][:1] == [-1.0]
    touches = len(built.contacts)
    built.standing.put(built.data, 0, False)
    before = built.fleet.poses(built.data)[0, 0]
    built.fleet.command(0, 0.3, 0.0)
    built.advance(to=1200)
    # 4 s at 0.3 m/s, less the wheels' ramp of some tenths of a second
    assert built.fleet.poses(built.data)[0, 0] - before == pytest.approx(1.2, abs=0.1)
    assert len(built.contacts) == touches


def test_a_robot_drives_through_a_wall_that_never_stood_as_if_there_were_none() -> None:
    """To the bit: bodies that are away take no part in physics."""
    ends = []
    for built in (world(ACROSS), world()):
        built.fleet.command(0, 0.3, 0.1)
        built.advance(to=500)
        assert not built.contacts
        ends.append(built.fleet.poses(built.data)[0])
    np.testing.assert_array_equal(*ends)


def test_a_robot_under_way_meets_a_wall_that_rises_before_it() -> None:
    built = world(ACROSS)
    built.fleet.command(0, 0.3, 0.0)
    built.advance(to=100)
    assert built.fleet.poses(built.data)[0, 0] > 0.1
    built.standing.put(built.data, 0, True)
    built.advance(to=800)
    assert built.fleet.poses(built.data)[0, 0] < 1.0 - FENCE / 2
    assert [row[2] for row in built.contacts][:1] == [-1.0]


@pytest.mark.parametrize("turn_deg", [0.0, 30.0, 90.0, -75.0])
def test_the_laser_sees_a_standing_wall_at_its_distance_and_none_that_is_away(turn_deg: float) -> None:
    """A wall across the way 1 m off: its face is half a thickness nearer, and 1 / cos of the angle farther aside."""
    turn = math.radians(turn_deg)
    c, s = math.cos(turn), math.sin(turn)
    built = world(np.array([c - s, s + c, c + s, s - c]), BEYOND)
    mount = lasers(built).mounts[0]
    assert np.allclose(mount, 0.0)  # the laser stands on the robot's axis
    empty = seen(built)
    built.standing.put(built.data, 0, True)
    found = seen(built)
    aside = np.angle(np.exp(1j * (ANGLES - turn)))
    met = np.abs(aside) < math.atan2(1.0, 1.0 + FENCE / 2) - 1e-3
    assert met.sum() > 100
    # exact to rounding of a cast
    np.testing.assert_allclose(found[met], (1.0 - FENCE / 2) / np.cos(aside[met]), atol=1e-9)
    beyond = np.abs(aside) > math.atan2(1.0, 1.0 - FENCE / 2) + 1e-3
    np.testing.assert_array_equal(found[beyond], empty[beyond])
    built.standing.put(built.data, 0, False)
    np.testing.assert_array_equal(seen(built), empty)
    # the walls of the room alone: at the least 3 m off, and nothing beyond what the laser reaches
    assert empty.min() == pytest.approx(3.0, abs=1e-3)
    assert empty[np.isfinite(empty)].max() <= MAX_RANGE_M


def test_mujocos_own_rays_agree_on_standing_walls() -> None:
    rng = np.random.default_rng(7)
    walls = [np.concatenate([end, end + rng.uniform(0.3, 1.0, 2)]) for end in rng.uniform(-2.5, 1.5, (6, 2))]
    walls = [wall for wall in walls if np.hypot(*wall[:2]) > 0.5 and np.hypot(*wall[2:]) > 0.5]
    built = world(*walls)
    planar = lasers(built)
    rays = Rays(built.whole, ["herd-1/laser"], built.fleet.root_bodies.tolist())
    placed = _whole_data(built)
    empty = planar.cast(built.data, 0)[0]
    for _ in range(10):
        up = rng.random(len(walls)) < 0.5
        for number, stands in enumerate(up):
            built.standing.put(built.data, number, bool(stands))
            built.standing.put(placed, number, bool(stands))
        distances = planar.cast(built.data, 0)[0]
        # what is promised of all scenes; found is round-off
        assert difference(distances, rays.cast(placed, 0)[0]).max() < 1e-3
        assert up.any() == (not np.array_equal(distances, empty))


def _whole_data(of: assemble.World) -> mujoco.MjData:
    """Data of the whole model with the robots where they are."""
    placed = mujoco.MjData(of.whole)
    placed.qpos[:] = of.data.qpos
    return placed


def test_the_walls_that_stand_are_those_of_the_world_and_those_that_are_up() -> None:
    other = np.array([-1.0, -1.0, -2.0, 0.5])
    built = world(ACROSS, other)
    fixed = built.walls.all
    np.testing.assert_array_equal(built.standing_w, fixed)
    built.standing.put(built.data, 1, True)
    np.testing.assert_array_equal(built.standing_w, np.concatenate([fixed, [other]]))
    built.standing.put(built.data, 0, True)
    np.testing.assert_array_equal(built.standing_w, np.concatenate([fixed, [ACROSS], [other]]))
    built.standing.put(built.data, 1, False)
    np.testing.assert_array_equal(built.standing_w, np.concatenate([fixed, [ACROSS]]))
    built.standing.put(built.data, 0, False)
    np.testing.assert_array_equal(built.standing_w, fixed)


def test_both_models_of_a_world_have_the_same_bodies() -> None:
    """Lasers read places by the numbers of the model that is stepped."""
    built = world(ACROSS, BEYOND)
    assert [built.model.body(k).name for k in range(built.model.nbody)] == [
        built.whole.body(k).name for k in range(built.whole.nbody)
    ]
    np.testing.assert_array_equal(built.model.body_mocapid, built.whole.body_mocapid)
