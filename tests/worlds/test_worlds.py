"""Contract tests: every world and every formation that exists is found by itself; walls are where they say."""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest
from numpy.testing import assert_allclose

from flocking import found
from flocking.errors import InputError
from flocking.parameters import declared
from generation.free_space import clearance
from robots import body
from trials.simulations.robots.fields import world_names
from worlds import assemble, corridor, formations, known, starts
from worlds.walls import HEIGHT, Walls, add_walls, closed, walls_of

WORLDS = world_names()
CREATE = body.load("create")
DIAMETER = 2.0 * CREATE.radius
TIMESTEP = 0.01


def built(world: str = "corridor", count: int = 2, gap: float = 2.0) -> assemble.World:
    poses = np.zeros((count, 3))
    poses[:, 0] = np.arange(count) * gap
    poses_w = starts.put_at_start(known.environment_of(world, "", {}), poses)
    return assemble.build(world, {}, ["create"] * count, [f"herd-{k + 1}" for k in range(count)], poses_w, TIMESTEP)


@pytest.mark.parametrize("name", WORLDS)
class TestEveryWorld:
    def test_says_where_its_numbers_come_from(self, name: str) -> None:
        module = found.load("worlds", name, "world")
        assert module.__doc__
        assert all(d.about.source for d in declared(module.Parameters).values())

    def test_compiles_with_robots_and_runs_a_second_without_a_warning(self, name: str) -> None:
        world = built(name)
        placed = world.fleet.poses(world.data)[:, :2].copy()
        world.advance(to=100)
        assert world.tick == 100
        assert world.data.time == pytest.approx(1.0)
        assert all(warning.number == 0 for warning in world.data.warning)
        # robots that are told nothing stay: contacts settle within a tenth of a millimetre
        assert_allclose(world.fleet.poses(world.data)[:, :2], placed, atol=1e-3)


@pytest.mark.parametrize("name", sorted(formations.FORMATIONS))
class TestEveryFormation:
    def test_members_stand_apart_inside_the_corridor(self, name: str) -> None:
        half_width = corridor.Parameters().width_m / 2
        for seed in range(20):
            poses_w = formations.poses(name, {}, 6, np.random.default_rng(seed))
            gaps = np.hypot(*(poses_w[:, None, :2] - poses_w[None, :, :2]).transpose(2, 0, 1))
            assert gaps[~np.eye(6, dtype=bool)].min() > DIAMETER
            assert np.abs(poses_w[:, 1]).max() < half_width - CREATE.radius

    def test_the_same_stream_gives_the_same_start(self, name: str) -> None:
        first, second = (formations.poses(name, {}, 6, np.random.default_rng(4)) for _ in range(2))
        assert_allclose(first, second, rtol=0.0, atol=0.0)

    @pytest.mark.parametrize("count", [1, 2, 3, 7, 30])
    def test_any_count_gives_as_many_poses(self, name: str, count: int) -> None:
        poses_w = formations.poses(name, {}, count, np.random.default_rng(0))
        assert poses_w.shape == (count, 3)
        assert np.isfinite(poses_w).all()


def test_an_unknown_formation_offers_the_nearest() -> None:
    with pytest.raises(InputError, match="single-group"):
        formations.poses("single-grup", {}, 6, np.random.default_rng(0))


class TestFormations:
    @pytest.mark.parametrize("name", sorted(formations.FORMATIONS))
    @pytest.mark.parametrize("spread_deg", [0.0, 2.0, 180.0])
    def test_headings_are_within_the_spread_and_take_all_of_it(self, name: str, spread_deg: float) -> None:
        given = {"heading_spread_deg": spread_deg}
        headings = formations.poses(name, given, 60, np.random.default_rng(3))[:, 2]
        assert np.abs(headings).max() <= math.radians(spread_deg)
        # the largest of 60 uniform numbers falls short of 0.9 with a probability of 0.9^60 = 0.002
        assert np.abs(headings).max() >= 0.9 * math.radians(spread_deg)

    def test_a_single_file_without_jitter_is_a_row_of_equal_steps(self) -> None:
        given = {"spacing_m": 0.7, "jitter_m": 0.0, "heading_spread_deg": 0.0}
        poses_w = formations.poses("single-file", given, 5, np.random.default_rng(0))
        assert_allclose(poses_w, np.outer([2, 1, 0, -1, -2], [0.7, 0.0, 0.0]), atol=1e-12)

    def test_a_staggered_file_takes_turns_on_either_side(self) -> None:
        given = {"spacing_m": 0.8, "aside_m": 0.3, "jitter_m": 0.0, "heading_spread_deg": 0.0}
        poses_w = formations.poses("staggered-file", given, 4, np.random.default_rng(0))
        assert_allclose(poses_w[:, 0], [1.2, 0.4, -0.4, -1.2], atol=1e-12)
        assert_allclose(poses_w[:, 1], [0.3, -0.3, 0.3, -0.3], atol=1e-12)

    def test_a_split_file_is_two_files_with_a_gap_between_them(self) -> None:
        given = {"spacing_m": 0.5, "gap_m": 2.0, "aside_m": 0.1, "jitter_m": 0.0, "heading_spread_deg": 0.0}
        x, y, _ = formations.poses("split-file", given, 5, np.random.default_rng(0)).T
        assert_allclose(-np.diff(x), [0.5, 2.0, 0.5, 0.5], atol=1e-12)
        assert_allclose(y, [0.1, -0.1, 0.1, -0.1, 0.1], atol=1e-12)

    def test_spacing_scales_a_group_and_jitter_has_its_standard_deviation(self) -> None:
        still = {"jitter_m": 0.0}
        near, wide = (
            formations.poses("single-group", {**still, "spacing_m": spacing}, 6, np.random.default_rng(0))
            for spacing in (0.5, 1.5)
        )
        assert_allclose(wide[:, :2], 3.0 * near[:, :2], atol=1e-12)
        shaken = formations.poses("single-group", {"jitter_m": 0.2}, 2000, np.random.default_rng(1))[:, :2]
        placed = formations.poses("single-group", still, 2000, np.random.default_rng(1))[:, :2]
        # standard error of a standard deviation of 4000 numbers: 0.2 / sqrt(8000); four of them
        assert (shaken - placed).std() == pytest.approx(0.2, abs=4 * 0.2 / math.sqrt(8000))

    def test_what_a_formation_does_not_have_is_refused(self) -> None:
        with pytest.raises(
            InputError, match=r"unknown parameter 'formation\.jiter_m'; did you mean formation\.jitter_m"
        ):
            formations.poses("single-file", {"jiter_m": 0.0}, 6, np.random.default_rng(0))
        with pytest.raises(InputError, match=r"formation\.heading_spread_deg = 181.*from 0 to 180 in deg"):
            formations.poses("scattered", {"heading_spread_deg": 181.0}, 6, np.random.default_rng(0))


class TestWalls:
    @pytest.mark.parametrize("turn", [0.0, 0.3, 1.7])
    def test_the_face_of_a_wall_lies_on_its_segment(self, turn: float) -> None:
        """MuJoCo's own ray from inside a turned square meets each wall where the segment is."""
        corners = [(math.cos(turn + k * math.pi / 2), math.sin(turn + k * math.pi / 2)) for k in range(4)]
        spec = mujoco.MjSpec()
        add_walls(spec, Walls(closed(corners), 0.8))
        model = spec.compile()
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        inradius = math.cos(math.pi / 4)
        for k in range(4):
            angle = turn + (k + 0.5) * math.pi / 2
            direction = np.array([math.cos(angle), math.sin(angle), 0.0])
            reach = mujoco.mj_ray(
                model, data, np.array([0.0, 0.0, HEIGHT / 2]), direction, None, 1, -1, np.array([-1], dtype=np.int32)
            )
            # MuJoCo's ray against a box is exact to rounding
            assert reach == pytest.approx(inradius, abs=1e-9)

    @pytest.mark.parametrize("turn", [0.0, 0.3, 1.7])
    def test_physics_has_walls_where_the_segments_are_and_nowhere_else(self, turn: float) -> None:
        """MuJoCo's rays from free places in a room with pillars end on the nearest segment: no box stands before it.

        The solids are given clockwise: a square, one with a corner that turns inwards, and a plate thinner than a wall.
        """
        room = closed([(-3, -3), (3, -3), (3, 3), (-3, 3)])
        square = closed([(-2, -2), (-2, -1), (-1, -1), (-1, -2)])
        bent = closed([(1, 0), (1, 2), (2, 2), (2, 1), (1.5, 1), (1.5, 0)])
        plate = closed([(-1.5, 1), (-1.5, 2), (-1.46, 2), (-1.46, 1)])
        ends = np.concatenate([room, square, bent, plate]).reshape(-1, 2)
        c, s = math.cos(turn), math.sin(turn)
        segments = (ends @ np.array([[c, s], [-s, c]])).reshape(-1, 4)
        spec = mujoco.MjSpec()
        add_walls(spec, Walls(segments, 0.8))
        model = spec.compile()
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        rng = np.random.default_rng(2)
        places = rng.uniform(-4.2, 4.2, size=(400, 2))
        places = places[clearance(segments, places) > 0.0]
        assert len(places) > 100
        for place in places:
            angle = rng.uniform(-math.pi, math.pi)
            direction = np.array([math.cos(angle), math.sin(angle), 0.0])
            start = np.array([*place, HEIGHT / 2])
            reach = mujoco.mj_ray(model, data, start, direction, None, 1, -1, np.array([-1], dtype=np.int32))
            along, offset = segments[:, 2:] - segments[:, :2], segments[:, :2] - place
            cross = direction[0] * along[:, 1] - direction[1] * along[:, 0]
            distance = (offset[:, 0] * along[:, 1] - offset[:, 1] * along[:, 0]) / cross
            share = (offset[:, 0] * direction[1] - offset[:, 1] * direction[0]) / cross
            met = distance[(distance > 0.0) & (share >= 0.0) & (share <= 1.0)]
            # a ray against a box is exact to rounding
            assert reach == pytest.approx(met.min(), abs=1e-9)

    @pytest.mark.parametrize(
        ("segments", "words"),
        [
            (closed([(0, 0), (1, 2), (2, 0)]), "solids without corners sharper than 68 degrees"),
            (np.array([(0.0, 0.0, 2.0, 0.0), (1.0, 1.0, 1.0, -1.0)]), "walls that do not cross"),
            (np.array([(1.0, 2.0, 1.0, 2.0)]), r"wall 1 at \(1, 2\) m has no length"),
        ],
    )
    def test_walls_that_cannot_be_built_are_refused(self, segments: np.ndarray, words: str) -> None:
        with pytest.raises(InputError, match=words):
            add_walls(mujoco.MjSpec(), Walls(segments, 0.8))

    def test_the_corridor_is_seven_robot_diameters_wide(self) -> None:
        assert corridor.ROBOT_DIAMETER == DIAMETER
        walls = walls_of(corridor.environment(corridor.Parameters()))
        assert np.ptp(walls.segments[:, 1]) == pytest.approx(7 * DIAMETER)


class TestLooks:
    def test_what_lasers_see_stands_where_physics_has_it(self) -> None:
        """Bodies, joints and actuators have the same names in the same order, the walls and hulls the same shapes."""
        world = built()
        whole, model = world.whole, world.model
        assert (whole.nq, whole.nv, whole.nu, whole.nbody) == (model.nq, model.nv, model.nu, model.nbody)
        for kind, count in (("body", model.nbody), ("joint", model.njnt), ("actuator", model.nu)):
            named = [[getattr(m, kind)(k).name for k in range(count)] for m in (whole, model)]
            assert named[0] == named[1]
        np.testing.assert_array_equal(whole.jnt_qposadr, model.jnt_qposadr)
        np.testing.assert_array_equal(whole.qpos0, model.qpos0)
        assert {model.geom(k).name for k in range(model.ngeom)} < {whole.geom(k).name for k in range(whole.ngeom)}
        assert whole.site("herd-1/laser").bodyid[0] == world.fleet.root_bodies[0]


class TestContacts:
    def test_a_robot_driven_against_another_touches_it_once(self) -> None:
        world = built(gap=1.0)
        world.fleet.command(0, 0.3, 0.0)
        world.advance(to=400)
        pairs = {(row[1], row[2]) for row in world.contacts}
        assert pairs == {(0.0, 1.0)}
        time, _, _, x, _ = world.contacts[0]
        # the gap between the hulls is closed at 0.3 m/s after the wheels' ramp
        assert (1.0 - DIAMETER) / 0.3 < time < (1.0 - DIAMETER) / 0.3 + 0.5
        assert x == pytest.approx(1.0 - CREATE.radius, abs=0.01)

    def test_a_wall_is_told_from_a_robot(self) -> None:
        world = built()
        world.fleet.command(1, 0.2, 1.0)
        world.advance(to=157)
        world.fleet.command(1, 0.3, 0.0)
        world.advance(to=900)
        assert {row[2] for row in world.contacts} == {-1.0}

    @pytest.mark.parametrize("apart", [2.0 - DIAMETER, 0.02, 0.009, 0.007, 0.004])
    def test_robots_that_stand_apart_do_not_touch(self, apart: float) -> None:
        """MuJoCo lists a contact from 8 mm on (the bumpers' travel of both): nobody presses on anybody yet."""
        world = built(gap=DIAMETER + apart)
        world.advance(to=5)
        assert (world.contacts == []) == (apart > 0.0075)
