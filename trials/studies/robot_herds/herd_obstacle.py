"""Robot herds, an obstacle: a disc stands in the way, which creatures on a collision course pass at 1.5 of its radii.

Hodgins and Brogan 1994, section 5, fourth test and figure 8. The publication gives neither the size of the obstacle nor
where it is: a disc of 3 m appears 20 m ahead of the herd's centre, or, as an easier and a harder test, 28 m and 13 m.
It stops nobody: who runs into it is counted. Forty seconds show who rejoins; the publication's test took 15 s.
"""

from __future__ import annotations

from trials.studies.robot_herds import design
from trials.studies.robot_herds.claims import obstacle_claims as claims
from trials.studies.robot_herds.figures import obstacle_figures as figures
from trials.types import Trial

REPEATS = 10
RECORD = "none"
CONDITIONS = {design.AHEAD: (design.USUAL_M, design.EASIER_M, design.HARDER_M), design.BODY: design.BODIES}
SOURCES = design.SOURCES
KEY_MEASURES = ("upright", "collisions", "obstacle_hits", "first_hits", "parted_m", "rejoin_s", "breakaways")


def base(repeat: int) -> Trial:
    """After half a minute of steady running."""
    return design.running(
        "herd-obstacle",
        repeat,
        40.0,
        settle_s=design.SETTLED_S,
        law_parameters={"look_ahead_m": 24.0},
        obstacle_radius_m=3.0,
    )


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures"]
