"""DIRT's successful configurations by quad-tree and by random sampling, at equal budget.

Fine 2015, section 7.4.2, supposes that random parameter selection may be less efficient.
"""

from __future__ import annotations

from flocking.parameters import Parameter
from trials.simulations.maps.fields import METHODS
from trials.studies.maps import design
from trials.studies.maps.claims import of_sampling as claims
from trials.studies.maps.design import METHOD, PUBLISHED_BOX
from trials.studies.maps.figures import of_sampling as figures
from trials.types import Trial, with_setup

REPEATS = 8
RECORD = "none"
CONDITIONS = {METHOD: METHODS}
SOURCES = {"budget": Parameter("configurations", "a choice: the quad-tree's first three levels and part of the fourth")}
KEY_MEASURES = ("configurations", "successful", "successful_share", "success_inside", "success_outside")


def base(repeat: int) -> Trial:
    """Seven members, anchor four, 256 configurations."""
    trial = design.base("dirt-sampling", repeat, "dirt", refinements=6, budget=256)
    return with_setup(trial, PUBLISHED_BOX)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures"]
