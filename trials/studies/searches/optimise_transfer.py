"""The elites of searches, tried with Creates: how many walls that steer kinematic members robustly steer robots.

Repeat r is tried with the r-th of the walls of `elites.toml`, which `herd run optimise` found, and without a wall, from
the same start. A T-junction of 2 m has room for Creates as it is.
"""

from __future__ import annotations

import dataclasses
import tomllib
from functools import cache
from importlib import resources

from trials.simulations.robots.fields import group
from trials.simulations.robots.fields import trial as of_robots
from trials.studies.searches.design import MEMBERS
from trials.studies.searches.transfer_claims import WALL, claims
from trials.types import Trial, Value, with_setup

REPEATS = 24
RECORD = "first"
CONDITIONS = {WALL: (True, False)}
KEY_MEASURES = ("fitness", "elicited")
SPEED_M_S, ITERATION_S, ITERATIONS = 0.25, 0.4, 200
"""Half of a Create's top speed, at which an iteration of 0.1 m takes so long."""
START: dict[str, Value] = {"gap_m": 0.45, "length_m": 2.6, "half_width_m": 0.6}
"""m: the smallest stretch of the corridor in which seven find room. A choice."""


@cache
def elites() -> list[dict[str, float]]:
    """The walls, by their parameters and their robustness."""
    text = resources.files(__package__).joinpath("elites.toml").read_text(encoding="utf-8")
    walls: list[dict[str, float]] = tomllib.loads(text)["elites"]
    return walls


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
        "optimise-transfer", repeat, [herd], world="t-junction", formation="scattered", formation_parameters=START,
        behaviour="turn-right", duration_s=ITERATION_S * ITERATIONS,
    )  # fmt: skip
    return with_setup(made, {"behaviour.iteration_s": ITERATION_S})


def finish(trial: Trial) -> Trial:
    """The wall of its repeat, unless the user sets another; after the last the first comes again."""
    if trial.world != "t-junction":
        return trial
    wall = elites()[(trial.repeat - 1) % len(elites())]
    own: dict[str, Value] = {name: wall[name] for name in ("angle_deg", "length_m", "anchor")}
    return dataclasses.replace(trial, world_parameters={**own, **trial.world_parameters})


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "base", "claims", "finish"]
