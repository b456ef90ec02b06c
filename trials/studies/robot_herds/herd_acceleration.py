"""Robot herds, acceleration: from the end of the steady run the user's creature runs at 2, 3 and 1.5 m/s, 30 s each.

Hodgins and Brogan 1994, section 5, second test and figure 6.
"""

from __future__ import annotations

from trials.studies.robot_herds import design
from trials.studies.robot_herds.claims import acceleration_claims as claims
from trials.studies.robot_herds.figures import acceleration_figures as figures
from trials.types import Trial

REPEATS = 10
RECORD = "none"
CONDITIONS = {design.BODY: design.BODIES}
SOURCES = design.SOURCES
KEY_MEASURES = ("upright", "collisions", "ahead_1", "ahead_2", "ahead_3", "user_away")


def base(repeat: int) -> Trial:
    """Straight on along x, faster and slower."""
    seconds, velocities = design.accelerating()
    steady = float(design.TESTS["steady_state"]["seconds"])
    return design.running("herd-acceleration", repeat, seconds, velocities, settle_s=steady, every_s=0.5)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures"]
