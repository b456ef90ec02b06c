"""The detection case study of Fine 2015 (chapter 2): 63 trials of six Creates in a corridor.

Three detections, three exclusion distances, seven repeats. The publication gives 63 trials and no break-down; this
one is a choice. Repeat r has the same formation, start and noise in all nine cells, so that cells compare in pairs.
"""

from __future__ import annotations

from flocking.parameters import Parameter
from trials.simulations.robots.fields import group, trial
from trials.studies.detection.claims import claims
from trials.studies.detection.figures import figures
from trials.types import Trial
from worlds.formations import FORMATIONS

REPEATS = 7
CONDITIONS = {
    "herd.pipeline": ("member-based", "member-extrapolated", "sensor-based"),
    "herd.law.exclusion_m": (0.0, 0.5, 1.0),
}
SOURCES = {
    "formation": Parameter("", "Fine 2015, figure 2.5: three formations, drawn without numbers; one a repeat in turn"),
}


def base(repeat: int) -> Trial:
    """Six robots in the corridor; the three formations take turns."""
    formation = list(FORMATIONS)[(repeat - 1) % len(FORMATIONS)]
    return trial("detection-case-study", repeat, [group()], formation=formation, duration_s=60.0)


__all__ = ["CONDITIONS", "REPEATS", "SOURCES", "base", "claims", "figures"]
