"""What is refused before anything of a trial of robots is built."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from flocking import lawparts
from flocking.errors import InputError
from flocking.parameters import filled
from flocking.types import Floats
from robots import body as bodies
from sensing.camera import looking, palette, setting
from sensing.laser import hokuyo
from trials.simulations import judged, spread
from trials.simulations.robots import desires, guided, information, wire
from trials.simulations.robots.fields import (
    TOGETHER,
    GroupFields,
    TrialFields,
    environment_of,
    of_trial,
    world_of,
)
from trials.simulations.robots.log import SAMPLE_S
from trials.simulations.robots.resolved import Resolved
from trials.simulations.robots.starts import check_starts, starting_poses
from trials.types import Trial, compared
from worlds import start_poses
from worlds.starts import Starting


def check(trial: Trial) -> None:
    """Refuses a trial whose names and numbers do not fit one another: `InputError`.

    Clocks must be whole numbers of physics steps; no robot may be told to drive faster than its body can. Its start is
    `check_start`'s.
    """
    given = of_trial(trial)
    if not trial.groups:
        raise InputError("the trial has no robots: expected a group")
    ticks(SAMPLE_S, given.timestep_s, "the time between samples", at_least=1)
    groups = [Resolved(group) for group in trial.groups]
    for number, its in enumerate(groups):
        its.look_all_up()
        clock(its.group.name, its.given, given.timestep_s)
        if its.given.speed_m_s > its.body.top_speed:
            raise InputError(
                f"{its.group.name}.speed_m_s = {its.given.speed_m_s:g}: expected at most {its.body.top_speed:g} m/s, "
                f"the top speed of body {its.body.name!r}"
            )
        if given.timestep_s > its.body.longest_timestep:
            raise InputError(
                f"timestep_s = {given.timestep_s:g}: expected at most {its.body.longest_timestep:g} s with body "
                f"{its.body.name!r}"
            )
        _check_sensors(its, groups)
        _check_colours(its, sum(each.given.count for each in groups))
        _check_link(its)
        _check_velocities(its)
        information.check(its)
        spread.check(trial, number, its.law_parameters._asdict())
    environment_of(trial)
    judged.check(trial, given.behaviour)
    guided.check(trial, max(its.body.radius for its in groups))


def check_start(trial: Trial) -> None:
    """Refuses a trial whose robots do not all start apart and within the walls, or can reach the end of their world:
    `InputError`.

    Trials that differ in their laws and detections alone start alike.
    """
    of_groups = tuple((group.name, group.count, compared(group.setup)) for group in trial.groups)
    names = (
        "seed",
        "repeat",
        "world",
        "world_source",
        "world_parameters",
        "formation",
        "formation_source",
        "task_source",
        "setup",
    )
    _check_start(_Start((*(compared(getattr(trial, name)) for name in names), of_groups), trial))


class _Start(NamedTuple):
    """A trial by what its start follows from."""

    key: tuple[Any, ...]
    trial: Trial

    def __hash__(self) -> int:
        return hash(self.key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Start) and self.key == other.key


@lru_cache(maxsize=10_000)
def _check_start(start: _Start) -> None:
    trial = start.trial
    given, world = of_trial(trial), world_of(trial)
    groups = [Resolved(group) for group in trial.groups]
    radii = np.repeat([its.body.radius for its in groups], [its.given.count for its in groups])
    poses_w = starting_poses(trial)
    widest, fastest = float(radii.max()), max(its.given.speed_m_s for its in groups)
    free = world.free_length(filled(world.parameters, trial.world_parameters, prefix="world."), widest)
    _check_reach(trial, given, poses_w, free, fastest, widest)
    names = [f"{group.name}-{k + 1}" for group in trial.groups for k in range(group.count)]
    drawn = not start_poses.is_file(trial.formation)
    together = [
        drawn and its.given.formation == TOGETHER and not guided.starts_by_task(trial, its.group)
        for its in groups
        for _ in range(its.given.count)
    ]
    check_starts(Starting(names, poses_w, radii, np.array(together)), environment_of(trial))


def _check_link(its: Resolved) -> None:
    """A controller of its own is for laws that have a message, and on loopback unless it is told otherwise."""
    given, name = its.given, its.group.name
    if given.link == wire.IN_PROCESS:
        return
    known = not callable(getattr(its.law, "law", None))  # of a user's law that is not executed here
    if not known and not lawparts.has_parts(its.law):
        raise InputError(
            f"{name}.link = {given.link!r}: law {its.group.law!r} has no message to a controller; expected "
            f"{wire.IN_PROCESS!r}, or a law that has one: {', '.join(lawparts.names())}"
        )
    if not wire.is_of_one_machine(given.link_address):
        raise InputError(
            f"{name}.link_address = {given.link_address!r} is no machine's own: nothing comes from it; expected an "
            "address of this machine, as 127.0.0.1 or ::1"
        )
    if not wire.is_loopback(given.link_address) and not given.link_beyond_loopback:
        raise InputError(
            f"{name}.link_address = {given.link_address!r} is not loopback: other machines reach it; expected "
            f"127.0.0.1 or ::1, or else --set {name}.link_beyond_loopback=true"
        )


def _check_velocities(its: Resolved) -> None:
    """Desired velocities are known to perfect detection alone."""
    if its.given.velocities == desires.DESIRED and "truth" not in its.pipeline_reads:
        raise InputError(
            f"{its.group.name}.velocities = {desires.DESIRED!r} with pipeline {its.group.pipeline!r}: no sensor shows "
            f"them; expected pipeline 'perfect', or {desires.ACTUAL!r}"
        )


def _check_sensors(its: Resolved, groups: Sequence[Resolved]) -> None:
    """A group whose detection reads a laser must have one, in the plane of all others: all scan one plane. One whose
    detection reads images must have cameras."""
    if its.reads_images and "cameras" not in its.body.mounts:
        raise InputError(
            f"body {its.body.name!r} of {its.group.name} carries no cameras, and {its.group.pipeline!r} reads them; "
            f"expected a body with cameras: {', '.join(bodies.carrying('cameras'))}"
        )
    if not its.reads_laser:
        return
    for other in groups:
        if "laser" not in other.body.mounts:
            raise InputError(
                f"body {other.body.name!r} of {other.group.name} carries no laser, and {its.group.pipeline!r} of "
                f"{its.group.name} reads one; expected bodies with lasers, or perfect detection"
            )
        apart = other.body.mount("laser").height_m - its.body.mount("laser").height_m
        if abs(apart) > hokuyo.SAME_HEIGHT_M:
            raise InputError(
                f"the lasers of {its.group.name} and {other.group.name} scan {abs(apart):g} m apart: expected bodies "
                "whose lasers are equally high"
            )


def _check_colours(its: Resolved, robots: int) -> None:
    """Cones of one colour a robot are for detections that tell them apart, and no more of them than there are."""
    name = its.group.name
    one_each = its.cameras.colours == setting.ONE_EACH
    if one_each and robots > palette.MOST_ROBOTS:
        raise InputError(
            f"{name}.cameras.colours = {setting.ONE_EACH!r} with {robots} robots: expected at most "
            f"{palette.MOST_ROBOTS} robots, or {setting.ORANGE!r}"
        )
    if not its.reads_images:
        return
    ranges, colours = its.pipeline_parameters.ranges, its.pipeline_parameters.colours
    if one_each and colours == 1:
        raise InputError(
            f"{name}.pipeline.colours = 1 with {name}.cameras.colours = {setting.ONE_EACH!r}: only orange cones would "
            f"be found; expected --set {name}.pipeline.colours={max(robots, 2)}, or cameras.colours = "
            f"{setting.ORANGE!r}"
        )
    if colours > 1 and ranges != looking.RANGES[0]:
        raise InputError(
            f"{name}.pipeline.ranges = {ranges!r} with {name}.pipeline.colours = {colours}: the published ranges are "
            f"of orange alone; expected {looking.RANGES[0]!r}, or pipeline.colours = 1"
        )


def _check_reach(
    trial: Trial, given: TrialFields, poses_w: Floats, free_length: float, fastest: float, radius: float
) -> None:
    """Refuses a trial that is so long that a robot could reach the end of its world: `InputError`.

    `fastest` (m/s) and `radius` (m): of the fastest and of the widest robot.
    """
    reach = float(np.abs(poses_w[:, 0]).max()) + fastest * given.duration_s
    if reach > free_length:
        needed = math.ceil(2 * (reach + radius))
        raise InputError(
            f"world {trial.world!r} reaches {free_length:.1f} m to each side and a robot could go {reach:.1f} m; "
            f"expected a longer one: --set world.length_m={needed}"
        )


def clock(name: str, given: GroupFields, timestep: float) -> tuple[int, int]:
    """Ticks from update to update of a robot, and from its sensing to its acting; `name`: its group's.

    Raises `InputError` if they are not whole.
    """
    period = ticks(1.0 / given.rate_hz, timestep, f"1 / {name}.rate_hz", at_least=1)
    return period, ticks(given.latency_s, timestep, f"{name}.latency_s", at_least=0)


def ticks(seconds: float, timestep: float, what: str, at_least: int) -> int:
    """A duration in whole physics steps; `InputError` if it is not a whole number of them."""
    count = seconds / timestep
    if abs(count - round(count)) > 1e-6 * max(1.0, count) or round(count) < at_least:
        raise InputError(
            f"{what} = {seconds:g} s: expected a multiple of the physics time step ({timestep:g} s), "
            f"at least {at_least * timestep:g} s"
        )
    return round(count)
