"""Robustness: how often an environment still elicits its behaviour when it, or the herd, is a little different.

Source: Fine 2015, appendix B, definition 5: a valid environment may be perturbed by epsilon and is still considered
valid. The document supposes it and measures nothing; here each kind of perturbation has a success rate with its
interval, beside that of the empty world on the same starts, and environments are ranked by the mean uplift over kinds:
a herd that shows the behaviour wherever it is makes no environment robust.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from flocking.types import Bools
from generation.behaviours import Behaviour
from generation.environment import Environment
from generation.group import Group, Job
from generation.primitives import Arc, Circle, Polygon, Polyline, Primitive, Segment
from generation.validation.uplift import Rate, Uplift, paired, rate
from generation.validation.validate import Plan, empty, jobs_of

WALLS, STARTS = "walls", "starts"
"""Kinds of perturbation that every environment has: wall ends moved, and other starts."""
PURPOSE = 2
"""Of random numbers: perturbations. (`validate` has 0 and 1.)"""
TOGETHER_M = 1e-9
"""Ends nearer to one another than this are one, and move together."""


class Perturbed(NamedTuple):
    """What an environment does to a group under one kind of perturbation."""

    rate: Rate
    """Of success."""
    control: Rate
    """Of success in the empty world, on the same starts."""
    uplift: Uplift


class Robustness(NamedTuple):
    """How robust one environment is."""

    number: int
    kinds: Mapping[str, Perturbed]
    """By kind of perturbation."""

    @property
    def mean(self) -> float:
        """Of the uplifts: what environments are ranked by."""
        return float(np.mean([each.uplift.uplift for each in self.kinds.values()]))


def perturbed(environment: Environment, epsilon_m: float, rng: np.random.Generator) -> Environment:
    """The environment with every end of the construct's walls moved by up to `epsilon_m`, uniformly in a disc.

    Ends that meet move together, and circles and arcs as wholes by their centres. The workspace stays.
    """
    moved: dict[tuple[int, int], tuple[float, float]] = {}

    def at(x: float, y: float) -> tuple[float, float]:
        key = round(x / TOGETHER_M), round(y / TOGETHER_M)
        if key not in moved:
            away, turn = epsilon_m * math.sqrt(rng.random()), 2.0 * math.pi * rng.random()
            moved[key] = away * math.cos(turn), away * math.sin(turn)
        dx, dy = moved[key]
        return x + dx, y + dy

    def of(primitive: Primitive) -> Primitive:
        match primitive:
            case Segment(x0, y0, x1, y1):
                return Segment(*at(x0, y0), *at(x1, y1))
            case Polyline(points):
                return Polyline(tuple(at(*point) for point in points))
            case Polygon(corners, free):
                return Polygon(tuple(at(*corner) for corner in corners), free)
            case Circle(x, y, radius, free):
                return Circle(*at(x, y), radius, free)
            case Arc(x, y, radius, start, turn):
                return Arc(*at(x, y), radius, start, turn)
        raise TypeError(f"{primitive!r} is no primitive")

    return dataclasses.replace(environment, construct=tuple(of(primitive) for primitive in environment.construct))


def robustness(
    environment: Environment,
    number: int,
    behaviour: Behaviour,
    group: Group,
    plan: Plan,
    epsilon_m: float,
    others: Mapping[str, Group] | None = None,
    parameters: Any = None,
) -> Robustness:
    """What one environment does with moved walls, at other starts, and to other groups, each beside the empty world.

    `plan.repeats` starts a kind, which validation with the same plan did not have: who was chosen by its luck has it no
    more. `others`: groups of another size or law, by the name of the perturbation. With moved walls a start is the one
    that is drawn in the environment as it was. Raises `InputError` as `validate` does.
    """
    new = plan._replace(seed=plan.seed + 1)
    jobs = jobs_of(environment, number, group.count, new)
    moved = []
    for place, job in enumerate(jobs):
        rng = np.random.default_rng((plan.seed, number, place, PURPOSE))
        moved.append(job._replace(environment=perturbed(environment, epsilon_m, rng)))
    control = _succeeded(group, behaviour, _without(jobs), parameters)
    kinds = {
        STARTS: _beside(_succeeded(group, behaviour, jobs, parameters), control),
        WALLS: _beside(_succeeded(group, behaviour, moved, parameters), control),
    }
    for name, other in (others or {}).items():
        own = jobs_of(environment, number, other.count, new)
        succeeded = _succeeded(other, behaviour, own, parameters)
        kinds[name] = _beside(succeeded, _succeeded(other, behaviour, _without(own), parameters))
    return Robustness(number, kinds)


def _without(jobs: Sequence[Job]) -> list[Job]:
    """The same simulations in the empty world."""
    return [job._replace(environment=empty(job.environment)) for job in jobs]


def _beside(succeeded: Bools, control: Bools) -> Perturbed:
    return Perturbed(rate(succeeded), rate(control), paired(succeeded, control))


def _succeeded(group: Group, behaviour: Behaviour, jobs: Sequence[Job], parameters: Any) -> Bools:
    fitness = [
        behaviour.judged(positions, job.environment, parameters)
        for job, positions in zip(jobs, group.trajectories(jobs, behaviour.iterations), strict=True)
    ]
    return np.array([behaviour.succeeds(value) for value in fitness], np.bool_)


def ranked(found: Sequence[Robustness]) -> list[Robustness]:
    """Environments from the most robust to the least; of equally robust ones the first comes first."""
    return sorted(found, key=lambda one: -one.mean)
