"""Robots of two kinds in one world: each moves, touches others, is seen and is recorded by the size of its own body."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rerun.chunk import RrdReader

from flocking.errors import InputError
from robots import body as bodies
from robots.fleets import MixedFleet
from sensing.laser.hokuyo import SETTINGS, STEP_RAD, Lasers
from trials.simulations import run_trial
from trials.simulations.robots import fields
from trials.simulations.robots.recordings import write
from trials.types import Trial
from worlds import assemble

CREATE, SMALL = bodies.load("create"), bodies.load("create-small")


def world(*robots: tuple[str, float, float, float], of: str = "open-floor") -> assemble.World:
    """Robots (kind, x, y, heading)."""
    poses_w = np.array([robot[1:] for robot in robots], dtype=np.float64)
    names = [f"r{k}" for k in range(len(robots))]
    return assemble.build(of, {}, [robot[0] for robot in robots], names, poses_w, 0.01)


def trial(**changes: Any) -> Trial:
    """Three Creates and three small ones in the corridor, all with extended Hamilton's rule."""
    small = {"count": 3, "name": "small", "body": "create-small", "speed_m_s": 0.2, **changes}
    return fields.trial("two-kinds", 1, [fields.group(count=3), fields.group(**small)], duration_s=8.0)


class TestWorld:
    def test_commands_reach_the_robots_that_they_are_for(self) -> None:
        """Kinds mixed in any order; each at its own speed or turn rate, poses in the order of the robots."""
        started = [("create-small", 0.0, 0.0, 0.0), ("create", 0.0, 2.0, 0.0), ("create-small", 0.0, 4.0, math.pi)]
        started += [("create", 0.0, 6.0, 0.0), ("create", 0.0, 8.0, 0.0)]
        built = world(*started)
        assert isinstance(built.fleet, MixedFleet)
        np.testing.assert_allclose(built.fleet.poses(built.data), [robot[1:] for robot in started], atol=1e-12)
        wanted = [(0.2, 0.0), (0.4, 0.0), (0.1, 0.0), (0.0, 1.0), (0.0, 0.0)]
        for k, (speed, turn_rate) in enumerate(wanted):
            built.fleet.command(k, speed, turn_rate)
        built.advance(to=200)
        before = built.fleet.poses(built.data)
        built.advance(to=300)
        moved = built.fleet.poses(built.data) - before
        # one second at the speeds that whole mm/s can say; tyres creep by less than 0.5 %
        np.testing.assert_allclose(moved[:, 0], [0.2, 0.4, -0.1, 0.0, 0.0], atol=2e-3)
        np.testing.assert_allclose(moved[:, 2], [0.0, 0.0, 0.0, 1.0, 0.0], atol=0.02)
        velocities = built.fleet.velocities(built.data)
        np.testing.assert_allclose(velocities[:, 0], [0.2, 0.4, -0.1, 0.0, 0.0], atol=2e-3)

    def test_what_each_knows_of_its_motion_is_its_own(self) -> None:
        built = world(("create", 0.0, 0.0, 0.0), ("create-small", 0.0, 2.0, 0.0))
        built.fleet.command(1, 0.3, 0.0)
        built.advance(to=300)
        motion, contacts = np.empty(3), np.empty(2, dtype=np.bool_)
        went = built.fleet.poses(built.data)[1, 0]
        for k, expected in ((0, 0.0), (1, went)):
            built.fleet.meant(k, motion)
            # the wheels trail their set-points by some 40 ms: 12 mm
            assert built.fleet.meant_pose(k)[0] == pytest.approx(expected, abs=0.02)
            built.fleet.own(k, motion, contacts)
            np.testing.assert_array_equal(built.fleet.counted_pose(k), built.fleet.odometry[k])
            assert not contacts.any()
        assert built.fleet.odometry[0, 0] == 0.0
        assert 0.7 * went < built.fleet.odometry[1, 0] <= went + 1e-9  # whole mm, truncated: 4 of 4.5 a request

    def test_the_small_one_is_no_faster_than_its_top_speed(self) -> None:
        built = world(("create", 0.0, 0.0, 0.0), ("create-small", 0.0, 2.0, 0.0))
        for k in range(2):
            built.fleet.command(k, 0.5, 0.0)
        built.advance(to=300)
        speeds = built.fleet.velocities(built.data)[:, 0]
        np.testing.assert_allclose(speeds, [CREATE.top_speed, SMALL.top_speed], rtol=5e-3)

    def test_they_touch_where_their_outlines_meet(self) -> None:
        """The contact divides the distance as the radii do; only the bumpers of the robot that drives are pressed."""
        built = world(("create-small", 0.0, 0.0, 0.0), ("create", 0.8, 0.0, 0.0))
        built.fleet.command(0, 0.2, 0.0)
        built.advance(to=400)
        assert {(row[1], row[2]) for row in built.contacts} == {(0.0, 1.0)}
        time, _, _, x, y = built.contacts[0]
        gap = 0.8 - CREATE.radius - SMALL.radius
        assert gap / 0.2 < time < gap / 0.2 + 0.5  # after the wheels' ramp
        assert x == pytest.approx(0.8 - CREATE.radius, abs=0.01)
        assert y == pytest.approx(0.0, abs=0.01)
        motion, contacts = np.empty(3), np.empty(2, dtype=np.bool_)
        pressed = []
        for k in range(2):
            built.fleet.own(k, motion, contacts)
            pressed.append(contacts.tolist())
        assert pressed == [[True, True], [False, False]]
        distance = float(np.ptp(built.fleet.poses(built.data)[:, 0]))
        assert distance > CREATE.radius + SMALL.radius - 2e-3

    def test_one_kind_is_driven_by_its_own_fleet_alone(self) -> None:
        assert not isinstance(world(("create-small", 0.0, 0.0, 0.0)).fleet, MixedFleet)

    def test_the_free_length_is_the_widest_robots(self) -> None:
        both = world(("create-small", 0.0, 0.0, 0.0), ("create", 2.0, 0.0, 0.0), of="corridor").free_length
        small = world(("create-small", 0.0, 0.0, 0.0), of="corridor").free_length
        assert both == 40.0 - CREATE.radius
        assert small == 40.0 - SMALL.radius


class TestSeen:
    @pytest.mark.parametrize("distance", [0.6, 1.0, 2.5])
    def test_at_its_own_size(self, distance: float) -> None:
        """A disc of radius r at distance d: the nearest reading d − r, and 2 asin(r / d) of beams."""
        built = world(("create", 0.0, 0.0, 0.0), ("create-small", distance, 0.0, 1.0), ("create", 0.0, distance, 2.0))
        sites = [f"r{k}/laser" for k in range(3)]
        lasers = Lasers(built.whole, sites, built.fleet.root_bodies.tolist(), [SETTINGS["ideal"]] * 3)
        radii = [kind.silhouette_radius for kind in built.bodies]
        np.testing.assert_allclose(lasers.silhouette_radii, radii, rtol=1e-12)
        distances, geoms = lasers.cast(built.data, 0)
        roots = np.where(geoms < 0, -1, built.whole.body_rootid[built.whole.geom_bodyid[geoms]])
        for k in (1, 2):
            mine = roots == built.fleet.root_bodies[k]
            beams = 2.0 * math.asin(radii[k] / distance) / STEP_RAD
            assert abs(mine.sum() - beams) <= 1.0
            # the beam nearest to the axis is off it by half a step at the most: micrometres
            assert distances[mine].min() == pytest.approx(distance - radii[k], abs=1e-4)


class TestTrial:
    def test_it_runs_and_is_measured_and_recorded(self, tmp_path: Path) -> None:
        done = run_trial(trial(), scans="some")
        assert done.outcome == "done", done.reason
        assert done.robot_names == ("herd-1", "herd-2", "herd-3", "small-1", "small-2", "small-3")
        np.testing.assert_array_equal(done.radii, [CREATE.radius] * 3 + [SMALL.radius] * 3)
        speeds = np.abs(done.updates.commands[:, 0])
        assert speeds[done.updates.robots >= 3].max() <= 0.2 + 1e-12
        assert speeds[done.updates.robots < 3].max() > 0.2
        assert done.measures["distance_travelled"] > 0.1
        path = tmp_path / "trial.rrd"
        write(done, path)
        radii = {}
        for chunk in RrdReader(path).stream():
            if chunk.entity_path.endswith("/body"):
                (column,) = (name for name in chunk.to_record_batch().schema.names if name.endswith("radii"))
                ((radius,),) = chunk.to_record_batch().column(column).to_pylist()
                radii[chunk.entity_path.split("/")[-2]] = radius
        expected = {name: CREATE.radius if name.startswith("herd") else SMALL.radius for name in done.robot_names}
        assert radii == pytest.approx(expected, rel=1e-6)  # kept in single precision

    def test_the_same_trial_gives_the_same_result(self) -> None:
        first, second = run_trial(trial()), run_trial(trial())
        np.testing.assert_array_equal(first.poses_w, second.poses_w)
        np.testing.assert_array_equal(first.updates.commands, second.updates.commands)

    def test_a_speed_above_the_bodys_is_refused(self) -> None:
        words = r"small\.speed_m_s = 0\.4: expected at most 0\.3 m/s, the top speed of body 'create-small'"
        with pytest.raises(InputError, match=words):
            run_trial(trial(speed_m_s=0.4))

    def test_global_knowledge_tells_each_ones_silhouette(self) -> None:
        from trials.simulations.robots.herd import assemble as herd_of

        herd = herd_of(trial(pipeline="perfect", law="snn"), record=False)
        truth = herd.world_truth(4, herd.world.fleet.poses(herd.world.data))
        assert truth is not None
        np.testing.assert_array_equal(truth.radii, [CREATE.silhouette_radius] * 3 + [SMALL.silhouette_radius] * 3)
