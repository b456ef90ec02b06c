"""Local crowded horizon, variation 4: a step along the mean bearing of all detected members.

Source: Fine and Shell 2012, "Examining the information requirements for flocking motion"; Fine 2015, section 4.1, LCH
variation 4 (member-centric bearing). The document gives distances in units; they are metres here.

    step = d times (cos, sin) of the direction of the mean of the unit vectors towards the members

The step has one length whatever the distances, which are not known. Needs bearings alone.
No neighbours: it stands still or, with `keeps_direction`, takes its step straight ahead (`_lch`). Unit vectors that
cancel out: it stands still.
"""

from __future__ import annotations

from typing import NamedTuple

from flocking.laws._lch import CANCELLING, FOR_CREATES, NOBODY, STEP, UNPRINTED, KeepsDirection, StepM, step_along_mean
from flocking.taxonomy import Herd, Taxonomy, Validation
from flocking.terms import mean_direction
from flocking.types import Bools, Floats, Members, Motion, Obstacles, Own

NEEDS = frozenset({"bearings"})
RULES = ("none", "mean")
SETS = {"neighbours": "all"}
TAXONOMY = Taxonomy("homogeneous", "constrained", "discrete", "-", False, False, False, False)
VALIDATION = Validation("SP", True, "global", "-", "-", "unbounded free")
NO_ROW = UNPRINTED
FILLED = (STEP, CANCELLING, NOBODY)
HERD = Herd(spacing_m=0.5, speed_m_s=0.1, dt_s=1.0)
CREATE = FOR_CREATES


class Parameters(NamedTuple):
    """Of LCH variation 4."""

    step_m: StepM = 0.1
    keeps_direction: KeepsDirection = False


def law(
    own: Own,
    members: Members,
    sets: Bools,
    obstacles: Obstacles,
    parameters: Parameters,
    memory: Floats,
    u: Floats,
) -> Motion:
    """Way-point: one step along the mean bearing."""
    found, x, y = mean_direction(members.bearings, sets[0])
    return step_along_mean(found, x, y, parameters.step_m, parameters.keeps_direction)
