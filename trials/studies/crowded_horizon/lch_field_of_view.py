"""LCH with a limited field of view (figure 4.4 of Fine 2015): fifty members that see all around, or 240 degrees.

The member-centric pose variation. A member that sees nobody keeps its direction, as section 4.2 says of the robots.
Repeat r has the same start in both conditions.
"""

from __future__ import annotations

from flocking.parameters import Parameter
from trials.simulations.kinematic.fields import group, trial
from trials.studies.crowded_horizon.field_of_view import FULL, LIMITED, claims, figures
from trials.types import Trial

REPEATS = 20
RECORD = "first"
CONDITIONS = {"herd.selection": (FULL, LIMITED)}
KEY_MEASURES = ("net_displacement", "directedness", "mmd_end", "largest_share_end")
SOURCES = {
    "herd.count": Parameter("members", "Fine 2015, figure 4.4", published=True),
    "steps": Parameter("", "Fine 2015, section 4.3: 75 iterations", published=True),
}


def base(repeat: int) -> Trial:
    """Fifty members in unbounded space, each looking its own way at the start."""
    return trial(
        "lch-field-of-view",
        repeat,
        [group("lch-member-pose", 50, law_parameters={"keeps_direction": True})],
        world="unbounded",
        formation="single-group",
        steps=75,
    )


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures"]
