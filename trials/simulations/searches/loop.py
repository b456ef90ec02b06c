"""Runs a trial that searches a schema's parameters, or decomposes the construct that it makes."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from flocking.errors import InputError
from flocking.kinematic import LawFailedError
from flocking.types import Floats
from generation import decomposition
from generation.environment import Environment
from generation.group import Job
from generation.searches.methods import METHODS, Grid
from generation.searches.robustness import Robustness
from generation.searches.searching import search
from generation.validation.starts import axis, poses
from generation.validation.validate import empty
from trials.simulations import watch
from trials.simulations.environments.loop import poses_of
from trials.simulations.environments.members import Members
from trials.simulations.kinematic import fields as of_members
from trials.simulations.kinematic import herd as kinematic
from trials.simulations.searches import fields, measures
from trials.streams import Purpose, stream
from trials.types import Trial, TrialResult, no_contacts, no_updates

JUDGING, FRESH, BOUNDS, PIECES, SHOWN = range(20, 25)
"""Of the random numbers of simulations, beside the purposes of `trials.streams`."""


class _Found(NamedTuple):
    measures: dict[str, float]
    tables: dict[str, NDArray[Any]]
    shown: Environment
    """The best environment, or the construct that was decomposed."""


def run_trial(trial: Trial, scans: str = "none", reraise: bool = False, folder: Path | None = None) -> TrialResult:
    """Runs one trial and measures it; the same `Trial` gives the same result.

    A law or a behaviour that gives what it must not ends the trial: `outcome` is then `failed` and `reason` says why;
    with `reraise` the error is raised instead. Raises `InputError` for a trial that cannot be set up.
    """
    import flocking.kinematic.kernel  # noqa: F401 (its import compiles it: here, since no watch is on yet)

    began = perf_counter()
    chosen = fields.chosen_by(trial)
    run = _decomposed if fields.of_trial(trial).method == fields.DECOMPOSITION else _searched
    members(trial, trial.groups[0].count)
    built, outcome, reason = perf_counter(), "done", ""
    found = _Found({}, {}, chosen.schema.workspace())
    way = np.zeros((1, sum(group.count for group in trial.groups), 2))
    try:
        with watch.watched():
            found = run(trial, chosen)
            way = _way(trial, chosen, found.shown)
    except (LawFailedError, InputError) as error:
        if reraise:
            raise
        outcome, reason = "failed", " ".join(str(error).split())
    timing = {"build_s": built - began, "loop_s": perf_counter() - built}
    return dataclasses.replace(_result(trial, found, way, outcome, reason), timing=timing)


def members(trial: Trial, count: int) -> Members:
    """The herd of a trial with so many members of its first group. Raises `InputError` for what does not fit."""
    first, *others = trial.groups
    trial = dataclasses.replace(trial, groups=(dataclasses.replace(first, count=count), *others))
    speeds = np.repeat(
        [of_members.of_group(group).speed_m_s for group in trial.groups], [group.count for group in trial.groups]
    )
    bands = [dataclasses.replace(band, sight_lines=True) for band in kinematic.bands_of(trial, np.zeros(2))]
    return Members(tuple(bands), fields.of_trial(trial).timestep_s, speeds)


def robustness_of(trial: Trial, chosen: fields.Chosen) -> Robustness:
    """What a trial maximises. Raises `InputError` for a herd that does not fit."""
    return Robustness(
        chosen.schema,
        chosen.schema.workspace(),
        chosen.behaviour,
        chosen.of_behaviour,
        tuple(members(trial, count) for count in fields.counts_of(trial)),
        chosen.starts,
        chosen.iterations,
        fields.of_search(trial).ends_m,
        fields.archive_of(trial)[0],
        watch.breathe,
    )


def grid_of(trial: Trial, chosen: fields.Chosen) -> Grid:
    """The archive of a trial, which is the same whatever its method."""
    space, seed = fields.space_searched(trial, chosen), _seed(trial, BOUNDS)
    bounds = robustness_of(trial, chosen).bounds(space, np.random.default_rng(seed), seed)
    return Grid(bounds, fields.archive_of(trial)[1])


def _searched(trial: Trial, chosen: fields.Chosen) -> _Found:
    given, space, goal = fields.of_search(trial), fields.space_searched(trial, chosen), robustness_of(trial, chosen)
    grid, each = grid_of(trial, chosen), 2 * given.pairs
    rng = stream(trial.seed, trial.repeat, 0, 0, Purpose.PARAMETERS)
    proposals = METHODS[fields.of_trial(trial).method](space, grid, rng)
    found = search(proposals, goal.judge(space, _seed(trial, JUDGING), each), fields.points_of(trial))
    incumbents, (cells, elites) = found.incumbents(), found.elites(grid)
    seed = _seed(trial, FRESH)

    def anew(points: Floats, pairs: int) -> Floats:
        return goal.robustness([space.at(point) for point in points], seed, 2 * pairs)

    control = goal.control(chosen.of_schema, seed, 2 * given.best_pairs)
    fresh = measures.Fresh(
        anew(found.points[incumbents], given.best_pairs), anew(found.points[elites], given.elite_pairs), control
    )
    shown = goal.environment(space.at(found.points[found.best]), seed, 0) or goal.workspace
    return _Found(
        measures.of_search(found, grid, fresh, each, given.robust_share, shown.fence_length()),
        {
            "parameters": space.values(found.points),
            "robustness": found.values,
            "descriptors": found.descriptors,
            "bounds": grid.bounds,
            "incumbents": incumbents,
            "incumbents_anew": fresh.incumbents,
            "cells": cells,
            "elites": elites,
            "elites_anew": fresh.elites,
            "construct": shown.construct_walls(),
        },
        shown,
    )


def _decomposed(trial: Trial, chosen: fields.Chosen) -> _Found:
    given = fields.of_pieces(trial)
    rng = stream(trial.seed, trial.repeat, 0, 0, Purpose.WORLD)
    whole = chosen.schema.generate(chosen.of_schema, chosen.schema.workspace(), rng)
    areas = fields.regions_of(trial)
    if areas:
        pieces = decomposition.regions(whole.construct, areas)
    else:
        pieces = decomposition.windows(whole.construct, given.window_m, given.stride_m)
    done = decomposition.elicited(
        pieces, whole, members(trial, trial.groups[0].count), chosen.starts, 2 * given.pairs, chosen.iterations,
        given.cut_m, _seed(trial, PIECES), watch.breathe,
    )  # fmt: skip
    found = decomposition.clustered(done.means, done.scales)
    walls = [Environment(construct=piece.primitives).construct_walls() for piece in pieces]
    return _Found(
        measures.of_pieces(done, found),
        {
            "piece_walls": np.concatenate(walls),
            "piece_of_wall": np.repeat(np.arange(len(walls)), [len(each) for each in walls]),
            "labels": found.labels,
            "medoids": found.medoids,
            "silhouettes": found.silhouettes,
            "means": done.means,
            "effects": done.effects,
            "scales": done.scales,
            "active": measures.active(done),
            "construct": whole.construct_walls(),
        },
        whole,
    )


def _seed(trial: Trial, purpose: int) -> tuple[int, int, int]:
    return trial.seed, trial.repeat, purpose


def _way(trial: Trial, chosen: fields.Chosen, environment: Environment) -> Floats:
    """(T, N, 2) the way of the herd, as it is, in the environment that is shown."""
    herd, seed = members(trial, trial.groups[0].count), _seed(trial, SHOWN)
    placed = poses(empty(environment), herd.count, chosen.starts, np.random.default_rng(seed))
    return next(iter(herd.trajectories([Job(environment, placed, seed)], chosen.iterations)))


def _result(trial: Trial, found: _Found, way: Floats, outcome: str, reason: str) -> TrialResult:
    count = sum(group.count for group in trial.groups)
    if outcome != "done":
        at = axis(found.shown)
        way = np.tile([at.x_m, at.y_m], (1, count, 1))
    herd = members(trial, trial.groups[0].count)
    return TrialResult(
        trial=trial,
        times=np.arange(len(way), dtype=np.float64) * fields.of_trial(trial).timestep_s,
        poses_w=poses_of(way),
        odometry=np.empty((0, count, 3)),
        bumpers=np.empty((0, count, 2), np.bool_),
        robot_names=tuple(f"{group.name}-{k + 1}" for group in trial.groups for k in range(group.count)),
        radii=np.repeat([band.radius_m for band in herd.bands], [band.count for band in herd.bands]),
        rules=(),
        walls_w=found.shown.walls(),
        period_m=np.nan,
        updates=no_updates(count),
        contacts=no_contacts(),
        scans=None,
        measures=found.measures,
        outcome=outcome,
        reason=reason,
        timing={},
        tables=found.tables,
    )


def curve_of(trial: Trial, tables: Mapping[str, NDArray[Any]]) -> tuple[Floats, Floats]:
    """Of a finished search, the simulations after each point (P,) and the best point so far on new starts (P,)."""
    each, count = 2 * fields.of_search(trial).pairs, len(tables["robustness"])
    holders = np.searchsorted(tables["incumbents"], np.arange(count), side="right") - 1
    return each * np.arange(1.0, count + 1.0), np.asarray(tables["incumbents_anew"][holders], np.float64)
