"""Robot herds, steady state: 105 creatures behind one that runs at 2 m/s for 300 s; point masses and one-legged robots.

Hodgins and Brogan 1994, section 5, first test and figure 5: from an oblong start both herds contract to a circle.
"""

from __future__ import annotations

from trials.studies.robot_herds import design
from trials.studies.robot_herds.claims import steady_claims as claims
from trials.studies.robot_herds.figures import steady_figures as figures
from trials.types import Trial

REPEATS = 10
RECORD = "none"
CONDITIONS = {design.BODY: design.BODIES}
SOURCES = design.SOURCES
KEY_MEASURES = ("upright", "collisions", "radius_start", "radius_end", "aspect_start", "aspect_end")


def base(repeat: int) -> Trial:
    """Straight on along x."""
    return design.running("herd-steady", repeat, design.TESTS["steady_state"]["seconds"], every_s=0.5)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures"]
