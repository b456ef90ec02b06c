"""LCH, table 4.1 of Fine 2015: four variations, two sensing ranges, two starts, ten trials each: 160 simulations.

Fifty members, 75 synchronous steps, without a limit to the field of view. Repeat r has the same start in all cells of
one formation. The publication gives neither the step d nor where the groups stand: see the laws and the formation.
"""

from __future__ import annotations

from flocking.parameters import Parameter
from trials.simulations.kinematic.fields import group, trial
from trials.studies.crowded_horizon.claims import FAR, NEAR, claims
from trials.studies.crowded_horizon.figures import VARIATIONS, figures
from trials.types import Trial

REPEATS = 10
RECORD = "first"
CONDITIONS = {
    "formation": ("single-group", "split-group"),
    "herd.law": VARIATIONS,
    "herd.selection": (NEAR, FAR),
}
SOURCES = {
    "herd.count": Parameter("members", "Fine 2015, section 4.3", published=True),
    "steps": Parameter("", "Fine 2015, section 4.3: 75 iterations", published=True),
    "herd.selection": Parameter("", "Fine 2015, section 4.3: sensing ranges of 3 and 3000 units", published=True),
    "formation": Parameter("", "Fine 2015, section 4.3, without numbers", published=True),
}
KEY_MEASURES = ("mmd_end", "mmd_start", "groups_end", "largest_share_end")


def base(repeat: int) -> Trial:
    """Fifty members in unbounded space."""
    return trial("lch-table-4-1", repeat, [group("lch-group-pose", 50)], world="unbounded", steps=75)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures"]
