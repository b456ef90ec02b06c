"""What the four variations of the local crowded horizon (LCH) share: parameters, readings and the step itself.

Source: Fine and Shell 2012, "Examining the information requirements for flocking motion"; Fine 2015, section 4.1. The
variations differ in what they read of the members (positions or bearings alone) and in whom they read (all members
detected or the largest cluster of them). The document gives distances in units; they are metres here.

The step leads along the mean that the variation takes and has one length d, however far the mean is. For a member that
sees nobody the printed variations return its own place, so it stands still; section 4.2 says of the robots that they
continue in their direction: with `keeps_direction` it takes its step straight ahead. A mean that is zero has no
direction: the member stands still.
"""

from __future__ import annotations

import math
from typing import Annotated

from flocking.compilation import compiled
from flocking.parameters import Parameter
from flocking.steps import step_along
from flocking.taxonomy import Filled
from flocking.types import Kind, Motion

FOR_CREATES = {"step_m": 0.33, "keeps_direction": True}
"""Parameter values that all four have with iRobot Creates."""

StepM = Annotated[
    float,
    Parameter("m", "d of Fine 2015, section 4.1; our choice, which gives table 4.1's spread of 0.05", low=0.0),
]
KeepsDirection = Annotated[
    bool,
    Parameter(
        "", "Fine 2015, section 4.2: a robot that sees nobody goes on; as printed it stays", plausible=(False, True)
    ),
]

UNPRINTED = "a variation of LCH by chapter 4 and Fine and Shell 2012, which the tables do not hold"
"""Why the document's tables have no row for any of the four."""

LARGEST = Filled(
    "neighbour selection",
    "the cluster of highest density is to be chosen (text), the largest one (MaxConnComponent)",
    "the largest; of equally large ones the denser",
)
STEP = Filled("motion computation", "the step d", "0.1, which gives the published spread of a single group")
CANCELLING = Filled("motion computation", "bearings that cancel out", "the member stands still")
COMPONENTS = Filled(
    "motion computation",
    "the way-point is printed with a vector as its components",
    "the components of the unit vector, times d",
    misprint=True,
)
NOBODY = Filled(
    "motion computation",
    "a member that sees nobody stays (section 4.1) or keeps its direction (section 4.2)",
    "it stays; with the parameter keeps_direction its step leads straight ahead",
)


@compiled
def step_along_mean(found: int, x: float, y: float, step_m: float, keeps_direction: bool) -> Motion:
    """Way-point one step of `step_m` (m) along the mean (x, y) over `found` members; rule "none" or "mean"."""
    if found > 0:
        return step_along(x, y, step_m, 1)
    if keeps_direction:
        return Motion(Kind.WAY_POINT, step_m, 0.0, 0)
    return Motion(Kind.STOP, math.nan, math.nan, 0)
