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

from flocking import found, lawentry
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
from trials.simulations.robots.knowledge import Knowledge
from trials.simulations.robots.log import SAMPLE_S
from trials.simulations.robots.obstacle_stage import ObstacleStage
from trials.simulations.robots.robot import Robot
from trials.streams import Purpose, stream
from trials.types import Group, Trial
from worlds import formations
from worlds.assemble import World, build, prefix

PIPELINE, WORLD = "sensing.pipelines", "worlds"


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
    start = stream(trial.seed, trial.repeat, 0, 0, Purpose.START)
    poses_w = formations.poses(trial.formation, len(groups), start)
    world = build(
        trial.world,
        trial.world_parameters,
        [group.body for group in groups],
        names,
        poses_w,
        trial.timestep_s,
    )
    minds = [_mind(group) for group in trial.groups]
    reads = [frozenset(minds[g].pipeline.READS) for g, _ in numbers]
    lasers = None
    if record or any("truth" not in r for r in reads):
        lasers = hokuyo.Lasers(
            world.whole,
            [f"{prefix(name)}{body.mount('laser').site}" for name, body in zip(names, world.bodies, strict=True)],
            [int(root) for root in world.fleet.root_bodies],
            [laser_parameters(group) for group in groups],
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
        timestep=trial.timestep_s,
        needs_truth=frozenset(i for i, r in enumerate(reads) if "truth" in r),
    )


def laser_parameters(group: Group) -> hokuyo.Parameters:
    """The laser's parameters: the named setting with the group's own values in place."""
    if group.sensors not in hokuyo.SETTINGS:
        from flocking.errors import unknown_name

        raise unknown_name("sensor setting", group.sensors, hokuyo.SETTINGS)
    setting = hokuyo.SETTINGS[group.sensors]
    changed = filled(hokuyo.Parameters, group.sensor_parameters, prefix=f"{group.name}.sensors.")
    return setting._replace(**{name: getattr(changed, name) for name in group.sensor_parameters})


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
        found.load(PIPELINE, group.pipeline, "pipeline"),
        lawentry.load(group.law, group.law_source),
        np.array(information.parameters_of(group), dtype=np.float64),
        information.selections(group),
        wanted,
        filled(association.Parameters, group.association_parameters, prefix=f"{group.name}.association."),
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

    group, law, wanted = mind.group, mind.law, mind.wanted
    law_parameters, selections = mind.law_parameters, mind.selections
    if group.spread:
        usual = information.parameters_of(group)._asdict()
        own = dataclasses.replace(group, law_parameters=spread.parameters(trial, group_number, member, usual))
        law_parameters = np.array(information.parameters_of(own), dtype=np.float64)
        selections = information.selections(own)
    period, latency = clock(group, trial.timestep_s)
    phase = int(draw(Purpose.PHASE).random() * period) if group.phase == "random" else 0
    informed = member < group.informed
    first = (group.speed_m_s, 0.0) if group.start_moving else (0.0, 0.0)
    world.fleet.command(index, *first)
    return Robot(
        index=index,
        name=f"{group.name}-{member + 1}",
        group=group,
        period=period,
        latency=latency,
        next_tick=phase,
        pipeline=mind.pipeline,
        pipeline_state=_pipeline_state(group, mind.pipeline, world.bodies[index]),
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
            group.own_motion,
            start_w,
            np.array([group.goal_x_m, group.goal_y_m]) if informed else None,
            wanted.own_pose,
        ),
        association=association.Association(mind.association, wanted.needs) if wanted.associate else None,
        obstacle_stage=mind.obstacle_stage,
        role=1 if informed else group.role,
        memory=np.zeros(law.memory),
        dt=1.0 / group.rate_hz,
        command=first,
    )


def _pipeline_state(group: Group, pipeline: ModuleType, body: bodies.Body) -> PipelineState:
    parameters = filled(pipeline.Parameters, group.pipeline_parameters, prefix=f"{group.name}.pipeline.")
    blind = frozenset(pipeline.READS) <= {"truth"} and "laser" not in body.mounts
    height_m = math.nan if blind else body.mount("laser").height_m
    return pipeline.start(parameters, member_model(body.name), height_m, hokuyo.ANGLES)


@cache
def member_model(body: str) -> mujoco.MjModel:
    """One robot alone: what a database of members is made from."""
    return bodies.load(body).spec().compile()


def check(trial: Trial) -> None:
    """Refuses, before anything is built, a trial whose numbers do not fit one another.

    Clocks must be whole numbers of physics steps, no robot may be told to drive faster than its body can, and none may
    be able to leave its world behind. Raises `InputError`.
    """
    ticks(SAMPLE_S, trial.timestep_s, "the time between samples", at_least=1)
    for number, group in enumerate(trial.groups):
        clock(group, trial.timestep_s)
        found.load(PIPELINE, group.pipeline, "pipeline")
        body = bodies.load(group.body)
        if group.speed_m_s > body.top_speed:
            raise InputError(
                f"{group.name}.speed_m_s = {group.speed_m_s:g}: expected at most {body.top_speed:g} m/s, the top speed "
                f"of body {body.name!r}"
            )
        laser_parameters(group)
        information.check(group)
        spread.check(trial, number, information.parameters_of(group)._asdict())
        ObstacleStage(group, frozenset())
    module = found.load(WORLD, trial.world, "world")
    radius = max(bodies.load(group.body).radius for group in trial.groups)
    free_length = module.free_length(filled(module.Parameters, trial.world_parameters, prefix="world."), radius)
    count = sum(group.count for group in trial.groups)
    poses_w = formations.poses(trial.formation, count, stream(trial.seed, trial.repeat, 0, 0, Purpose.START))
    fastest = max(group.speed_m_s for group in trial.groups)
    reach = float(np.abs(poses_w[:, 0]).max()) + fastest * trial.duration_s
    if reach > free_length:
        needed = math.ceil(2 * (reach + radius))
        raise InputError(
            f"world {trial.world!r} reaches {free_length:.1f} m to each side and a robot could go {reach:.1f} m; "
            f"expected a longer one: --set world.length_m={needed}"
        )


def clock(group: Group, timestep: float) -> tuple[int, int]:
    """Ticks between a robot's updates, and from sensing to acting. Raises `InputError` if they are not whole."""
    period = ticks(1.0 / group.rate_hz, timestep, f"1 / {group.name}.rate_hz", at_least=1)
    return period, ticks(group.latency_s, timestep, f"{group.name}.latency_s", at_least=0)
