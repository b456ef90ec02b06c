"""The loop that runs a trial: every robot senses and acts on its own clock."""

from __future__ import annotations

import dataclasses
import heapq
import math
from pathlib import Path
from time import perf_counter

import numpy as np

from flocking.errors import InputError, StorageError
from flocking.types import Floats
from robots.fleets import fallen_at
from sensing.truth import judge
from trials.simulations import judged, watch
from trials.simulations.contract import StoppedError, Watcher
from trials.simulations.robots import desires, guided, link
from trials.simulations.robots.fields import iteration_s, of_group, of_trial
from trials.simulations.robots.herd import Herd, assemble
from trials.simulations.robots.knowledge import ODOMETRY
from trials.simulations.robots.log import SAMPLE_S, Log
from trials.simulations.robots.robot import LawError
from trials.types import Trial, TrialResult

ACT, SENSE, SAMPLE = range(3)
"""What an event does; of those at the same tick, acts come before all sensing, and samples last."""


class TrialError(RuntimeError):
    """A trial cannot go on; the message says why in one line."""


def run_trial(
    trial: Trial,
    scans: str = "none",
    reraise: bool = False,
    folder: Path | None = None,
    watcher: Watcher | None = None,
) -> TrialResult:
    """Runs one trial and measures it; the same `Trial` gives the same result.

    `scans`: which scans to keep for a recording: `none`, `some` (2 Hz) or `all`. They do not change the result;
    until they are recorded they are kept in a file without a name in `folder`, or where temporary files are.
    Any error ends the trial, such as a simulation in MuJoCo that diverges or a law that returns nan: `outcome` is then
    `failed`, `reason` says why, and what was measured until then is kept; with `reraise` the error is raised instead.
    `watcher`: who says when a wall has been cleared, in a trial that has a task, or stops it: `outcome` is then
    `stopped`. Raises `InputError` for a trial that
    cannot be set up.
    """
    from trials.simulations.robots.measures import measure
    from trials.simulations.robots.measures_eyes import eyes, has_eyes
    from trials.simulations.robots.measures_falls import falls
    from trials.simulations.robots.measures_guided import guidance
    from trials.simulations.robots.measures_odometry import reckoned
    from trials.simulations.robots.measures_splitting import splitting
    from trials.simulations.robots.measures_velocities import of_velocities

    if scans not in ("none", "some", "all"):
        raise InputError(f"scans {scans!r}: expected none, some or all")
    started = perf_counter()
    given = of_trial(trial)
    herd = assemble(trial, record=scans != "none")
    if watcher is not None and herd.scenario is not None:
        herd.scenario.watcher = watcher
    log = Log(trial, len(herd.robots), scans, folder=folder)
    built = perf_counter()
    outcome, reason = "done", ""
    try:
        run(herd, log, last=round(given.duration_s / given.timestep_s))
    except StorageError:
        raise
    except StoppedError:
        outcome, reason = "stopped", f"stopped at {herd.world.data.time:.2f} s"
    except Exception as error:
        if reraise:
            raise
        told = str(error) if isinstance(error, LawError | TrialError) else f"{type(error).__name__}: {error}"
        outcome, reason = "failed", f"{' '.join(told.split())} at {herd.world.data.time:.2f} s"
    finally:
        watch.end()
        herd.close()
    finished = perf_counter()
    result = log.result(
        names=herd.world.names,
        radii=herd.radii,
        rules=tuple(robot.rules for robot in herd.robots),
        walls_w=herd.world.walls.all,
        contacts=herd.world.contacts,
        outcome=outcome,
        reason=reason,
        timing={"build_s": built - started, "loop_s": finished - built},
    )
    if herd.scenario is not None:
        result = dataclasses.replace(result, tables=herd.scenario.tables())
    if len(result.times) == 0:
        return result
    found = measure(result) | _judged(result, given.behaviour)
    if herd.scenario is not None:
        found |= guidance(result)
    if has_eyes(trial):
        found |= eyes(result) | splitting(result)
    if any(of_group(each).own_motion == ODOMETRY for each in trial.groups):
        found |= reckoned(result)
    if any(robot.needs[0] for robot in herd.robots):
        found |= of_velocities(log.velocities())
    found |= falls(fallen_at(herd.world.fleet))
    found |= link.counts([robot.link for robot in herd.robots if robot.link is not None])
    return dataclasses.replace(result, measures=found)


def _judged(result: TrialResult, behaviour: str) -> dict[str, float]:
    """The measures by the trial's behaviour, of places at each of its iterations; none of a trial that failed.

    Robots that guide are not judged.
    """
    if behaviour == judged.NONE or result.outcome != "done":
        return {}
    every, times = iteration_s(result.trial), result.times
    at = every * np.arange(math.floor(times[-1] / every + 1e-9) + 1)
    herd = guided.herd(result.trial)
    places = result.poses_w[:, herd, :2].reshape(len(times), -1)
    positions = np.column_stack([np.interp(at, times, column) for column in places.T])
    return judged.measure(result.trial, behaviour, positions.reshape(len(at), -1, 2))


def run(herd: Herd, log: Log, last: int) -> None:
    """Runs the herd until tick `last`."""
    world, robots, data = herd.world, herd.robots, herd.world.data
    sample_every = round(SAMPLE_S / herd.timestep)
    events: list[tuple[int, int, int, tuple[float, float] | None]] = [(0, SAMPLE, 0, None)]
    events += [(robot.next_tick, SENSE, robot.index, None) for robot in robots]
    heapq.heapify(events)
    poses_tick, poses_w = -1, np.empty((0, 3))
    tells = any(robot.needs[0] for robot in robots)
    while events and events[0][0] <= last:
        tick, what, k, command = heapq.heappop(events)
        if tick > world.tick:
            world.advance(to=tick)
        if what == ACT and command is not None:
            robots[k].apply(command)  # 5 physical motion
            continue
        if tick != poses_tick:
            poses_tick, poses_w = tick, world.fleet.poses(data)
        if what == SAMPLE:
            _check(herd, poses_w)
            if herd.scenario is not None:
                herd.scenario.update(data.time, poses_w)
            log.sample(data.time, poses_w, world.fleet.odometry, world.fleet.bumpers)
            heapq.heappush(events, (tick + sample_every, SAMPLE, 0, None))
            continue
        robot = robots[k]
        keep = log.wants_scan(k, data.time)
        senses, truth = robot.sense(data, data.time, herd.world_truth(k, poses_w), record=keep)  # 1
        detection = robot.detect(senses)  # 2, and 6 obstacle detection
        heeded = robot.heed(detection)  # 7 obstacle selection
        sets = robot.select(heeded.members)  # 3
        watch.begin(tick, k)
        motion = robot.decide(heeded, sets)  # 4
        watch.end()
        motion = robot.avoid(motion, heeded)
        command = robot.drive(motion)  # 5, after the latency
        if tells:
            herd.desired_w[k] = desires.desired_w(motion, command, poses_w[k, 2], herd.desired_w[k])
        heapq.heappush(events, (tick + robot.latency, ACT, k, command))
        heapq.heappush(events, (tick + robot.period, SENSE, k, None))
        heeded_by_any = sets[0] if len(sets) == 1 else np.logical_or.reduce(sets)
        selected = heeded_by_any[: len(detection.members.ids)]  # virtual members come last
        judgement = judge(detection, truth, k, len(robots))
        log.update(data.time, k, poses_w[k], detection, selected, judgement, motion, command)
        if robot.needs[0]:
            told_w = desires.turned(detection.members.velocities, poses_w[k, 2])
            log.told(told_w, judgement.owners, world.fleet.velocities(data), herd.desired_w, robot.dropped)
        if keep and senses.scan is not None:
            log.scan(data.time, k, poses_w[k], senses.scan)
        if keep and senses.echoes is not None:
            log.listened(data.time, k, poses_w[k], senses.echoes, detection.obstacles)
        if keep and senses.images is not None:
            log.pictures.keep(k, senses.images, detection, robot.taken_for())


def _check(herd: Herd, poses_w: Floats) -> None:
    """Raises `TrialError` if MuJoCo's simulation diverged or a robot came to the end of its world."""
    world = herd.world
    # MuJoCo starts again from time 0 when positions, velocities or accelerations are no longer finite
    if not np.isfinite(poses_w).all() or abs(world.data.time - world.tick * herd.timestep) > 0.5 * herd.timestep:
        raise TrialError("physics diverged")
    if np.abs(poses_w[:, 0]).max() > world.free_length:
        raise TrialError(f"a robot reached the end of {herd.trial.world!r}")
