"""Local crowded horizon, variation 1: a step towards the mean position of the largest cluster.

Source: Fine and Shell 2012, "Examining the information requirements for flocking motion"; Fine 2015, section 4.1, LCH
variation 1 (group-centric pose), and figure 4.5. The document gives distances in units; they are metres here.

The members detected fall into clusters: two belong together where a chain of members joins them, each at most the
splitting threshold from the next. The step is that of `lch_member_pose` with the largest cluster alone, and so is what
a member does that sees nobody. Needs positions.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from flocking.laws.lch_member_pose import law
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation

__all__ = ["law"]

NEEDS = frozenset({"positions"})
RULES = ("none", "mean")
SETS = {"densest": "densest-distance(st_m)"}
TAXONOMY = Taxonomy("homogeneous", "constrained", "discrete", "-", False, True, False, False)
VALIDATION = Validation("SP", True, "global", "-", "-", "unbounded free")
FILLED = (
    Filled(
        "neighbour selection",
        "the cluster of highest density is to be chosen (text), the largest one (MaxConnComponent)",
        "the largest; of equally large ones the denser",
    ),
    Filled("motion computation", "the step d", "0.1, which gives the published spread of a single group"),
    Filled(
        "motion computation",
        "the way-point is printed with a vector as its components",
        "the components of the unit vector, times d",
        misprint=True,
    ),
    Filled(
        "motion computation",
        "a member that sees nobody stays (section 4.1) or keeps its direction (section 4.2)",
        "it stays; with the parameter keeps_direction its step leads straight ahead",
    ),
)
HERD = Herd(spacing_m=0.5, speed_m_s=0.1, dt_s=1.0)
CREATE = {"step_m": 0.33, "keeps_direction": True, "st_m": 1.0}


class Parameters(NamedTuple):
    """Of LCH variation 1."""

    step_m: Annotated[
        float,
        Parameter("m", "d of Fine 2015, section 4.1; our choice, which gives table 4.1's spread of 0.05", low=0.0),
    ] = 0.1
    keeps_direction: Annotated[
        bool, Parameter("", "Fine 2015, section 4.2: a robot that sees nobody goes on; as printed it stays")
    ] = False
    st_m: Annotated[float, Parameter("m", "Fine 2015, figure 4.5: 0.5 units", published=True, low=0.0)] = 0.5
