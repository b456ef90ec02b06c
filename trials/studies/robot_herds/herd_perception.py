"""Robot herds, what is seen: everybody, those whom nobody hides, or less to the rear; desired or actual velocities.

Hodgins and Brogan 1994, section 5: occlusion reduced the stability of the point masses alone, less sight to the rear
made velocities grow, and with actual in place of desired velocities robots ran ever faster or slower.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from trials.studies.robot_herds import design
from trials.studies.robot_herds.claims import ALL, HIDDEN, REAR
from trials.studies.robot_herds.claims import perception_claims as claims
from trials.studies.robot_herds.figures import perception_figures as figures
from trials.types import Trial

REPEATS = 10
RECORD = "none"
CONDITIONS = {
    design.SELECTION: (ALL, HIDDEN, REAR),
    design.VELOCITIES: ("desired", "actual"),
    design.BODY: design.BODIES,
}
SOURCES = design.SOURCES
KEY_MEASURES = ("upright", "unrest", "speed_ratio", "speed_most", "speed_least", "groups_end")


def base(repeat: int) -> Trial:
    """Straight on along x, for a minute."""
    return design.running("herd-perception", repeat, 60.0, every_s=0.5)


def cells(conditions: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    """Each perception with desired velocities, and the usual one with actual ones."""
    return [
        {design.SELECTION: selection, design.VELOCITIES: velocities, design.BODY: body}
        for selection in conditions[design.SELECTION]
        for velocities in conditions[design.VELOCITIES]
        for body in conditions[design.BODY]
        if velocities == "desired" or selection == ALL
    ]


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "cells", "claims", "figures"]
