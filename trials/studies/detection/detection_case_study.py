"""The detection case study of Fine 2015 (chapter 2): 63 trials of six Creates in a corridor.

Three detections, three exclusion distances, seven repeats. The publication gives 63 trials and no break-down; this
one is a choice. Repeat r has the same formation, start and noise in all nine cells, so that cells compare in pairs.

The three formations are those in which, at every start, somebody sees nobody and goes straight on, as section 4.2 tells
of the robots; docs/detection.md has the sentence. `detection-abreast` starts as this study did before.
"""

from __future__ import annotations

from flocking.parameters import Parameter
from trials.simulations.robots.fields import group, trial
from trials.studies.detection.claims import claims
from trials.studies.detection.figures import figures
from trials.types import Trial

REPEATS = 7
CONDITIONS = {
    "herd.pipeline": ("member-based", "member-extrapolated", "sensor-based"),
    "herd.law.exclusion_m": (0.0, 0.5, 1.0),
}
FORMATIONS = ("single-file", "staggered-file", "split-file")
SOURCES = {
    "formation": Parameter(
        "", f"Fine 2015, figure 2.5: three without numbers; here {', '.join(FORMATIONS)}, by section 4.2; in turn"
    ),
}


def base(repeat: int) -> Trial:
    """Six robots in the corridor; the three formations take turns."""
    formation = FORMATIONS[(repeat - 1) % len(FORMATIONS)]
    return trial("detection-case-study", repeat, [group()], formation=formation, duration_s=60.0)


__all__ = ["CONDITIONS", "REPEATS", "SOURCES", "base", "claims", "figures"]
