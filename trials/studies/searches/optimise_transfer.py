"""The elites of searches, tried with Creates: how many walls that steer kinematic members robustly steer robots.

Repeat r is tried in the r-th of the walls of `elites.toml`, which `herd run optimise` found, once. The T-junction of
2 m has a place for Creates as it is. Without a wall, in a workspace that is its own mirror image, no herd turns right
as a whole in more than half of its trials.
"""

from __future__ import annotations

import dataclasses
import tomllib
from functools import cache
from importlib import resources
from typing import Any

import numpy as np

from generation import found
from generation.files import to_json
from trials.simulations.robots.fields import group
from trials.simulations.robots.fields import trial as of_robots
from trials.studies.searches.design import MEMBERS
from trials.studies.searches.transfer_claims import claims
from trials.types import Trial, Value, with_setup

REPEATS = 24
RECORD = "first"
CONDITIONS: dict[str, tuple[Any, ...]] = {}
KEY_MEASURES = ("fitness", "elicited")
FILE = "environment.json"
"""Path that a trial's world is named by; its text travels with the trial."""
SPEED_M_S, ITERATION_S, ITERATIONS = 0.25, 0.4, 200
"""Half of a Create's top speed, at which an iteration of 0.1 m takes so long."""
START: dict[str, Value] = {"gap_m": 0.45, "length_m": 2.6, "half_width_m": 0.6}
"""m: the smallest stretch of the corridor in which seven find room. A choice."""


@cache
def elites() -> list[dict[str, float]]:
    """The walls, by their parameters."""
    text = resources.files(__package__).joinpath("elites.toml").read_text(encoding="utf-8")
    walls: list[dict[str, float]] = tomllib.loads(text)["elites"]
    return walls


@cache
def environment(number: int) -> str:
    """The JSON of the environment with the wall of that number, from 1; after the last the first comes again."""
    schema, wall = found.load("dirt"), dict(elites()[(number - 1) % len(elites())])
    wall.pop("robustness")
    parameters = schema.parameters()._replace(**wall)
    return to_json(schema.generate(parameters, schema.workspace(), np.random.default_rng(0)))


def base(repeat: int) -> Trial:
    """Seven Creates that run the same law as the kinematic members, with the same distances."""
    herd = group(
        "reynolds-boids",
        MEMBERS,
        law_parameters={"range_m": 3.0, "separation_m": 1.0, "speed_m_s": SPEED_M_S},
        speed_m_s=SPEED_M_S,
        obstacles="avoid",
        obstacle_selection="nearest",
    )
    made = of_robots(
        "optimise-transfer", repeat, [herd], world=FILE, formation="scattered", formation_parameters=START,
        behaviour="turn-right", duration_s=ITERATION_S * ITERATIONS,
    )  # fmt: skip
    made = dataclasses.replace(made, world_source=environment(repeat))
    return with_setup(made, {"behaviour.iteration_s": ITERATION_S})


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "base", "claims"]
