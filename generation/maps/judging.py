"""How a configuration of a schema is judged: simulations in pairs of starts, each pair in one environment.

A pair is a start and its mirror image about the axis of the marker `start`. In a workspace that is its own mirror image
about it, whatever members do by chance they do as often the other way round: what is left is the construct's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from flocking.errors import InputError
from flocking.types import Floats, Ints
from generation.behaviours import Behaviour
from generation.environment import Environment
from generation.group import Group, Job
from generation.maps.spaces import Box
from generation.maps.trees import Judged, ParameterMap
from generation.schema import Schema
from generation.validation.starts import Starts, axis, mirrored, poses

AT_A_TIME = 64
"""Configurations whose simulations are handed to the group at a time."""
BEYOND = 7
"""Behind a configuration's random numbers: those of its group's own."""


class Judging(NamedTuple):
    """By what configurations are judged."""

    schema: Schema
    fixed: Any
    """The schema's `Parameters`: the values of those that are not refined."""
    behaviour: Behaviour
    of_behaviour: Any
    """Its parameters."""
    group: Group
    iterations: int
    pairs: int
    """Of starts."""
    starts: Starts
    """Drawn in the workspace alone."""
    seed: tuple[int, ...]


def judge(
    judging: Judging, box: Box, points: Floats, levels: Ints, cells: Ints, breathe: Callable[[int], None]
) -> Judged:
    """The outcomes of configurations (C, d): twice `pairs` simulations each. `breathe` is told how many are done.

    A configuration's random numbers are those of its place (level and cell) and of the seed alone. A schema that draws
    makes an environment anew for each pair. One that refuses the parameters (`InputError`) makes a configuration of no
    simulations.
    """
    workspace = judging.schema.workspace()
    count = len(points)
    found = Judged(np.zeros(count, np.int64), np.zeros(count, np.int64), np.full(count, np.nan), np.full(count, np.nan))
    for first in range(0, count, AT_A_TIME):
        numbers = range(first, min(first + AT_A_TIME, count))
        jobs: list[Job] = []
        for number in numbers:
            jobs += _jobs(judging, box, points[number], _names(levels[number], cells[number]), workspace)
            found.trials[number] = len(jobs)
        found.trials[numbers] = np.diff(found.trials[numbers], prepend=0)
        ways = judging.group.trajectories(jobs, judging.iterations) if jobs else iter(())
        _count(judging, jobs, ways, numbers, found, breathe)
    return found


def jobs_of(judging: Judging, map_: ParameterMap, number: int) -> list[Job]:
    """The simulations of a configuration of a map, as it was judged."""
    names = _names(map_.levels[number], map_.cells[number])
    return list(_jobs(judging, map_.box, map_.points[number], names, judging.schema.workspace()))


class Control(NamedTuple):
    """What the herd does in the workspace alone."""

    success: float
    """Share of the simulations that show the behaviour."""
    x_deviation: float
    """Mean standard deviation of the members along x at the end, m."""


def control(judging: Judging, map_: ParameterMap) -> Control:
    """The empty world's outcomes, from the same starts and random numbers as `AT_A_TIME` configurations of a map.

    They are the first that the schema makes something of; of a map without any, nan. What a herd does without a
    construct hangs on no parameter, so that it is the control of all of them.
    """
    workspace, jobs = judging.schema.workspace(), list[Job]()
    for number in np.flatnonzero(map_.possible)[:AT_A_TIME]:
        jobs += [job._replace(environment=workspace) for job in jobs_of(judging, map_, int(number))]
    if not jobs:
        return Control(np.nan, np.nan)
    fitness, deviations = [], []
    for way in judging.group.trajectories(jobs, judging.iterations):
        fitness.append(judging.behaviour.judged(way, workspace, judging.of_behaviour))
        deviations.append(way[-1, :, 0].std())
    return Control(float(np.mean([judging.behaviour.succeeds(value) for value in fitness])), float(np.mean(deviations)))


def _names(level: int, cell: Ints) -> tuple[int, ...]:
    """What tells the random numbers of one configuration from those of others."""
    return tuple(int(value) for value in (level + 1, *cell))


def _jobs(judging: Judging, box: Box, point: Floats, names: tuple[int, ...], workspace: Environment) -> Iterator[Job]:
    """The simulations of one configuration: a start and its mirror image, and the next pair."""
    rng = np.random.default_rng((*judging.seed, *names))
    of_schema, of_starts = rng.spawn(2)
    parameters = judging.fixed._replace(**dict(zip((axis.name for axis in box.axes), map(float, point), strict=True)))
    environment, again = workspace, True
    for number, (start, mirror) in enumerate(_pairs(judging, workspace, of_starts)):
        if again:
            before = of_schema.bit_generator.state
            try:
                environment = judging.schema.generate(parameters, workspace, of_schema)
            except InputError:
                return
            again = of_schema.bit_generator.state != before  # a schema that drew nothing makes the same again
        seed = (*judging.seed, *names, number, BEYOND)
        yield Job(environment, start, seed)
        yield Job(environment, mirror, seed)


def _pairs(judging: Judging, workspace: Environment, rng: np.random.Generator) -> Iterator[tuple[Floats, Floats]]:
    """The starts (N, 3) of a configuration, each with its mirror image: all drawn at once where members may be near."""
    count, pairs, mark = judging.group.count, judging.pairs, axis(workspace)
    if judging.starts.apart_m > 0.0:
        drawn = np.concatenate([poses(workspace, count, judging.starts, rng) for _ in range(pairs)])
    else:
        drawn = poses(workspace, count * pairs, judging.starts, rng)
    images = mirrored(drawn, mark)
    for first in range(0, count * pairs, count):
        yield drawn[first : first + count], images[first : first + count]


def _count(
    judging: Judging,
    jobs: list[Job],
    ways: Iterator[Floats],
    numbers: range,
    found: Judged,
    breathe: Callable[[int], None],
) -> None:
    """Adds up the outcomes of the configurations of these numbers, whose simulations come one after the other."""
    at = iter(zip(jobs, ways, strict=True))
    for number in numbers:
        fitness, deviations = [], []
        for _ in range(found.trials[number]):
            job, way = next(at)
            fitness.append(judging.behaviour.judged(way, job.environment, judging.of_behaviour))
            deviations.append(way[-1, :, 0].std())
        if fitness:
            found.successes[number] = sum(map(judging.behaviour.succeeds, fitness))
            found.fitness[number], found.x_deviation[number] = np.mean(fitness), np.mean(deviations)
        breathe(number)
