"""A trial's names and numbers made into a world full of robots with minds."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from functools import cache
from types import ModuleType
from typing import NamedTuple

import mujoco
import numpy as np

from flocking import lawentry
from flocking.errors import InputError
from flocking.parameters import filled
from flocking.selection import Chosen
from flocking.types import Floats
from robots import body as bodies
from sensing import association
from sensing.laser import hokuyo
from sensing.types import PipelineState, WorldTruth
from trials.simulations import spread
from trials.simulations.robots import information
from trials.simulations.robots.fields import (
    GroupFields,
    TrialFields,
    association_of,
    laser_of,
    of_group,
    of_trial,
    pipeline_of,
    world_of,
)
from trials.simulations.robots.knowledge import Knowledge
from trials.simulations.robots.log import SAMPLE_S
from trials.simulations.robots.obstacle_stage import ObstacleStage
from trials.simulations.robots.robot import Robot
from trials.simulations.robots.starts import check_starts, starting_poses
from trials.streams import Purpose, stream
from trials.types import Group, Trial
from worlds.assemble import World, build, prefix


@dataclass
class Herd:
    """A world and the robots in it, ready to run."""

    trial: Trial
    world: World
    robots: list[Robot]
    radii: Floats
    """(N,) of the robots, m."""
    silhouettes: Floats
    """(N,) of what a laser sees of them, m."""
    timestep: float
    needs_truth: frozenset[int]
    """Robots whose pipeline reads global knowledge."""

    def world_truth(self, k: int, poses_w: Floats) -> WorldTruth | None:
        """Global knowledge for robot k if its pipeline reads it."""
        if k not in self.needs_truth:
            return None
        return WorldTruth(
            poses_w,
            self.world.fleet.velocities(self.world.data),
            self.silhouettes,
            k,
            self.world.walls.segments,
        )


def assemble(trial: Trial, record: bool) -> Herd:
    """Builds the herd of a trial. Raises `InputError` for names and numbers that do not exist or fit."""
    groups = [group for group in trial.groups for _ in range(group.count)]
    numbers = [(g, k) for g, group in enumerate(trial.groups) for k in range(group.count)]
    if not groups:
        raise InputError("the trial has no robots: expected a count of at least 1 in some group")
    names = [f"{trial.groups[g].name}-{k + 1}" for g, k in numbers]
    check(trial)
    minds = [_mind(group) for group in trial.groups]
    timestep = of_trial(trial).timestep_s
    poses_w = starting_poses(trial)
    bodies = [minds[g].given.body for g, _ in numbers]
    world = build(trial.world, trial.world_parameters, bodies, names, poses_w, timestep)
    reads = [frozenset(minds[g].pipeline.READS) for g, _ in numbers]
    lasers = None
    if record or any("truth" not in r for r in reads):
        lasers = hokuyo.Lasers(
            world.model,
            [f"{prefix(name)}{body.mount('laser').site}" for name, body in zip(names, world.bodies, strict=True)],
            [int(root) for root in world.fleet.root_bodies],
            [laser_of(group) for group in groups],
        )
        if lasers.needs_history:
            world.observers.append(lasers.remember)
    robots = [
        _robot(trial, world, lasers, minds[g], g, k, index, reads[index], poses_w[index])
        for index, (g, k) in enumerate(numbers)
    ]
    return Herd(
        trial=trial,
        world=world,
        robots=robots,
        radii=np.array([body.radius for body in world.bodies]),
        silhouettes=np.array([body.silhouette_radius for body in world.bodies]),
        timestep=timestep,
        needs_truth=frozenset(i for i, r in enumerate(reads) if "truth" in r),
    )


def ticks(seconds: float, timestep: float, what: str, at_least: int) -> int:
    """A duration in whole physics steps; `InputError` if it is not a whole number of them."""
    count = seconds / timestep
    if abs(count - round(count)) > 1e-6 * max(1.0, count) or round(count) < at_least:
        raise InputError(
            f"{what} = {seconds:g} s: expected a multiple of the physics time step ({timestep:g} s), "
            f"at least {at_least * timestep:g} s"
        )
    return round(count)


class Mind(NamedTuple):
    """What the robots of a group share."""

    group: Group
    given: GroupFields
    pipeline: ModuleType
    law: lawentry.Law
    law_parameters: Floats
    selections: list[list[Chosen]]
    wanted: information.Wanted
    association: association.Parameters
    obstacle_stage: ObstacleStage


def _mind(group: Group) -> Mind:
    wanted = information.wanted(group)
    return Mind(
        group,
        of_group(group),
        pipeline_of(group),
        lawentry.load(group.law, group.law_source),
        np.array(information.parameters_of(group), dtype=np.float64),
        information.selections(group),
        wanted,
        association_of(group),
        ObstacleStage(group, wanted.needs),
    )


def _robot(
    trial: Trial,
    world: World,
    lasers: hokuyo.Lasers | None,
    mind: Mind,
    group_number: int,
    member: int,
    index: int,
    reads: frozenset[str],
    start_w: Floats,
) -> Robot:
    def draw(purpose: Purpose) -> np.random.Generator:
        return stream(trial.seed, trial.repeat, group_number + 1, member, purpose)

    group, given, law, wanted = mind.group, mind.given, mind.law, mind.wanted
    law_parameters, selections = mind.law_parameters, mind.selections
    if group.spread:
        usual = information.parameters_of(group)._asdict()
        own = dataclasses.replace(group, law_parameters=spread.parameters(trial, group_number, member, usual))
        law_parameters = np.array(information.parameters_of(own), dtype=np.float64)
        selections = information.selections(own)
    period, latency = clock(group.name, given, of_trial(trial).timestep_s)
    phase = int(draw(Purpose.PHASE).random() * period) if given.phase == "random" else 0
    informed = member < given.informed
    first = (given.speed_m_s, 0.0) if given.start_moving else (0.0, 0.0)
    world.fleet.command(index, *first)
    return Robot(
        index=index,
        name=f"{group.name}-{member + 1}",
        cruise_m_s=given.speed_m_s,
        period=period,
        latency=latency,
        next_tick=phase,
        pipeline=mind.pipeline,
        pipeline_state=_pipeline_state(mind),
        selections=selections,
        law=law,
        law_parameters=law_parameters,
        law_rng=draw(Purpose.LAW),
        range_rng=draw(Purpose.RANGE_NOISE),
        intensity_rng=draw(Purpose.INTENSITY_NOISE),
        reads=reads,
        body=world.bodies[index],
        fleet=world.fleet,
        lasers=lasers,
        knowledge=Knowledge(
            world.fleet,
            index,
            given.own_motion,
            start_w,
            np.array([given.goal_x_m, given.goal_y_m]) if informed else None,
            wanted.own_pose,
        ),
        association=association.Association(mind.association, wanted.needs) if wanted.associate else None,
        obstacle_stage=mind.obstacle_stage,
        role=1 if informed else given.role,
        memory=np.zeros(law.memory),
        dt=1.0 / given.rate_hz,
        command=first,
    )


def _pipeline_state(mind: Mind) -> PipelineState:
    group, pipeline = mind.group, mind.pipeline
    parameters = filled(pipeline.Parameters, group.pipeline_parameters, prefix=f"{group.name}.pipeline.")
    height_m = bodies.load(mind.given.body).mount("laser").height_m
    return pipeline.start(parameters, member_model(mind.given.body), height_m, hokuyo.ANGLES)


@cache
def member_model(body: str) -> mujoco.MjModel:
    """One robot alone: what a database of members is made from."""
    return bodies.load(body).spec().compile()


def check(trial: Trial) -> None:
    """Refuses, before anything is built, a trial whose names and numbers do not fit one another.

    Clocks must be whole numbers of physics steps, no robot may be told to drive faster than its body can, all must
    start apart and within the walls, and none may be able to
    leave its world behind. Raises `InputError`.
    """
    trial_fields = of_trial(trial)
    if not trial.groups:
        raise InputError("the trial has no robots: expected a group")
    ticks(SAMPLE_S, trial_fields.timestep_s, "the time between samples", at_least=1)
    radii: list[float] = []
    for number, group in enumerate(trial.groups):
        given = of_group(group)
        clock(group.name, given, trial_fields.timestep_s)
        pipeline_of(group)
        body = bodies.load(given.body)
        if given.speed_m_s > body.top_speed:
            raise InputError(
                f"{group.name}.speed_m_s = {given.speed_m_s:g}: expected at most {body.top_speed:g} m/s, the top speed "
                f"of body {body.name!r}"
            )
        radii += [body.radius] * given.count
        laser_of(group)
        association_of(group)
        information.check(group)
        spread.check(trial, number, information.parameters_of(group)._asdict())
        ObstacleStage(group, frozenset())
    module = world_of(trial)
    parameters = filled(module.Parameters, trial.world_parameters, prefix="world.")
    poses_w = starting_poses(trial)
    _check_reach(trial, trial_fields, float(module.free_length(parameters, max(radii))), poses_w, max(radii))
    names = [f"{group.name}-{k + 1}" for group in trial.groups for k in range(group.count)]
    check_starts(names, poses_w, np.array(radii), module.walls(parameters).segments)


def _check_reach(trial: Trial, given: TrialFields, free_length: float, poses_w: Floats, radius: float) -> None:
    fastest = max(of_group(group).speed_m_s for group in trial.groups)
    reach = float(np.abs(poses_w[:, 0]).max()) + fastest * given.duration_s
    if reach > free_length:
        needed = math.ceil(2 * (reach + radius))
        raise InputError(
            f"world {trial.world!r} reaches {free_length:.1f} m to each side and a robot could go {reach:.1f} m; "
            f"expected a longer one: --set world.length_m={needed}"
        )


def clock(name: str, given: GroupFields, timestep: float) -> tuple[int, int]:
    """Ticks between the updates of a robot of the group of that name, and from its sensing to its acting.

    Raises `InputError` if they are not whole.
    """
    period = ticks(1.0 / given.rate_hz, timestep, f"1 / {name}.rate_hz", at_least=1)
    return period, ticks(given.latency_s, timestep, f"{name}.latency_s", at_least=0)
