"""Primitives made de novo: the rule probabilities of the grammar of points, optimised for a right turn in closed loop.

Source: Fine 2015, section 8.1.2, which proposes it: parameter optimisation is to focus a grammar that starts from an
empty workspace. Each simulation has a construct of its own, so that the probabilities are judged and no draw of them.
"""

from __future__ import annotations

from trials.simulations.searches.fields import trial
from trials.studies.searches.claims import claims
from trials.studies.searches.design import COUNTS, METHOD, herd
from trials.studies.searches.figures import figures
from trials.types import Trial, with_setup

REPEATS = 8
RECORD = "none"
CONDITIONS = {METHOD: ("random", "cma-es")}
KEY_MEASURES = ("best", "mean_best", "control", "uplift", "robust_points")


def base(repeat: int) -> Trial:
    """A search of 1200 simulations, fifty points of 24 constructs."""
    chosen = trial("optimise-points", repeat, [herd()], "points")
    return with_setup(chosen, {"search.counts": COUNTS, "search.pairs": 12})


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "base", "claims", "figures"]
