"""Local crowded horizon, variation 1: a step towards the mean position of the largest cluster.

Source: Fine and Shell 2012, "Examining the information requirements for flocking motion"; Fine 2015, section 4.1, LCH
variation 1 (group-centric pose), and figure 4.5. The document gives distances in units; they are metres here.

The members detected fall into clusters: two belong together where a chain of members joins them, each at most the
splitting threshold `st_m` from the next. The law is that of `lch_member_pose`, handed the largest cluster alone; so a
member that sees nobody does as there. Needs positions.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from flocking.laws._lch import COMPONENTS, FOR_CREATES, LARGEST, NOBODY, STEP, UNPRINTED, KeepsDirection, StepM
from flocking.laws.lch_member_pose import law
from flocking.parameters import Parameter
from flocking.taxonomy import Herd, Taxonomy, Validation

__all__ = ["law"]

NEEDS = frozenset({"positions"})
RULES = ("none", "mean")
SETS = {"densest": "densest-distance(st_m)"}
TAXONOMY = Taxonomy("homogeneous", "constrained", "discrete", "-", False, True, False, False)
VALIDATION = Validation("SP", True, "global", "-", "-", "unbounded free")
NO_ROW = UNPRINTED
FILLED = (LARGEST, STEP, COMPONENTS, NOBODY)
HERD = Herd(spacing_m=0.5, speed_m_s=0.1, dt_s=1.0)
CREATE = {**FOR_CREATES, "st_m": 1.0}


class Parameters(NamedTuple):
    """Of LCH variation 1."""

    step_m: StepM = 0.1
    keeps_direction: KeepsDirection = False
    st_m: Annotated[float, Parameter("m", "Fine 2015, figure 4.5: 0.5 units", published=True, low=0.0)] = 0.5
