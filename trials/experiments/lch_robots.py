"""LCH on four Creates (Fine 2015, section 4.2): the four variations from a single group, ten trials each.

An open floor "that can be considered infinite". Repeat r has the same start and noise in all four variations. The
publication gives neither the length of the trials, nor the splitting thresholds on robots, nor the step d: see the
laws' values for Creates. A robot that sees nobody keeps its direction.
"""

from __future__ import annotations

from trials.lch_figures import VARIATIONS
from trials.lch_robots_claims import KEYS, claims
from trials.lch_robots_figures import figures
from trials.types import Group, Trial

REPEATS = 10
RECORD = "first"
(LAW,) = KEYS
CONDITIONS = {LAW: VARIATIONS}
KEY_MEASURES = (
    "mmd",
    "polarization",
    "group_speed",
    "net_displacement",
    "largest_share",
    "kept_share",
    "none_share",
    "follow_share",
)


def base(repeat: int) -> Trial:
    """Four robots on the open floor."""
    return Trial(
        experiment="lch-robots",
        index=1,
        seed=1,
        repeat=repeat,
        world="open-floor",
        formation="single-group",
        duration_s=60.0,
        groups=(Group(count=4, law="lch-member-pose", law_parameters={"keeps_direction": True}),),
    )


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "base", "claims", "figures"]
