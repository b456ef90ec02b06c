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


def shown_job(judging: Judging, map_: ParameterMap, number: int) -> Job:
    """The first simulation of a configuration of a map, as it was judged."""
    names = _names(map_.levels[number], map_.cells[number])
    return next(_jobs(judging, map_.box, map_.points[number], names, judging.schema.workspace()))


def _names(level: int, cell: Ints) -> tuple[int, ...]:
    """What tells the random numbers of one configuration from those of others."""
    return tuple(int(value) for value in (level + 1, *cell))


def _jobs(judging: Judging, box: Box, point: Floats, names: tuple[int, ...], workspace: Environment) -> Iterator[Job]:
    """The simulations of one configuration: a start and its mirror image, and the next pair."""
    rng = np.random.default_rng((*judging.seed, *names))
    of_schema, of_starts = rng.spawn(2)
    parameters = judging.fixed._replace(**dict(zip((axis.name for axis in box.axes), map(float, point), strict=True)))
    environment, again, mark = workspace, True, axis(workspace)
    for number in range(judging.pairs):
        if again:
            before = of_schema.bit_generator.state
            try:
                environment = judging.schema.generate(parameters, workspace, of_schema)
            except InputError:
                return
            again = of_schema.bit_generator.state != before  # a schema that drew nothing makes the same again
        seed = (*judging.seed, *names, number, BEYOND)
        start = poses(workspace, judging.group.count, judging.starts, of_starts)
        yield Job(environment, start, seed)
        yield Job(environment, mirrored(start, mark), seed)


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
