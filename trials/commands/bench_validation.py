"""The part of `herd bench` on validation: splitting environments a second, and against the same rules not compiled."""

from __future__ import annotations

from collections.abc import Callable
from time import process_time

import numpy as np

from flocking.kinematic import plain
from flocking.kinematic.arrays import Bodies
from generation import found as schemas
from generation.group import Job
from generation.validation.kinematic import KinematicGroup, kinematic
from generation.validation.starts import Starts, poses

LAW, MEMBERS, ITERATIONS = "reynolds-boids", 25, 200
"""Fine 2015, section 7.2: BOIDS, the members of a group, and the iterations of a splitting behaviour (table 6.1)."""
FEWEST_WALLS, MOST_WALLS = 7, 15
ENVIRONMENTS = 100
STEPS = 2
"""Of the group that is not compiled."""


def environments(count: int) -> tuple[KinematicGroup, list[Job]]:
    """So many environments of the splitting grammar, and a group of boids at its start in each."""
    schema, rng = schemas.load("splitting"), np.random.default_rng(1)
    parameters, workspace = schema.parameters(), schema.workspace()
    group = kinematic(LAW, MEMBERS)
    jobs: list[Job] = []
    while len(jobs) < count:
        environment = schema.generate(parameters, workspace, rng)
        if FEWEST_WALLS <= len(environment.walls()) <= MOST_WALLS:
            jobs.append(Job(environment, poses(environment, MEMBERS, Starts(), rng), (len(jobs),)))
    return group, jobs


def seconds(group: KinematicGroup, jobs: list[Job]) -> float:
    """Processor time of the simulation in one environment, of many."""
    started = process_time()
    for _ in group.trajectories(jobs, ITERATIONS):
        pass
    return (process_time() - started) / len(jobs)


def plain_seconds(group: KinematicGroup, job: Job) -> float:
    """The same in plain Python and NumPy, member by member, from its first few steps."""
    band = group.bands[0]
    heading = job.poses_w[:, 2]
    velocities = group.members[0].speed_m_s * np.column_stack([np.cos(heading), np.sin(heading)])
    turn_rates, contacts = np.zeros(MEMBERS), np.zeros((MEMBERS, 2), np.bool_)
    memory = np.zeros((MEMBERS, band.law.memory))
    state = Bodies(job.poses_w[:, :2].copy(), heading.copy(), velocities, turn_rates, contacts, memory)
    draws, walls = np.zeros((MEMBERS, band.law.draws)), job.environment.walls()
    started = process_time()
    for _ in range(STEPS):
        state = plain.step([band], state, [draws], group.dt_s, walls_w=walls)
    return (process_time() - started) / STEPS * ITERATIONS


def measured(repeated: Callable[..., tuple[float, ...]]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The runs of both figures: environments a second, and how many times faster than what is not compiled."""
    group, jobs = environments(ENVIRONMENTS)
    fast, slow = repeated(seconds, group, jobs), repeated(plain_seconds, group, jobs[0])
    return tuple(1.0 / s for s in fast), tuple(p / s for p, s in zip(slow, fast, strict=True))
