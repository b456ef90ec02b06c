"""What the laws of the selfish herd share: their lengths, and how they fill what their publications leave open.

Source: Hamilton 1971, "Geometry for the selfish herd"; Viscido, Miller and Wethey 2002, "The dilemma of the selfish
herd"; Fine 2015, section 2.1.1 and table A.1. Lengths are counted in body-lengths; one body-length is one metre here.
"""

from __future__ import annotations

from typing import Annotated

from flocking.parameters import Parameter
from flocking.taxonomy import Filled

BodyLengthM = Annotated[
    float, Parameter("m", "Fine 2015, table A.1 and section 2.1.1: one body-length", published=True, low=0.0)
]
UnitVectorM = Annotated[
    float, Parameter("m", "Fine 2015, table A.1: a unit vector, one body-length", published=True, low=0.0)
]
RepulsionM = Annotated[float, Parameter("m", "Fine 2015, section 2.1.1: two body-lengths", published=True, low=0.0)]
SightM = Annotated[float, Parameter("m", "our choice: wider than any group here", low=0.0)]

NOBODY = Filled(
    "motion computation", "what a member does that detects nobody", "it keeps its motion, as in section 2.1.2"
)
SIGHT = Filled("neighbour selection", "the radius beta within which a member sees", "a hundred body-lengths: everybody")
