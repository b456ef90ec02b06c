"""LCH on four Creates (Fine 2015, section 4.2): the four variations from a single group, ten trials each.

An open floor "that can be considered infinite". Repeat r has the same start and noise in all four variations. The
publication gives neither the length of the trials, nor the splitting thresholds on robots, nor the step d: see the
laws' values for Creates; the group-centric variations run with figure 4.5's thresholds too. A robot that sees nobody
keeps its direction.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flocking.parameters import Parameter
from trials.simulations.robots.fields import group, trial
from trials.studies.crowded_horizon.figures import VARIATIONS
from trials.studies.crowded_horizon.robots_claims import LAW, THRESHOLDS, claims
from trials.studies.crowded_horizon.robots_figures import figures
from trials.types import Trial, Value

REPEATS = 10
RECORD = "first"
CONDITIONS = {LAW: VARIATIONS}
SOURCES = {
    "world": Parameter("", "Fine 2015, section 4.2: free of obstacles, as good as infinite", published=True),
    "formation": Parameter("", "Fine 2015, section 4.2, drawn in figure 2.5 without numbers", published=True),
    "herd.count": Parameter("robots", "Fine 2015, section 4.2", published=True),
    "herd.law": Parameter("", "Fine 2015, section 4.1: the four variations", published=True),
    "herd.pipeline": Parameter("", "a choice: section 4.2 does not say which"),
}
KEY_MEASURES = (
    "mmd",
    "polarization",
    "group_speed",
    "net_displacement",
    "largest_share",
    "blind_turn_rad_s",
    "none_share",
    "follow_share",
)


def cells(conditions: Mapping[str, Sequence[Any]]) -> list[dict[str, Value]]:
    """The variations, and the group-centric ones with the thresholds of the publication's simulation."""
    laws = [str(law) for law in conditions[LAW]]
    found: list[dict[str, Value]] = [{LAW: law} for law in laws]
    for information, (key, value) in THRESHOLDS.items():
        if f"lch-group-{information}" in laws:
            found.append({LAW: f"lch-group-{information}", key: value})
    return found


def base(repeat: int) -> Trial:
    """Four robots on the open floor."""
    return trial(
        "lch-robots",
        repeat,
        [group("lch-member-pose", 4, law_parameters={"keeps_direction": True})],
        world="open-floor",
        duration_s=60.0,
    )


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures"]
