"""What laws lose within walls, among obstacles and out of step (Fine 2015, sections 3.5.2, 3.6.1 and 9.1.1).

Every law in free, bounded and obstacle-filled space, synchronous and asynchronous, within walls also with the shared
avoidance added ("+"); 25 members of the law's own herd. Repeat r has the same start in all cells of a law, about the
middle of its world. And whether bumper contacts alone can make members flock.
"""

from __future__ import annotations

from trials.simulations.kinematic.fields import group, trial
from trials.studies.information import law_survey
from trials.studies.information.environment_claims import claims
from trials.studies.information.environment_design import (
    AS_LAW,
    AVOID,
    BUMPER,
    OBSTACLES,
    SYNCHRONOUS,
    WORLD,
    WORLDS,
    cells,
    finish,
)
from trials.studies.information.environment_figures import figures
from trials.studies.information.law_survey import LAW
from trials.types import Trial

REPEATS = 20
RECORD = "none"
CONDITIONS = {
    LAW: (*law_survey.taking_part(), BUMPER),
    WORLD: WORLDS,
    SYNCHRONOUS: (True, False),
    OBSTACLES: (AS_LAW, AVOID),
}
KEY_MEASURES = ("largest_share", "polarization", "mmd")


def base(repeat: int) -> Trial:
    """Twenty-five members that start in the middle, of whose ways only the ends are kept."""
    return trial(
        "environment-and-synchrony",
        repeat,
        [group(law_survey.CONTROL, law_survey.COUNT)],
        world=WORLDS[0],
        formation="single-group",
        keeps_way=False,
    )


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "base", "cells", "claims", "figures", "finish"]
