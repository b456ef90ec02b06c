"""The detection case study from the formations that it had at first: the front robots stand abreast.

An arm of the case study, and no part of the publication's 63 trials: what the choice of the starting formations means
for each claim. The case study says why it starts otherwise.
"""

from __future__ import annotations

import dataclasses

from trials.studies.detection import detection_case_study
from trials.studies.detection.claims import claims
from trials.studies.detection.figures import figures
from trials.types import Trial

REPEATS = 42
RECORD = "first"
CONDITIONS = detection_case_study.CONDITIONS
FORMATIONS = ("single-group", "split-group", "scattered")


def base(repeat: int) -> Trial:
    """The case study's trial from another formation, with that formation's own numbers."""
    formation = FORMATIONS[(repeat - 1) % len(FORMATIONS)]
    return dataclasses.replace(
        detection_case_study.base(repeat),
        experiment="detection-abreast",
        formation=formation,
    )


__all__ = ["CONDITIONS", "RECORD", "REPEATS", "base", "claims", "figures"]
