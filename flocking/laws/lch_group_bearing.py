"""Local crowded horizon, variation 3: a step along the mean bearing of the largest cluster.

Source: Fine and Shell 2012, "Examining the information requirements for flocking motion"; Fine 2015, section 4.1, LCH
variation 3 (group-centric bearing), and figure 4.5. The document gives distances in units; they are metres here.

The members detected fall into clusters: two belong together where a chain of members joins them, each seen at most the
splitting threshold `st_deg` (an angle) from the next. The law is that of `lch_member_bearing`, handed the largest
cluster alone; so a member that sees nobody does as there. Needs bearings alone.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from flocking.laws._lch import CANCELLING, FOR_CREATES, LARGEST, NOBODY, STEP, UNPRINTED, KeepsDirection, StepM
from flocking.laws.lch_member_bearing import law
from flocking.parameters import Parameter
from flocking.taxonomy import Herd, Taxonomy, Validation

__all__ = ["law"]

NEEDS = frozenset({"bearings"})
RULES = ("none", "mean")
SETS = {"densest": "densest-angle(st_deg)"}
TAXONOMY = Taxonomy("homogeneous", "constrained", "discrete", "-", False, False, False, False)
VALIDATION = Validation("SP", True, "global", "-", "-", "unbounded free")
NO_ROW = UNPRINTED
FILLED = (LARGEST, STEP, CANCELLING, NOBODY)
HERD = Herd(spacing_m=0.5, speed_m_s=0.1, dt_s=1.0)
CREATE = {**FOR_CREATES, "st_deg": 20.0}


class Parameters(NamedTuple):
    """Of LCH variation 3."""

    step_m: StepM = 0.1
    keeps_direction: KeepsDirection = False
    st_deg: Annotated[
        float, Parameter("deg", "Fine 2015, figure 4.5: 10 degrees", published=True, low=0.0, high=180.0)
    ] = 10.0
