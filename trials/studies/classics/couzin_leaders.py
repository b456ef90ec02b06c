"""Effective leadership (Couzin et al. 2005): how well a few informed members steer 10 to 200, at two speeds.

Members are whole: of ten, a share of 0.02 or 0.05 informs nobody, and those cells have no accuracy.
"""

from __future__ import annotations

from flocking.parameters import Parameter
from trials.simulations.kinematic.fields import group, trial
from trials.studies.classics.couzin import COUNT, SHARE, SPEED, claims, figures
from trials.types import Trial

REPEATS = 20
RECORD = "first"
CONDITIONS = {
    COUNT: (10, 30, 50, 100, 200),
    SHARE: (0.02, 0.05, 0.1, 0.2, 0.3, 0.5),
    SPEED: (1.0, 3.0),
}
SOURCES = {
    SPEED: Parameter("m/s", "not in the document: 3 is that of Couzin et al. 2002, 1 a unit a second"),
    "herd.count": Parameter("members", "Couzin et al. 2005, figure 1", published=True),
    "cut_m": Parameter("m", "the range of interaction: groups farther apart do not know of one another"),
    "steps": Parameter("", "a choice"),
}
KEY_MEASURES = ("goal_alignment", "polarization", "largest_share_end", "groups_end")


def base(repeat: int) -> Trial:
    """A group at random, looking all ways; the goal is so far along x that it is a direction."""
    return trial("couzin-leaders", repeat, [group("couzin", 50)], world="unbounded", steps=1000, every=10, cut_m=6.0)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures"]
