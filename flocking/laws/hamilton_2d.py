"""Hamilton's two-dimensional model: a step towards the nearest neighbour within sight.

Source: Hamilton 1971, "Geometry for the selfish herd", its second model; Fine 2015, table A.1, Hamilton (1971) (2D),
and section 2.1.1. The unit is the body-length, one metre here.

The rule is that of `viscido_snn`; the one difference is that the nearest neighbour is sought within the range alone.
Needs positions. No neighbours in range: undefined in the publication; the member keeps its motion.
"""

from __future__ import annotations

from typing import NamedTuple

from flocking.laws._selfish_herd import NOBODY, SIGHT, BodyLengthM, RepulsionM, SightM
from flocking.laws.viscido_snn import law
from flocking.taxonomy import Herd, Taxonomy, Validation

__all__ = ["law"]

NEEDS = frozenset({"positions"})
RULES = ("none", "snn")
SETS = {"nearest": "distance-based(0, range_m) & nearest"}
TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "-", False, True, False, False)
VALIDATION = Validation("S", True, "global", "-", "-", "unbounded free")
FILLED = (SIGHT, NOBODY)
HERD = Herd(spacing_m=4.0, speed_m_s=1.0, dt_s=1.0)
CREATE = {"step_m": 0.33, "repulsion_m": 0.66, "range_m": 5.6}


class Parameters(NamedTuple):
    """Of Hamilton's two-dimensional model."""

    step_m: BodyLengthM = 1.0
    repulsion_m: RepulsionM = 2.0
    range_m: SightM = 100.0
