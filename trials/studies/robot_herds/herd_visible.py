"""Robot herds, how many are visible: 2 to 60 of the nearest, for point masses and one-legged robots; 40 s.

Hodgins and Brogan 1994, section 5: robots were more stable than point masses where fewer than 30 were visible.
"""

from __future__ import annotations

from trials.studies.robot_herds import design
from trials.studies.robot_herds.claims import visible_claims as claims
from trials.studies.robot_herds.figures import visible_figures as figures
from trials.types import Trial

REPEATS = 10
RECORD = "none"
CONDITIONS = {design.VISIBLE: (2, 4, 7, 10, 15, 20, 30, 60), design.BODY: design.BODIES}
SOURCES = {key: source for key, source in design.SOURCES.items() if key != design.VISIBLE}
KEY_MEASURES = ("upright", "unrest", "groups_end", "largest_share_end", "radius_end", "speed_ratio")


def base(repeat: int) -> Trial:
    """Straight on along x."""
    return design.running("herd-visible", repeat, 40.0)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures"]
