"""Supplement to the detection case study: the exclusion distance from 0 up to the laser's range.

Decides what three distances cannot: whether a too large one returns to SNN behaviour, and whether some distance makes
all three detections alike. Not in the publication's 63 trials, and never pooled with them.
"""

from __future__ import annotations

import dataclasses

from trials.studies.detection import detection_case_study
from trials.types import Trial

REPEATS = 12
CONDITIONS = {
    "herd.pipeline": ("member-based", "member-extrapolated", "sensor-based"),
    "herd.law.exclusion_m": (0.0, 0.1, 0.2, 0.33, 0.4, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 5.6),
}


def base(repeat: int) -> Trial:
    """The case study's trial."""
    return dataclasses.replace(detection_case_study.base(repeat), experiment="detection-exclusion-sweep")
