"""Supplement to the detection case study: perfect detection and ideal sensors.

Every reading correctly classified, averaged to one point a member (`perfect-members`) or passed on
(`perfect-readings`); beside them the three detections, which err with ideal sensors too, and global knowledge. Decides
what the 63 trials cannot: "with perfect sensing the behaviours of the three detections are equivalent". Not in the
publication's 63 trials, and never pooled with them.
"""

from __future__ import annotations

import dataclasses

from trials.studies.detection import detection_case_study
from trials.types import Trial, with_setup

REPEATS = 12
CONDITIONS = {
    "herd.pipeline": (
        "perfect-members",
        "perfect-readings",
        "perfect",
        "member-based",
        "member-extrapolated",
        "sensor-based",
    ),
    "herd.law.exclusion_m": (0.0, 0.33, 0.5, 1.0),
}


def base(repeat: int) -> Trial:
    """The case study's trial with sensors that do not err."""
    trial = detection_case_study.base(repeat)
    groups = tuple(with_setup(group, {"sensors": "ideal"}) for group in trial.groups)
    return dataclasses.replace(trial, experiment="detection-ideal", groups=groups)
