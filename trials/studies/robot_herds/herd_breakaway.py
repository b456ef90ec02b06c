"""Robot herds, a breakaway group: 10, 30 and 50 creatures start behind the herd, within sight of it or beyond.

Hodgins and Brogan 1994, section 5: a group of sufficient size does not rejoin unless one of it sees a member of the
herd. Each sees the 30 nearest within 24 m: of 31 creatures and more each sees its own group alone.
"""

from __future__ import annotations

from trials.studies.robot_herds import design
from trials.studies.robot_herds.claims import breakaway_claims as claims
from trials.studies.robot_herds.figures import breakaway_figures as figures
from trials.types import Trial

REPEATS = 10
RECORD = "none"
CONDITIONS = {design.BREAKAWAY: (10, 30, 50), design.GAP: (12.0, 30.0), design.BODY: design.BODIES}
SOURCES = design.SOURCES
KEY_MEASURES = ("breakaways", "groups_end", "largest_share_end", "regroup_s", "upright", "speed_end")


def base(repeat: int) -> Trial:
    """Straight on along x, for a minute."""
    return design.running("herd-breakaway", repeat, 60.0)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures"]
