"""The conditions of the detection case study by their names, the measures of behaviour, and the margins.

docs/detection.md says why each margin is what it is.
"""

from __future__ import annotations

from typing import Any

from trials.evidence.claims import published

PIPELINE, EXCLUSION = "herd.pipeline", "herd.law.exclusion_m"
KEYS = (PIPELINE, EXCLUSION)
VIEW = "herd.sensors.view_deg"
MEMBER, EXTRAPOLATED, SENSOR, PERFECT = "member-based", "member-extrapolated", "sensor-based", "perfect"
MEANS, READINGS = "perfect-members", "perfect-readings"
SHORT = {
    MEMBER: "member",
    EXTRAPOLATED: "extrapolated",
    SENSOR: "sensor",
    PERFECT: "perfect",
    MEANS: "means",
    READINGS: "readings",
}
PAIRS = ((SENSOR, MEMBER), (EXTRAPOLATED, MEMBER), (EXTRAPOLATED, SENSOR))

BODY_DIAMETER_M = 0.33
_TABLE: dict[str, Any] = published(__package__, "fine2015", "detection_case_study")
EXCLUSIONS_M: list[float] = _TABLE["exclusion_distances_m"]
PROPER_M = EXCLUSIONS_M[1]
"""The exclusion distance at which the publication sees HA behaviour (section 2.4.1)."""

PUBLISHED_REPEATS = int(_TABLE["trials"]) // (len(EXCLUSIONS_M) * 3)
"""Of each of the three detections at each distance, if all were run as often."""

LARGEST_PROPER_M = 1.0
"""Up to it the detections may be alike; far beyond, all three are alike for the trivial reason that all are SNN."""

BY = {
    ("exceeds", False): "t, 95 % interval",
    ("exceeds", True): "exact sign test of the median where a share lies near 0 or 1, 95 % interval",
    ("equivalent", False): "two one-sided t-tests, 90 % interval",
    ("equivalent", True): "two exact sign tests of the median where a share lies near 0 or 1, 90 % interval",
}
"""How outcomes are tested, by kind and by whether exactly."""

# Margins: the smallest difference that an onlooker could be said to observe. Choices, with reasons in the docs.
SHARE_MARGIN = 0.10
STRAIGHTNESS_MARGIN = 0.10
SMOOTHNESS_FACTOR = 1.10
ERROR_MARGIN = 0.01
DISTANCE_MARGIN_M = BODY_DIAMETER_M
NUMBER_FACTOR = 2.0
ALWAYS = 0.95
STRONG = 0.75

ACTS = ("share that acts as SNN", "acts_as_snn_share", SHARE_MARGIN)
"""Of all updates with inputs: the robot does what SNN would do."""
HEADS = ("HA share of the approaches", "effective_ha_share", SHARE_MARGIN)
"""Of the SNN and HA way-points: those that point elsewhere than at the nearest input."""
BEHAVIOUR = (ACTS, HEADS, ("straightness", "straightness", STRAIGHTNESS_MARGIN))
"""What an onlooker sees of the behaviour: what the robots do, where they head, and the line that SNN forms."""

Cell = tuple[str, float]
"""A detection and an exclusion distance."""
