"""A trial's names and numbers made into a world with robots that are ready to run."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import NamedTuple

import mujoco
import numpy as np

from flocking import lawentry, lawparts
from flocking.errors import InputError
from flocking.types import Bools, Floats
from robots import body as bodies
from sensing import association
from sensing.camera import palette, setting
from sensing.camera.lens import Lens, column_angles
from sensing.camera.rendering import Cameras
from sensing.laser import hokuyo
from sensing.sonar import Sonars
from sensing.types import Echoes, PipelineState, WorldTruth
from trials.simulations import spread
from trials.simulations.robots import desires, guided, link, wire
from trials.simulations.robots.checks import check, check_start, clock
from trials.simulations.robots.fields import of_trial
from trials.simulations.robots.knowledge import Knowledge
from trials.simulations.robots.obstacle_stage import ObstacleStage
from trials.simulations.robots.resolved import LASER, SONAR, Resolved
from trials.simulations.robots.robot import Robot
from trials.simulations.robots.scenario import Guided
from trials.simulations.robots.seen import cone_of
from trials.simulations.robots.starts import starting_poses
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
    marked: Bools
    """(N,) which of them can be told as members."""
    timestep: float
    needs_truth: frozenset[int]
    """Robots whose pipeline reads global knowledge."""
    desired_w: Floats
    """(N, 2) how each robot would like to move by what it decided last, m/s."""
    scenario: Guided | None = None
    """What happens besides."""

    def close(self) -> None:
        """Ends the controllers that are processes of their own."""
        for robot in self.robots:
            if robot.link is not None:
                robot.link.close()

    def world_truth(self, k: int, poses_w: Floats) -> WorldTruth | None:
        """Global knowledge for robot k if its pipeline reads it."""
        if k not in self.needs_truth:
            return None
        return WorldTruth(
            poses_w,
            self.world.fleet.velocities(self.world.data),
            self.silhouettes,
            k,
            self.world.standing_w,
            self.marked,
            self.desired_w,
        )


def assemble(trial: Trial, record: bool) -> Herd:
    """Builds the herd of a trial. Raises `InputError` for names and numbers that do not exist or fit."""
    groups = [group for group in trial.groups for _ in range(group.count)]
    numbers = [(g, k) for g, group in enumerate(trial.groups) for k in range(group.count)]
    if not groups:
        raise InputError("the trial has no robots: expected a count of at least 1 in some group")
    names = [f"{trial.groups[g].name}-{k + 1}" for g, k in numbers]
    check(trial)
    check_start(trial)
    minds = [_mind(group) for group in trial.groups]
    timestep = of_trial(trial).timestep_s
    poses_w = starting_poses(trial)
    bodies = [minds[g].its.given.body for g, _ in numbers]
    standing = guided.segments(trial)
    world = build(trial.world, trial.world_parameters, bodies, names, poses_w, timestep, trial.world_source, standing)
    reads = [frozenset(minds[g].its.pipeline.READS) for g, _ in numbers]
    lasers = None
    carried = all("laser" in body.mounts for body in world.bodies)
    if (record and carried) or any(r & LASER for r in reads):
        lasers = hokuyo.Lasers(
            world.whole,
            [f"{prefix(name)}{body.mount('laser').site}" for name, body in zip(names, world.bodies, strict=True)],
            [int(root) for root in world.fleet.root_bodies],
            [minds[g].its.laser for g, _ in numbers],
            [body.marked for body in world.bodies],
        )
        if lasers.needs_history:
            world.observers.append(lasers.remember)
    cameras = _cameras(world, [minds[g].its for g, _ in numbers])
    listeners = _listeners(world, [minds[g].its for g, _ in numbers])
    robots = [
        _robot(trial, world, lasers, cameras, listeners[index], minds[g], g, k, index, reads[index], poses_w[index])
        for index, (g, k) in enumerate(numbers)
    ]

    def tell(index: int, goal_w: Floats) -> None:
        robots[index].knowledge.goal_w = goal_w

    return Herd(
        trial=trial,
        world=world,
        robots=robots,
        radii=np.array([body.radius for body in world.bodies]),
        silhouettes=np.array([body.silhouette_radius for body in world.bodies]),
        marked=np.array([body.marked for body in world.bodies]),
        timestep=timestep,
        needs_truth=frozenset(i for i, r in enumerate(reads) if "truth" in r),
        desired_w=np.array([desires.turned(np.array([r.command[0], 0.0]), poses_w[r.index, 2]) for r in robots]),
        scenario=Guided(trial, world, tell) if guided.has_task(trial) else None,
    )


class Mind(NamedTuple):
    """What the robots of a group share: its names resolved, its compiled law, and its obstacle stage."""

    its: Resolved
    law: lawentry.Law
    parts: lawparts.Parts | None
    """Of the law, where its controller is a process of its own."""
    obstacle_stage: ObstacleStage


def _mind(group: Group) -> Mind:
    its = Resolved(group)
    law = lawentry.load(group.law, group.law_source)
    parts = lawparts.load(law) if its.given.link != wire.IN_PROCESS else None
    return Mind(its, law, parts, ObstacleStage(its))


def _robot(
    trial: Trial,
    world: World,
    lasers: hokuyo.Lasers | None,
    cameras: Cameras | None,
    listen: Callable[[mujoco.MjData], Echoes] | None,
    mind: Mind,
    group_number: int,
    member: int,
    index: int,
    reads: frozenset[str],
    start_w: Floats,
) -> Robot:
    def draw(purpose: Purpose) -> np.random.Generator:
        return stream(trial.seed, trial.repeat, group_number + 1, member, purpose)

    its, law = mind.its, mind.law
    group, given, wanted = its.group, its.given, its.wanted
    if group.spread:
        usual = its.law_parameters._asdict()
        its = Resolved(dataclasses.replace(group, law_parameters=spread.parameters(trial, group_number, member, usual)))
    period, latency = clock(group.name, given, of_trial(trial).timestep_s)
    phase = int(draw(Purpose.PHASE).random() * period) if given.phase == "random" else 0
    informed = member < given.informed
    first = (given.speed_m_s, 0.0) if given.start_moving else (0.0, 0.0)
    world.fleet.command(index, *first)
    parameters, dt = np.array(its.law_parameters, dtype=np.float64), 1.0 / given.rate_hz
    controller = None
    if mind.parts is not None:
        way = link.Way(given.link, given.link_address)
        own = link.Mind(mind.parts, parameters, np.zeros(law.memory), draw(Purpose.LAW), law.draws, dt)
        controller = link.Link(index, way, own)
    return Robot(
        index=index,
        name=f"{group.name}-{member + 1}",
        cruise_m_s=given.speed_m_s,
        period=period,
        latency=latency,
        next_tick=phase,
        pipeline=its.pipeline,
        pipeline_state=_pipeline_state(its),
        selections=its.selections,
        law=law,
        law_parameters=parameters,
        law_rng=draw(Purpose.LAW),
        range_rng=draw(Purpose.RANGE_NOISE),
        intensity_rng=draw(Purpose.INTENSITY_NOISE),
        reads=reads,
        body=world.bodies[index],
        fleet=world.fleet,
        lasers=lasers,
        cameras=cameras if its.reads_images else None,
        listen=listen,
        judged=its.cameras.judged,
        imperfections=its.imperfections,
        image_rng=draw(Purpose.IMAGES),
        needs=("velocities" in wanted.of_each, "headings" in wanted.of_each),
        told_desired=given.velocities == desires.DESIRED,
        knowledge=Knowledge(
            world.fleet,
            index,
            given.own_motion,
            start_w,
            np.array([given.goal_x_m, given.goal_y_m]) if informed else None,
            wanted.own_pose,
        ),
        association=association.Association(its.association, wanted.of_each) if wanted.associate else None,
        obstacle_stage=mind.obstacle_stage,
        role=1 if informed else given.role,
        memory=np.zeros(law.memory),
        dt=dt,
        link=controller,
        command=first,
    )


def _cameras(world: World, robots: Sequence[Resolved]) -> Cameras | None:
    """The cameras of all robots whose detection reads images; None where nobody's does: nothing needs OpenGL then."""
    if not any(its.reads_images for its in robots):
        return None
    lenses = [setting.lens_of(its.cameras) if its.reads_images else None for its in robots]
    colours = None
    if any(its.reads_images and its.cameras.colours == setting.ONE_EACH for its in robots):
        colours = [palette.rgb(k) for k in range(len(robots))]
    return Cameras(world.seen(), [prefix(name) for name in world.names], lenses, colours=colours)


def _listeners(world: World, robots: Sequence[Resolved]) -> list[Callable[[mujoco.MjData], Echoes] | None]:
    """For each robot what its sonars hear; None where nobody asks for that: no sonar is then read."""
    found: list[Callable[[mujoco.MjData], Echoes] | None] = [None] * len(robots)
    for body in {its.body.name: its.body for its in robots if its.hears}.values():
        its_own = [k for k, its in enumerate(robots) if its.hears and its.body.name == body.name]
        sites = [f"{prefix(world.names[k])}{body.mount(SONAR).site}" for k in its_own]
        sonars = Sonars(world.whole, sites, [int(world.fleet.root_bodies[k]) for k in its_own])
        for number, k in enumerate(its_own):
            found[k] = partial(sonars.listen, k=number, cone=cone_of(body.name))
    return found


@cache
def _both_angles(lens: Lens) -> Floats:
    """(2, W) the bearing of each column of the left and of the right image, in the camera's frame."""
    return np.stack([column_angles(lens)] * 2)


def _pipeline_state(its: Resolved) -> PipelineState:
    if its.reads_images:
        height_m, angles = its.body.mount("cameras").height_m, _both_angles(setting.lens_of(its.cameras))
        return its.pipeline.start(its.pipeline_parameters, member_model(its.given.body), height_m, angles)
    laser = its.body.mounts.get("laser")
    height_m = laser.height_m if laser is not None else math.nan  # of a detection that reads no laser
    return its.pipeline.start(its.pipeline_parameters, member_model(its.given.body), height_m, hokuyo.ANGLES)


@cache
def member_model(body: str) -> mujoco.MjModel:
    """The model of one robot alone, from which the database of members' shapes is made."""
    return bodies.load(body).spec().compile()
