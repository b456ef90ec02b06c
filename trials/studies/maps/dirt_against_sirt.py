"""DIRT (top down) against SIRT (bottom up): successful configurations, and how they persist over group sizes.

Fine 2015, section 8.1.3, asks which of both, top-down or bottom-up, is better, and proposes these two measures.
Configurations are drawn at random, as shares of them then are of the space: DIRT's angle and length, and SIRT's rules 1
and 2.
"""

from __future__ import annotations

from flocking.parameters import Parameter
from trials.studies.maps import design
from trials.studies.maps.claims import of_both as claims
from trials.studies.maps.design import COUNT, WORLD
from trials.studies.maps.figures import of_both as figures
from trials.types import Trial, with_setup

REPEATS = 6
RECORD = "none"
CONDITIONS = {WORLD: ("dirt", "sirt"), COUNT: (1, 3, 7)}
REFINED = {"dirt": "angle_deg, length_m", "sirt": "rule_1, rule_2"}
SOURCES = {
    COUNT: Parameter("members", "Fine 2015, section 7.4.2", published=True),
    "budget": Parameter("configurations", "a choice"),
}
KEY_MEASURES = ("configurations", "successful", "successful_share", "best_success")


def base(repeat: int) -> Trial:
    """Seven members, anchor four, 200 random configurations."""
    return design.base("dirt-against-sirt", repeat, "dirt", method="random", budget=200, iterations=design.STEPS)


def finish(trial: Trial) -> Trial:
    """The trial with the parameters of its schema."""
    if trial.setup.get("refined", "own") != "own" or trial.world not in REFINED:
        return trial
    return with_setup(trial, {"refined": REFINED[trial.world]})


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures", "finish"]
