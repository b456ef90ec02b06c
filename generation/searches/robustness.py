"""What searches maximise: how robustly an environment elicits a behaviour.

The robustness of a schema's parameters is the success rate of the environments that they generate: the share of
simulations in which the herd shows the behaviour, each with a start of its own, with a construct whose ends are moved
at random (`generation.validation.robustness`, which has it kind by kind), and with one of several group sizes in turn.
Starts come in pairs, one and its mirror image about the herd's
direction: in a symmetric workspace without a construct a turn to one side then has a robustness of at most a half.
A stochastic schema generates a new construct for each simulation, so that its parameters are judged and no draw of it.

Members of a start and of its mirror image draw the same. Simulation k has the same random numbers whatever the
parameters, so that two of them differ by their environments alone, and the robustness is a function. What is the best
of many by luck of its draws is found out by another `seed`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from flocking.errors import InputError
from flocking.types import Floats
from generation.behaviours import Behaviour
from generation.environment import Environment
from generation.group import Group, Job
from generation.schema import Schema
from generation.searches import descriptors
from generation.searches.methods import Answer
from generation.searches.spaces import Space
from generation.validation.robustness import perturbed
from generation.validation.starts import Starts, axis, mirrored, poses
from generation.validation.validate import empty

START, CONSTRUCT, ENDS, MEMBERS = range(4)
"""What the random numbers of one simulation are for. Part of the seed, so that none may change."""


@dataclass(frozen=True)
class Robustness:
    """A schema, a behaviour and a herd, and how they are perturbed."""

    schema: Schema
    workspace: Environment
    behaviour: Behaviour
    of_behaviour: Any
    """The behaviour's `Parameters`."""
    groups: tuple[Group, ...]
    """The herd in each of its sizes."""
    starts: Starts
    """Drawn in the workspace alone, so that they are the same whatever the construct."""
    iterations: int
    ends_m: float
    """How far ends of the construct are moved at the most."""
    described_by: tuple[str, ...]
    """Names of `descriptors`."""
    told: Callable[[int], None] = lambda done: None
    """Is told of each simulation."""

    def environment(self, parameters: Any, seed: Sequence[int], k: int) -> Environment | None:
        """The environment of simulation k before it is perturbed; None where the schema refuses these parameters."""
        try:
            return self.schema.generate(parameters, self.workspace, np.random.default_rng([*seed, k, CONSTRUCT]))
        except InputError:
            return None

    def environments(self, points: Sequence[Any], seed: Sequence[int], count: int) -> list[list[Environment | None]]:
        """For each of n parameters the environments of `count` simulations, before they are perturbed."""
        return [[self.environment(parameters, seed, k) for k in range(count)] for parameters in points]

    def fitness(self, environments: Sequence[Sequence[Environment | None]], seed: Sequence[int]) -> Floats:
        """(n, K) the fitness in each of the environments, n times K, perturbed; nan where there is none."""
        found = np.full((len(environments), max(map(len, environments))), np.nan)
        for size, group in enumerate(self.groups):
            places, jobs = [], []
            drawn: dict[Any, Floats] = {}
            for n, row in enumerate(environments):
                for k, environment in enumerate(row):
                    if environment is None or k // 2 % len(self.groups) != size:
                        continue
                    mark = axis(environment)
                    same = k // 2, environment.workspace, mark
                    if same not in drawn:
                        rng = np.random.default_rng([*seed, k // 2, START])
                        drawn[same] = poses(empty(environment), group.count, self.starts, rng)
                    placed = mirrored(drawn[same], mark) if k % 2 else drawn[same]
                    shaken = perturbed(environment, self.ends_m, np.random.default_rng([*seed, k, ENDS]))
                    places.append((n, k))
                    jobs.append(Job(shaken, placed, (*seed, k // 2, MEMBERS)))
            ways = group.trajectories(jobs, self.iterations)
            for place, job, positions in zip(places, jobs, ways, strict=True):
                found[place] = self.behaviour.judged(positions, job.environment, self.of_behaviour)
                self.told(place[1])
        return found

    def successes(self, fitness: Floats) -> Floats:
        """(n,) the robustness of n parameters, from `fitness` (n, K): refused parameters have none."""
        reached = np.array([[self.behaviour.succeeds(value) for value in row] for row in fitness.tolist()], np.float64)
        return np.asarray(reached.mean(axis=1))

    def robustness(self, points: Sequence[Any], seed: Sequence[int], count: int) -> Floats:
        """(n,) the robustness of n parameters in `count` simulations each."""
        return self.successes(self.fitness(self.environments(points, seed, count), seed))

    def control(self, parameters: Any, seed: Sequence[int], count: int) -> float:
        """The robustness of the workspace alone, with the markers of the environments of these parameters."""
        (made,) = self.environments([parameters], seed, count)
        bare = [empty(environment or self.workspace) for environment in made]
        return float(self.successes(self.fitness([bare], seed))[0])

    def judge(self, space: Space, seed: Sequence[int], count: int) -> Callable[[Floats], Answer]:
        """What a search asks: points of a space → their robustness in `count` simulations each, and their descriptors.

        Descriptors are the means over the environments before they are perturbed; those that a construct lacks, 0.
        """

        def judged(points: Floats) -> Answer:
            parameters = [space.at(point) for point in points]
            made = self.environments(parameters, seed, count)
            values = self.successes(self.fitness(made, seed))
            return Answer(values, np.array([self._described(row) for row in made]))

        return judged

    def bounds(self, space: Space, rng: np.random.Generator, seed: Sequence[int]) -> Floats:
        """(D, 2) bounds of the descriptors over a space, without a simulation."""

        def at(point: Floats, k: int) -> Environment | None:
            return self.environment(space.at(point), seed, k)

        return descriptors.bounds(space, at, self.described_by, rng)

    def _described(self, made: Sequence[Environment | None]) -> Floats:
        each = [
            descriptors.described(environment, self.described_by) for environment in made if environment is not None
        ]
        return np.nan_to_num(descriptors.mean(np.array(each).reshape(-1, len(self.described_by)), self.described_by))
