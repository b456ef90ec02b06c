"""The transition of Vicsek et al. 1995: order against noise at density 4, for herds of 40 to 4000 members."""

from __future__ import annotations

from trials.kinematic.fields import group, trial
from trials.types import Trial
from trials.vicsek_report import COUNT, NOISE, claims, figures

REPEATS = 5
RECORD = "none"
CONDITIONS = {
    COUNT: (40, 100, 400, 4000),
    NOISE: (0.1, 1.0, 2.0, 3.0, 3.5, 4.0, 4.5, 5.0),
}
KEY_MEASURES = ("polarization", "nearest_neighbour_distance")


def base(repeat: int) -> Trial:
    """A periodic square of side sqrt(N / 4) m, all places and headings at random."""
    return trial("vicsek-transition", repeat, [group("vicsek", 400)], world="periodic", steps=1000, every=10, cut_m=1.0)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "base", "claims", "figures"]
