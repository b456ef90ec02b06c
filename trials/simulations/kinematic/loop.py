"""Runs a kinematic trial: its herd, simulated and measured, as the same `TrialResult` that a physical trial gives."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from time import perf_counter

import numpy as np

from flocking.kinematic import Failures, History, LawFailedError, Progress, Schedule, simulate
from flocking.types import Floats
from trials.simulations import judged, watch
from trials.simulations.kinematic import failures, fields, flocks, links
from trials.simulations.kinematic.herd import Herd, assemble
from trials.simulations.kinematic.measures import measure
from trials.streams import Purpose, stream
from trials.types import Trial, TrialResult, no_contacts, no_updates

FAILED_S = "failed_s"
"""The table (N,) of the times at which members failed, nan = never; only of trials in which members may."""


def run_trial(trial: Trial, scans: str = "none", reraise: bool = False, folder: Path | None = None) -> TrialResult:
    """Runs one trial and measures it; the same `Trial` gives the same result.

    A law that gives what it must not ends the trial: `outcome` is then `failed`, `reason` says why, and only the start
    is kept; with `reraise` the error is raised instead. Raises `InputError` for a trial that cannot be set up.
    """
    started = perf_counter()
    herd = assemble(trial)
    built = perf_counter()
    times, poses_w, outcome, reason = np.zeros(1), herd.poses_w[None], "done", ""
    counted: dict[str, float] = {}
    failing = failures.failures_of(trial)
    try:
        history = simulated(trial, herd, 1 if fields.every_step(trial) else herd.fields.every, failing)
        times, poses_w = history.times, history.poses_w
    except LawFailedError as error:
        if reraise:
            raise
        outcome, reason = "failed", " ".join(str(error).split())
    finished = perf_counter()
    given = fields.links_of(trial)
    if given is not None and outcome == "done":
        period = herd.space.size_m if herd.space.kind == "periodic" else None
        counted = links.measure(times, history.positions_w, history.velocities_w, given, period)
    if outcome == "done":
        counted |= judged.measure(trial, herd.fields.behaviour, history.positions_w)
    if outcome == "done" and fields.every_step(trial):
        times, poses_w = times[:: herd.fields.every], poses_w[:: herd.fields.every].copy()
    result = _result(trial, herd, times, poses_w, outcome, reason)
    if failing is not None:
        failed_s = failures.times_of(failing, herd.fields.timestep_s, herd.fields.steps)
        result = dataclasses.replace(result, tables={FAILED_S: failed_s})
    measures = measure(result, herd) | counted | _of_flocks(result) if outcome == "done" else {}
    if not herd.fields.keeps_way and len(times) > 2:
        result = dataclasses.replace(result, times=times[[0, -1]], poses_w=poses_w[[0, -1]])
    timing = {"build_s": built - started, "loop_s": finished - built}
    return dataclasses.replace(result, measures=measures, timing=timing)


def _of_flocks(result: TrialResult) -> dict[str, float]:
    """The measures of the first group's flocks; none where they are not measured."""
    given, first = fields.flocks_of(result.trial), result.trial.groups[0]
    if given is None:
        return {}
    failed_s = result.tables.get(FAILED_S, np.full(len(result.robot_names), np.nan))
    positions = result.poses_w[:, : first.count, :2]
    return flocks.measure(
        result.times, positions, failed_s[: first.count], given, fields.of_group(first).failure_time_s
    )


def simulated(trial: Trial, herd: Herd, every: int, failing: Failures | None = None) -> History:
    """The history of a trial's herd; one step in `every` is kept. Raises `LawFailedError`."""
    import flocking.kinematic.kernel  # noqa: F401 (its import compiles it: here, since no watch is on yet)

    given = herd.fields
    schedule = Schedule(given.timestep_s, given.steps, every, given.synchronous, given.updating == "forward")
    with watch.watched():
        return simulate(
            herd.bands,
            herd.poses_w,
            schedule,
            rng=stream(trial.seed, trial.repeat, 1, 0, Purpose.LAW),
            space=herd.space,
            speeds_m_s=herd.speeds,
            graph=herd.graph,
            progress=Progress(watch.breathe, watch.turn),
            failures=failing,
        )


def _result(trial: Trial, herd: Herd, times: Floats, poses_w: Floats, outcome: str, reason: str) -> TrialResult:
    """A result with no updates, odometry or bumpers: a kinematic herd has none."""
    count = len(herd.poses_w)
    poses_w[..., 2] = np.unwrap(poses_w[..., 2], axis=0)
    return TrialResult(
        trial=trial,
        times=times,
        poses_w=poses_w,
        odometry=np.empty((0, count, 3)),
        bumpers=np.empty((0, count, 2), np.bool_),
        robot_names=tuple(f"{group.name}-{k + 1}" for group in trial.groups for k in range(group.count)),
        radii=np.repeat([band.radius_m for band in herd.bands], [band.count for band in herd.bands]),
        rules=(),
        walls_w=np.array(herd.space.place().walls),
        period_m=float(herd.space.size_m) if herd.space.kind == "periodic" else np.nan,
        updates=no_updates(count),
        contacts=no_contacts(),
        scans=None,
        measures={},
        outcome=outcome,
        reason=reason,
        timing={},
    )
