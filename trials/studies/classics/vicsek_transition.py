"""The transition of Vicsek et al. 1995: order against noise at density 4, for herds of 40 to 4000 members.

Headings are random at the start, as in the publication. 4000 members at little noise find together late: most within
1000 steps, some not for 7000, while two halves go different ways; their part of the curve has wide intervals. From
order they settle at once: `--set formation.heading_spread_deg=0`. No claim rests on that part.
"""

from __future__ import annotations

from flocking.parameters import Parameter
from trials.simulations.kinematic.fields import group, trial
from trials.studies.classics.vicsek import COUNT, NOISE, claims, figures
from trials.types import Trial

REPEATS = 5
RECORD = "none"
CONDITIONS = {
    COUNT: (40, 100, 400, 4000),
    NOISE: (0.1, 1.0, 2.0, 3.0, 3.5, 4.0, 4.5, 5.0),
}
SOURCES = {
    "herd.count": Parameter("members", "Vicsek et al. 1995, figure 2a; its 10000 are left out", published=True),
    "formation.heading_spread_deg": Parameter("deg", "Vicsek et al. 1995: random directions", published=True),
    "steps": Parameter("", "a choice: not published; the last half is measured"),
}
KEY_MEASURES = ("polarization", "nearest_neighbour_distance")


def base(repeat: int) -> Trial:
    """A periodic square of side sqrt(N / 4) m, places at random."""
    return trial(
        "vicsek-transition",
        repeat,
        [group("vicsek", 400)],
        world="periodic",
        steps=2000,
        every=10,
        cut_m=1.0,
    )


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures"]
