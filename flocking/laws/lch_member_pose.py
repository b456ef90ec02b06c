"""Local crowded horizon, variation 2: a step towards the mean position of all detected members.

Source: Fine and Shell 2012, "Examining the information requirements for flocking motion"; Fine 2015, section 4.1, LCH
variation 2 (member-centric pose). The document gives distances in units; they are metres here.

    step = d times the unit vector towards the mean of the members' positions, the focal member not among them

The step is not shortened near the mean, so that a compact group keeps an extent of about d. Needs positions.
No neighbours: it stands still or, with `keeps_direction`, takes its step straight ahead (`_lch`). A mean at the
member's own place: it stands still.
"""

from __future__ import annotations

from typing import NamedTuple

from flocking.laws._lch import COMPONENTS, FOR_CREATES, NOBODY, STEP, UNPRINTED, KeepsDirection, StepM, step_along_mean
from flocking.taxonomy import Herd, Taxonomy, Validation
from flocking.terms import mean_vector
from flocking.types import Bools, Floats, Members, Motion, Obstacles, Own

NEEDS = frozenset({"positions"})
RULES = ("none", "mean")
SETS = {"neighbours": "all"}
TAXONOMY = Taxonomy("homogeneous", "constrained", "discrete", "-", False, True, False, False)
VALIDATION = Validation("SP", True, "global", "-", "-", "unbounded free")
NO_ROW = UNPRINTED
FILLED = (STEP, COMPONENTS, NOBODY)
HERD = Herd(spacing_m=0.5, speed_m_s=0.1, dt_s=1.0)
CREATE = FOR_CREATES


class Parameters(NamedTuple):
    """Of LCH variation 2."""

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
    """Way-point: one step towards the mean position."""
    found, x, y = mean_vector(members.positions, sets[0])
    return step_along_mean(found, x, y, parameters.step_m, parameters.keeps_direction)
