"""Figures 1.2 and 5.1 of Fine 2015 with Creates: one robot and four, in the same environments that are to corral them.

Repeat r is tried in the r-th environment of the weiring grammar that passes its filter and leaves room at the start,
with its construct and without it. `corral-group-size` is the same with kinematic members, from 1 to 50. Robots always
go at the same speed; what an iteration of the behaviour is worth makes that two units of the environment, or one: the
speeds of both presets of `maebe`, which the publication leaves open.
"""

from __future__ import annotations

import dataclasses

from flocking.parameters import Parameter
from trials.studies.environments import tried
from trials.studies.environments.robots_size_claims import CONSTRUCT, COUNT, COUNTS, ITERATION, UNITS, claims
from trials.studies.environments.robots_size_figures import figures
from trials.types import Trial, with_setup

REPEATS = 50
RECORD = "first"
CONDITIONS = {ITERATION: tuple(UNITS), COUNT: COUNTS, CONSTRUCT: (True, False)}
KEY_MEASURES = ("fitness", "elicited")
SOURCES = {
    COUNT: Parameter("robots", "Fine 2015, figure 1.2: one, and a group; that it is four is a choice"),
    ITERATION: Parameter("s", "not published; at 0.25 m/s two units of the environment and one"),
}


def base(repeat: int) -> Trial:
    """A Create that runs BOIDS in the environment of its repeat."""
    made = with_setup(tried.of_creates("corral-group-size-robots", repeat), {"behaviour": "corralling"})
    alone = tuple(dataclasses.replace(group, count=COUNTS[0]) for group in made.groups)
    return tried.creates(dataclasses.replace(made, groups=alone), repeat)


def finish(trial: Trial) -> Trial:
    """As long as the behaviour looks at, unless the user sets another length."""
    if trial.setup["duration_s"] != tried.ITERATIONS["corralling"] * tried.iteration_s("corralling"):
        return trial
    return with_setup(trial, {"duration_s": tried.ITERATIONS["corralling"] * float(trial.setup[ITERATION])})


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures", "finish"]
