"""The alignment that Smith and Martin start from: Vicsek's rule.

Source: Smith and Martin 2009 (arXiv:0905.2260); Fine 2015, table A.1, which gives it one row with Vicsek et al. 1995:
the mean heading within the radius, oneself included, plus a number drawn evenly from [-noise/2, noise/2], at a
constant speed. Radians, metres, metres per second.

The publication goes further than that row: it derives forces from a Morse and from a Lennard-Jones potential, in open
space. The document has neither, and its table 3.4 says periodic space. The law is the document's row; its herd is in
open space, as in the publication's title. Positions are moved by the new velocities: whether the publication moves them
by the old ones, as Vicsek et al. do, could not be looked up (`updating` sets it).

Needs positions (to select) and headings. No neighbours: straight on, with noise alone.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from flocking.laws.vicsek import FILLED as ALIGNMENT_FILLED
from flocking.laws.vicsek import law as law
from flocking.parameters import Parameter
from flocking.taxonomy import Filled, Herd, Taxonomy, Validation

NEEDS = frozenset({"headings"})
RULES = ("align",)
SETS = {"neighbours": "distance-based(0, range_m)"}
DRAWS = 1

TAXONOMY = Taxonomy("homogeneous", "idealized", "discrete", "-", False, True, False, True)
VALIDATION = Validation("S", True, "global", "constant", "global", "periodic free")
FILLED = (
    *ALIGNMENT_FILLED,
    Filled(
        "motion computation",
        "table A.1 leaves out the potentials that the publication is about",
        "alignment alone, as in the table; the herd is in open space, as in the publication",
    ),
)
HERD = Herd(spacing_m=0.5, speed_m_s=0.03, dt_s=1.0, space="unbounded")
CREATE = {"range_m": 2.0, "speed_m_s": 0.25}


class Parameters(NamedTuple):
    """Of Vicsek's rule, with his values."""

    range_m: Annotated[float, Parameter("m", "our choice: as in Vicsek et al. 1995", low=0.0)] = 1.0
    speed_m_s: Annotated[float, Parameter("m/s", "our choice: as in Vicsek et al. 1995", low=0.0)] = 0.03
    noise_rad: Annotated[float, Parameter("rad", "our choice: as in Vicsek et al. 1995", low=0.0)] = 0.1
