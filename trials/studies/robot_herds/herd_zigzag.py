"""Robot herds, turning: the user's creature runs straight on for 5 s and then four legs of 20 s to the left and right.

Hodgins and Brogan 1994, section 5, third test and figure 7.
"""

from __future__ import annotations

from trials.studies.robot_herds import design
from trials.studies.robot_herds.claims import zigzag_claims as claims
from trials.studies.robot_herds.figures import zigzag_figures as figures
from trials.types import Trial

REPEATS = 10
RECORD = "none"
CONDITIONS = {design.BODY: design.BODIES}
SOURCES = design.SOURCES
KEY_MEASURES = ("upright", "collisions", "closest", "user_away", "aspect_least", "unrest")


def base(repeat: int) -> Trial:
    """After half a minute of steady running."""
    seconds, velocities = design.zigzag()
    return design.running("herd-zigzag", repeat, seconds, velocities, settle_s=design.SETTLED_S)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures"]
