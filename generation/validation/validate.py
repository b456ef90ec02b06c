"""Validation: each environment's fitness for a behaviour beside that of its empty world, on the same starts.

Source: Fine 2015, section 6.2, which simulates a group in each environment and holds the behaviour's fitness against a
threshold. It has no control; here the control of an environment is its workspace without the construct.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from flocking.errors import InputError
from flocking.types import Bools, Floats
from generation.behaviours import Behaviour
from generation.environment import Environment
from generation.group import Group, Job
from generation.validation.starts import Starts, axis, mirrored, poses
from generation.validation.uplift import Rate, Uplift, over_environments, paired, rate

AT_A_TIME = 256
"""Simulations that a group is handed at a time: what ends early is told early."""
START, GROUP = 0, 1
"""Purposes of random numbers: where members start, and what their laws draw."""


class Plan(NamedTuple):
    """How environments are tried."""

    starts: Starts = Starts()
    repeats: int = 1
    """Starts of each environment."""
    mirror: bool = False
    """Whether each start is followed by its mirror image on the environment's axis, so that chance takes no side."""
    seed: int = 1


ONCE = Plan()
"""One start in each environment."""


class Validated(NamedTuple):
    """One environment's outcome; R simulations."""

    number: int
    """Of the environment, from 0."""
    fitness: Floats
    """(R,)."""
    control: Floats
    """(R,) fitness in the empty world, on the same starts and random numbers."""
    succeeded: Bools
    """(R,)."""
    control_succeeded: Bools
    """(R,)."""

    @property
    def rate(self) -> Rate:
        """Of success."""
        return rate(self.succeeded)

    @property
    def control_rate(self) -> Rate:
        """Of success in the empty world."""
        return rate(self.control_succeeded)

    @property
    def uplift(self) -> Uplift:
        """What the construct adds."""
        return paired(self.succeeded, self.control_succeeded)


def empty(environment: Environment) -> Environment:
    """The control of an environment: its workspace and markers without the construct."""
    return dataclasses.replace(environment, construct=())


def jobs_of(environment: Environment, number: int, count: int, plan: Plan) -> list[Job]:
    """The simulations of environment `number`: its starts, each with its mirror image where the plan says so.

    A start and its mirror image have the same random numbers. Raises `InputError` where members find no room.
    """
    found = []
    for repeat in range(plan.repeats):
        rng = np.random.default_rng((plan.seed, number, repeat, START))
        try:
            placed = poses(environment, count, plan.starts, rng)
        except InputError as error:
            raise InputError(f"environment {number + 1}: {error}") from None
        seed = (plan.seed, number, repeat, GROUP)
        found.append(Job(environment, placed, seed))
        if plan.mirror:
            found.append(Job(environment, mirrored(placed, axis(environment)), seed))
    return found


def validate(
    environments: Sequence[Environment],
    behaviour: Behaviour,
    group: Group,
    plan: Plan = ONCE,
    parameters: Any = None,
    begin: int = 0,
) -> Iterator[Validated]:
    """Tries each environment and its empty world on the same starts, and yields its outcome as it comes.

    `parameters`: of the behaviour; its own by default. `begin`: the number of the first environment, where they are a
    part of more: its random numbers follow from it. Raises `InputError` for starts without room, a law that does not
    fit, and a behaviour that returns no number from 0 to 1: what was yielded before stands.
    """
    if plan.repeats < 1:
        raise InputError(f"{plan.repeats} repeats: expected at least 1")
    each = plan.repeats * (2 if plan.mirror else 1)
    block = max(1, AT_A_TIME // (2 * each))
    for first in range(0, len(environments), block):
        jobs: list[Job] = []
        numbers = range(first, min(first + block, len(environments)))
        failed: InputError | None = None
        for number in numbers:
            try:
                tried = jobs_of(environments[number], begin + number, group.count, plan)
            except InputError as error:  # what comes before it is tried first
                failed, numbers = error, range(first, number)
                break
            control = empty(environments[number])
            jobs += tried + [job._replace(environment=control) for job in tried]
        judged = _judged(group, behaviour, jobs, parameters)
        for number in numbers:
            fitness = np.array([next(judged) for _ in range(2 * each)])
            succeeded = np.array([behaviour.succeeds(value) for value in fitness])
            yield Validated(begin + number, fitness[:each], fitness[each:], succeeded[:each], succeeded[each:])
        if failed is not None:
            raise failed


def _judged(group: Group, behaviour: Behaviour, jobs: Sequence[Job], parameters: Any) -> Iterator[float]:
    for job, positions in zip(jobs, group.trajectories(jobs, behaviour.iterations), strict=True):
        yield behaviour.judged(positions, job.environment, parameters)


def overall(found: Sequence[Validated]) -> Uplift:
    """The uplift of all environments together: of independent pairs, or, with more starts than one each, their mean."""
    if all(len(one.fitness) == 1 for one in found):
        pairs = np.array([(one.succeeded[0], one.control_succeeded[0]) for one in found], np.bool_).reshape(-1, 2)
        return paired(pairs[:, 0], pairs[:, 1])
    if len(found) == 1:
        return found[0].uplift
    means = np.array([(one.succeeded.mean(), one.control_succeeded.mean()) for one in found])
    return over_environments(means[:, 0], means[:, 1])
