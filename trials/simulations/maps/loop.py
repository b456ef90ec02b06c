"""Runs a trial that maps a schema: judges configurations, refines around successes, and measures the region."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flocking.errors import InputError
from flocking.kinematic import LawFailedError
from flocking.types import Floats, Ints
from generation.environment import Environment
from generation.group import Job
from generation.maps.flips import flip
from generation.maps.judging import Judging, control, jobs_of, judge
from generation.maps.trees import Judged, ParameterMap, StoppedError, refined, scattered
from trials.simulations import watch
from trials.simulations.environments.loop import poses_of
from trials.simulations.environments.members import Members
from trials.simulations.kinematic import fields as of_members
from trials.simulations.kinematic import herd as kinematic
from trials.simulations.maps import fields
from trials.simulations.maps.measures import measure
from trials.streams import Purpose, stream
from trials.types import Trial, TrialResult, no_contacts, no_updates

MAPPING = 9
"""Of the random numbers of configurations, beside the purposes of `trials.streams`."""


def run_trial(trial: Trial, scans: str = "none", reraise: bool = False, folder: Path | None = None) -> TrialResult:
    """Runs one trial and measures it; the same `Trial` gives the same result.

    A law or a behaviour that gives what it must not ends the trial: `outcome` is then `failed` and `reason` says why;
    with `reraise` the error is raised instead. Raises `InputError` for a trial that cannot be set up.
    """
    import flocking.kinematic.kernel  # noqa: F401 (its import compiles it: here, since no watch is on yet)

    began = perf_counter()
    chosen = fields.chosen_by(trial)
    judging = judging_of(trial, chosen)
    built, outcome, reason, map_, alone = perf_counter(), "done", "", None, None
    try:
        with watch.watched():
            map_ = mapped(trial, chosen, judging, watch.breathe)
            alone = control(judging, map_)
    except (LawFailedError, InputError) as error:
        if reraise:
            raise
        outcome, reason = "failed", " ".join(str(error).split())
    measures = measure(map_, chosen.within, alone) if map_ is not None and alone is not None else {}
    timing = {"build_s": built - began, "loop_s": perf_counter() - built}
    result = _result(trial, chosen, judging, map_, outcome, reason)
    return dataclasses.replace(result, measures=measures, timing=timing)


def judging_of(trial: Trial, chosen: fields.Chosen) -> Judging:
    """By what a trial judges configurations. Raises `InputError` for a herd that does not fit."""
    return Judging(
        chosen.schema,
        chosen.of_schema,
        chosen.behaviour,
        chosen.of_behaviour,
        herd_of(trial),
        chosen.iterations,
        fields.of_trial(trial).pairs,
        fields.starts_of(trial),
        (trial.seed, trial.repeat, MAPPING),
    )


def mapped(
    trial: Trial,
    chosen: fields.Chosen,
    judging: Judging,
    breathe: Callable[[int], None],
    told: Callable[[Judged], None] = lambda judged: None,
    stops: list[bool] | None = None,
) -> ParameterMap:
    """The map of a trial. `breathe` is called for each configuration; `told` is given each iteration's outcomes.

    With a list `stops`, to which true is then added, Ctrl-C ends the map with the iterations before, or, in the first
    one, raises `StoppedError`.
    """
    given, box = fields.of_trial(trial), chosen.box
    rng = stream(trial.seed, trial.repeat, 0, 0, Purpose.PARAMETERS)

    def judged(points: Floats, levels: Ints, cells: Ints) -> Judged:
        try:
            found = judge(judging, box, points, levels, cells, breathe)
        except KeyboardInterrupt:
            if stops is None:
                raise
            stops.append(True)
            raise StoppedError from None
        told(found)
        return found

    if given.method == fields.RANDOM:
        return scattered(box, judged, given.budget, given.reliable_share, rng)
    return refined(box, judged, given.refinements, given.reliable_share, given.budget, rng, given.splits)


def herd_of(trial: Trial) -> Members:
    """The herd of a trial. Raises `InputError` for names and numbers that do not exist or fit."""
    speeds = np.repeat(
        [of_members.of_group(group).speed_m_s for group in trial.groups], [group.count for group in trial.groups]
    )
    bands = [dataclasses.replace(band, sight_lines=True) for band in kinematic.bands_of(trial, np.zeros(2))]
    return Members(tuple(bands), fields.of_trial(trial).timestep_s, speeds)


def map_of(trial: Trial, tables: Mapping[str, NDArray[Any]]) -> ParameterMap:
    """The map that a finished trial's tables hold."""
    box = fields.chosen_by(trial).box
    judged = Judged(tables["trials"], tables["successes"], tables["fitness"], tables["x_deviation"])
    reliable = fields.of_trial(trial).reliable_share
    return ParameterMap(box, tables["parameters"], tables["level"], tables["cell"], judged, reliable)


def _result(
    trial: Trial, chosen: fields.Chosen, judging: Judging, map_: ParameterMap | None, outcome: str, reason: str
) -> TrialResult:
    """A result whose way is the herd's in the most successful configuration, from its first start."""
    environment: Environment = chosen.schema.workspace()
    positions = np.zeros((1, judging.group.count, 2))
    if map_ is not None and map_.possible.any():
        shares = np.where(map_.possible, map_.judged.successes / np.maximum(map_.judged.trials, 1), -1.0)
        job = jobs_of(judging, map_, int(np.argmax(shares)))[0]
        environment, positions = job.environment, next(iter(judging.group.trajectories([job], chosen.iterations)))
    count = judging.group.count
    herd = herd_of(trial)
    return TrialResult(
        trial=trial,
        times=np.arange(len(positions), dtype=np.float64) * fields.of_trial(trial).timestep_s,
        poses_w=poses_of(positions),
        odometry=np.empty((0, count, 3)),
        bumpers=np.empty((0, count, 2), np.bool_),
        robot_names=tuple(f"{group.name}-{k + 1}" for group in trial.groups for k in range(group.count)),
        radii=np.repeat([band.radius_m for band in herd.bands], [band.count for band in herd.bands]),
        rules=(),
        walls_w=environment.walls(),
        period_m=np.nan,
        updates=no_updates(count),
        contacts=no_contacts(),
        scans=None,
        measures={},
        outcome=outcome,
        reason=reason,
        timing={},
        tables={} if map_ is None else _tables(map_) | flipped(judging, map_),
    )


def _tables(map_: ParameterMap) -> dict[str, NDArray[Any]]:
    return {
        "parameters": map_.points,
        "level": map_.levels,
        "cell": map_.cells,
        "trials": map_.judged.trials,
        "successes": map_.judged.successes,
        "fitness": map_.judged.fitness,
        "x_deviation": map_.judged.x_deviation,
    }


def flipped(judging: Judging, map_: ParameterMap) -> dict[str, NDArray[Any]]:
    """The herd's ways in the workspace alone and in the two nearest environments of opposite outcomes, from one start.

    The start is that, of those of the successful one, from which the fitness in both differs most.
    `flip_numbers` (2,) are the configurations, `flip_ways` (3, T, N, 2) the ways and `flip_walls` (3, W, 4) the walls,
    nan where an environment has fewer. Empty where no configuration succeeds or none fails.
    """
    found = flip(map_)
    if found is None:
        return {}
    good, bad = (jobs_of(judging, map_, number) for number in found)
    bad = [one._replace(poses_w=other.poses_w) for one, other in zip(bad, good, strict=True)]
    start = int(np.argmax(np.array(_fitness(judging, good)) - np.array(_fitness(judging, bad))))
    jobs = [good[start]._replace(environment=judging.schema.workspace()), good[start], bad[start]]
    walls = [job.environment.walls() for job in jobs]
    joined = np.full((len(jobs), max(map(len, walls)), 4), np.nan)
    for row, each in zip(joined, walls, strict=True):
        row[: len(each)] = each
    ways = np.array(list(judging.group.trajectories(jobs, judging.iterations)), dtype=np.float32)
    return {"flip_numbers": np.array(found), "flip_ways": ways, "flip_walls": joined}


def _fitness(judging: Judging, jobs: list[Job]) -> list[float]:
    ways = judging.group.trajectories(jobs, judging.iterations)
    behaviour, given = judging.behaviour, judging.of_behaviour
    return [behaviour.judged(way, job.environment, given) for job, way in zip(jobs, ways, strict=True)]
