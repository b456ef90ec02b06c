"""Parameter-space map of SIRT's rule probabilities, projected on rules 1 and 2, for seven members, one and three.

Fine 2015, section 8.1.2 and figure 8.1: anchor four. What rules 1 and 2 leave to one is rule 3's; more than one there
is not. Each pair of starts has a construct of its own, drawn by the probabilities. The claim is on seven members; the
other group sizes stand beside them.
"""

from __future__ import annotations

from flocking.parameters import Parameter
from trials.studies.maps import design
from trials.studies.maps.claims import of_sirt as claims
from trials.studies.maps.design import COUNT, FEW, MEMBERS, SOLITARY
from trials.studies.maps.figures import of_sirt as figures
from trials.types import Trial

REPEATS = 6
RECORD = "first"
CONDITIONS = {COUNT: (MEMBERS, SOLITARY, FEW)}
SOURCES = {
    COUNT: Parameter("members", "seven: Fine 2015, section 8.1.2; one and three: as for DIRT", published=True),
    "refinements": Parameter("", "a choice"),
}
KEY_MEASURES = ("configurations", "successful", "region_area", "trend_1", "trend_2", "trend_rest")


def base(repeat: int) -> Trial:
    """Seven members and a growing wall at anchor four."""
    return design.base(
        "sirt-map", repeat, "sirt", refined="rule_1, rule_2", grid="8", refinements=3, iterations=design.STEPS
    )


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures"]
