"""The kinematic group in environments: it is the kinematic herd itself, whatever the order and number of its jobs."""

from __future__ import annotations

import dataclasses
import math
import pickle

import numpy as np
import pytest

from flocking.errors import InputError
from flocking.kinematic import Schedule, Space, simulate
from flocking.types import Floats
from generation.environment import Environment
from generation.group import Job
from generation.primitives import Point, Polygon, Segment
from generation.validation.kinematic import KinematicGroup, Members, kinematic
from generation.validation.starts import Starts, axis, mirrored, poses

WEDGE = Environment(
    construct=(Segment(0.0, 30.0, -25.0, 60.0), Segment(0.0, 30.0, 25.0, 60.0), Segment(-30.0, 20.0, -30.0, 70.0)),
    markers={"start": Point(0.0, 0.0, math.pi / 2)},
)
ITERATIONS = 60


def jobs(environment: Environment, count: int, many: int, side_m: float = 30.0, spread_rad: float = 0.5) -> list[Job]:
    starts = Starts(side_m=side_m, spread_rad=spread_rad)
    return [Job(environment, poses(environment, count, starts, np.random.default_rng(k)), (7, k)) for k in range(many)]


def alone(group: KinematicGroup, job: Job, iterations: int) -> Floats:
    speeds = np.repeat([each.speed_m_s for each in group.members], [each.count for each in group.members])
    return simulate(
        group.bands,
        job.poses_w,
        Schedule(group.dt_s, iterations),
        rng=np.random.default_rng(job.seed),
        space=Space(walls=job.environment.walls()),
        speeds_m_s=speeds,
    ).positions_w


GROUPS = {
    "positions and velocities": kinematic("reynolds-boids", 12),
    "headings": kinematic("reynolds-opensteer", 12, law_parameters={"cohesion_m": 25.0, "top_speed_m_s": 2.0}),
    "draws and memory": kinematic("random-motion", 12, law_parameters={"hold_s": 3.0, "turn_rad": 0.5}),
    "way-points": kinematic("snn", 12),
    "discs": kinematic("reynolds-boids", 12, radius_m=0.5),
    "virtual members": kinematic("reynolds-boids", 12, obstacles="virtual-members"),
    "many members": kinematic("reynolds-boids", 60),
    "tessellated": kinematic("viscido-lch", 12, selection="voronoi"),
    "two laws": KinematicGroup((Members("reynolds-boids", 8), Members("random-motion", 4, speed_m_s=1.0))),
}


@pytest.mark.parametrize("name", GROUPS)
@pytest.mark.parametrize("environment", [Environment(), WEDGE], ids=["empty", "wedge"])
def test_each_job_is_the_kinematic_herd_bit_for_bit(name: str, environment: Environment) -> None:
    group = GROUPS[name]
    given = jobs(environment, group.count, 3)
    for job, positions in zip(given, group.trajectories(given, ITERATIONS), strict=True):
        assert positions.shape == (ITERATIONS + 1, group.count, 2)
        np.testing.assert_array_equal(positions, alone(group, job, ITERATIONS))


def test_neither_order_nor_number_of_jobs_matters() -> None:
    group = GROUPS["draws and memory"]
    given = jobs(Environment(), group.count, 4) + jobs(WEDGE, group.count, 5)
    order = np.random.default_rng(3).permutation(len(given))
    found = list(group.trajectories(given, 20))
    for place, positions in zip(order, group.trajectories([given[k] for k in order], 20), strict=True):
        np.testing.assert_array_equal(positions, found[place])
    assert list(group.trajectories([], 20)) == []


@pytest.mark.parametrize("name", ["positions and velocities", "headings", "way-points", "discs"])
def test_mirrored_worlds_give_mirrored_trajectories(name: str) -> None:
    group, mark = GROUPS[name], Point(3.0, -2.0, 0.7)
    turned = WEDGE.moved(turn_rad=0.7 - math.pi / 2, x_m=3.0, y_m=-2.0)
    job = jobs(turned, group.count, 1)[0]

    def seen(x: float, y: float) -> tuple[float, float]:
        place = mirrored(np.array([[x, y, 0.0]]), mark)[0]
        return float(place[0]), float(place[1])

    walls = tuple(
        Segment(*seen(wall[0], wall[1]), *seen(wall[2], wall[3])) for wall in turned.construct_walls().tolist()
    )
    image = Job(dataclasses.replace(turned, construct=walls), mirrored(job.poses_w, mark), job.seed)
    here, there = group.trajectories([job, image], 25)
    expected = mirrored(np.column_stack([here.reshape(-1, 2), np.zeros(here.size // 2)]), mark)[:, :2]
    # coordinates of order 100 rounded at 1e-14 relative, and errors that a flock doubles every few of 25 steps
    np.testing.assert_allclose(there.reshape(-1, 2), expected, rtol=0.0, atol=1e-6)
    assert axis(turned).heading_rad == pytest.approx(0.7)


def test_a_construct_outside_of_a_corridor_does_nothing_within() -> None:
    corridor = Environment(
        workspace=(Polygon(((-5.0, -40.0), (5.0, -40.0), (5.0, 300.0), (-5.0, 300.0)), "inside"),),
        markers={"start": Point(0.0, 0.0, math.pi / 2)},
    )
    outside = tuple(Segment(5.5, y, 30.0, y + 4.0) for y in np.arange(0.0, 100.0, 7.0).tolist())
    both = dataclasses.replace(corridor, construct=outside)
    group = kinematic("reynolds-boids", 8, law_parameters={"range_m": 10.0, "separation_m": 2.0})
    job = jobs(corridor, 8, 1, side_m=8.0)[0]
    without, with_it = group.trajectories([job, job._replace(environment=both)], ITERATIONS)
    np.testing.assert_array_equal(with_it, without)
    unseen = dataclasses.replace(group.bands[0], sight_lines=False)
    space = Space(walls=both.walls())
    through = simulate(
        unseen, job.poses_w, Schedule(1.0, ITERATIONS), rng=np.random.default_rng(0), space=space, speeds_m_s=2.0
    )
    assert not np.array_equal(through.positions_w, without)  # seen through the wall it would act


def test_nobody_passes_through_a_wall() -> None:
    room = Environment(workspace=(Polygon(((-20.0, -20.0), (20.0, -20.0), (20.0, 20.0), (-20.0, 20.0)), "inside"),))
    group = kinematic("random-motion", 25, law_parameters={"speed_m_s": 2.0})
    for positions in group.trajectories(jobs(room, 25, 3, side_m=38.0, spread_rad=math.pi), 300):
        assert np.abs(positions).max() <= 20.0


def test_a_group_travels_to_other_processes() -> None:
    group = GROUPS["positions and velocities"]
    _ = group.bands
    job = jobs(WEDGE, group.count, 1)
    there = pickle.loads(pickle.dumps(group))
    np.testing.assert_array_equal(*(next(each.trajectories(job, 5)) for each in (group, there)))


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(InputError, match="unknown law 'boid'"):
        _ = kinematic("boid", 3).bands
    with pytest.raises(InputError, match="obstacles = 'shun'"):
        _ = kinematic("snn", 3, obstacles="shun").bands
    group = kinematic("snn", 3)
    job = jobs(Environment(), 4, 1)
    with pytest.raises(InputError, match="expected \\(3, 3\\)"):
        list(group.trajectories(job, 5))


def test_members_with_a_goal_go_there() -> None:
    """A single member of Couzin's law that starts along x and prefers -y: its direction is soon -y."""
    group = kinematic(
        "couzin", 1, law_parameters={"speed_m_s": 2.0, "omega": 1.0, "noise_rad": 0.0}, goal_x_m=0.0, goal_y_m=-1e9
    )
    (positions,) = group.trajectories([Job(Environment(), np.zeros((1, 3)), (1,))], 60)
    last = positions[-1, 0] - positions[-2, 0]
    assert np.hypot(*last) == pytest.approx(2.0)
    assert last[1] == pytest.approx(-2.0, abs=0.02)
    (straight,) = kinematic("couzin", 1, law_parameters={"speed_m_s": 2.0, "noise_rad": 0.0}).trajectories(
        [Job(Environment(), np.zeros((1, 3)), (1,))], 5
    )
    np.testing.assert_allclose(straight[-1, 0], (10.0, 0.0), atol=1e-9)
