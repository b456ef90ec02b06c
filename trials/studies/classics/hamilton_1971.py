"""Hamilton's selfish herd (section 2.1 of Fine 2015): his two rules end in many small groups, with merging in one.

A hundred holonomic members at random, all of which compute their next way-point at the same moment and move one
body-length towards it: HA in its original form (algorithm 1), SNN (Hamilton's two-dimensional model), and the latter
with the merging of groups that Hamilton proposed. Repeat r has the same start with all three rules.
"""

from __future__ import annotations

from flocking.parameters import Parameter
from trials.simulations.kinematic.fields import group, trial
from trials.studies.classics.hamilton import MERGING, ORIGINAL, claims, figures
from trials.types import Trial

REPEATS = 20
RECORD = "first"
CONDITIONS = {"herd.law": (*ORIGINAL, MERGING)}
KEY_MEASURES = ("groups_start", "groups_end", "largest_share_end", "mmd_end")
SOURCES = {
    "cut_m": Parameter("m", "a choice: the repulsion distance of two body-lengths and a step more"),
    "herd.count": Parameter("members", "a choice: not published"),
}


def base(repeat: int) -> Trial:
    """A hundred members, four body-lengths a member, in unbounded space."""
    return trial("hamilton-1971", repeat, [group("hamilton-2d", 100)], world="unbounded", steps=200, cut_m=3.0)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures"]
