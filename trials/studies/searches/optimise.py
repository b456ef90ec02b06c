"""Which search finds the most robust wall for a right turn: at random, CMA-ES, or two quality-diversity archives.

The schema `dirt` in its T-junction, whose angle, length and anchor are searched. Each search has the same budget of
simulations, and repeat r has the same starts and perturbations for all of them. Not published: Fine 2015, section
7.4.3, names parameter optimisation as what could follow its maps.
"""

from __future__ import annotations

from trials.simulations.searches.fields import trial
from trials.studies.searches.claims import claims
from trials.studies.searches.design import COUNTS, METHOD, METHODS, herd
from trials.studies.searches.figures import figures
from trials.types import Trial, with_setup

REPEATS = 8
RECORD = "first"
CONDITIONS = {METHOD: METHODS}
KEY_MEASURES = ("best", "mean_best", "robust_points", "coverage", "qd_score", "robust_cells")


def base(repeat: int) -> Trial:
    """A search of 1200 simulations, a hundred points of twelve."""
    chosen = trial("optimise", repeat, [herd()], "dirt")
    return with_setup(chosen, {"search.parameters": "angle_deg, length_m, anchor", "search.counts": COUNTS})


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "base", "claims", "figures"]
