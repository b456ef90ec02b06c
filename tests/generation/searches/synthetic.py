"""A group that the searches know nothing of: how far its members go is a function of the walls that they are given."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from flocking.parameters import Parameter
from generation.behaviours import Behaviour
from generation.environment import START, Environment
from generation.primitives import Point, Segment
from generation.schema import Schema

BEST_DEG, BEST_M = 10.0, 3.0
WIDTH_DEG, WIDTH_M = 60.0, 2.0


def score(angle_deg: float, length_m: float) -> float:
    """The closed form: 1 at the best wall, falling off linearly and around the full turn to 0."""
    off = abs((angle_deg - BEST_DEG + 180.0) % 360.0 - 180.0) / WIDTH_DEG
    return max(0.0, 1.0 - math.hypot(off, (length_m - BEST_M) / WIDTH_M))


class Walkers:
    """Members that walk along x; the share of them that goes farther than 1 m is the score of the wall.

    Simulation k of a job has a threshold of its own, evenly spread by its seed, so that the success rate over many
    simulations is the score as well.
    """

    def __init__(self, count: int = 4, noise: bool = True) -> None:
        self.count, self.noise, self.simulations = count, noise, 0

    def trajectories(self, jobs, iterations):
        for job in jobs:
            self.simulations += 1
            walls = job.environment.construct_walls()
            reached = 0.0
            if len(walls):
                x, y = walls[0, 2:] - walls[0, :2]
                reached = score(math.degrees(math.atan2(y, x)), math.hypot(x, y))
            needed = np.random.default_rng(job.seed).random() if self.noise else 0.5
            way = np.zeros((iterations + 1, self.count, 2))
            way[-1, :, 0] = 2.0 if reached > needed else 0.0
            yield way


class NoParameters(NamedTuple):
    """None."""


def far(positions, environment, parameters) -> float:
    """Share of the members that ended beyond 1 m."""
    return float((positions[-1, :, 0] - positions[0, :, 0] > 1.0).mean())


FAR = Behaviour("far", "Members go far", NoParameters, 3, 1.0, far)


class Wall(NamedTuple):
    """A wall, and a text that no search can vary."""

    angle_deg: Annotated[float, Parameter("deg", "a test", low=0.0, high=360.0)] = 90.0
    length_m: Annotated[float, Parameter("m", "a test", low=0.1, high=4.0)] = 1.0
    number: Annotated[int, Parameter("", "a test", low=1, high=3)] = 1
    colour: Annotated[str, Parameter("", "a test", choices=("red", "blue"))] = "red"


def generate(parameters: Wall, workspace: Environment, rng: np.random.Generator) -> Environment:
    angle = math.radians(parameters.angle_deg)
    end = parameters.length_m * math.cos(angle), parameters.length_m * math.sin(angle)
    return Environment(construct=(Segment(0.0, 0.0, *end),), markers=workspace.markers)


def workspace() -> Environment:
    return Environment(markers={START: Point(-5.0, 0.0, 0.0)})


WALL = Schema("wall", "One wall", Wall, workspace, generate, "", "far")
