"""Robot herds of different creatures: gains that differ from one to the next, and errors about where others are.

Hodgins and Brogan 1994, section 5, as the work that is to follow: heterogeneous herds, noise, personalities by the
gains of the herding algorithm. Gains are drawn uniformly to either side of the published ones. Nothing was published:
the report shows what it does.
"""

from __future__ import annotations

from trials.studies.robot_herds import design
from trials.studies.robot_herds.figures import personality_figures as figures
from trials.types import Trial

REPEATS = 10
RECORD = "none"
CONDITIONS = {
    "herd.spread.kp_per_s": (0.0, 0.5, 1.0),
    "herd.place_error_m": (0.0, 0.2),
    design.BODY: design.BODIES,
}
SOURCES = design.SOURCES
KEY_MEASURES = ("upright", "collisions", "unrest", "radius_end", "groups_end", "speed_ratio")


def base(repeat: int) -> Trial:
    """Straight on along x, for 40 s."""
    return design.running("herd-personality", repeat, 40.0)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "figures"]
