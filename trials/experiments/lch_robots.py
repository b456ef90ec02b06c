"""LCH on four Creates (Fine 2015, section 4.2): the four variations from a single group, ten trials each.

An open floor "that can be considered infinite". Repeat r has the same start and noise in all four variations. The
publication gives neither the length of the trials, nor the splitting thresholds on robots, nor the step d: see the
laws' values for Creates. A robot that sees nobody keeps its direction.
"""

from __future__ import annotations

from flocking.parameters import Parameter
from trials.lch_figures import VARIATIONS
from trials.lch_robots_claims import KEYS, claims
from trials.lch_robots_figures import figures
from trials.types import Group, Trial

REPEATS = 10
RECORD = "first"
(LAW,) = KEYS
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


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures"]
