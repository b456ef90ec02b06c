"""Which laws keep flocking as information is taken away (Fine 2015, chapter 4, what it leaves open).

Every law that permits it, told of the others by poses or by bearings alone, member by member or by their largest group,
through perfect, member-based, member-extrapolated or sensor-based detection: 25 members of the law's own herd. Repeat r
has the same start in all cells of a law; each law's control is random motion in the same herd.
"""

from __future__ import annotations

from trials.simulations.kinematic.fields import DETECTIONS, group, trial
from trials.studies.information import law_survey
from trials.studies.information.abstraction_claims import claims
from trials.studies.information.abstraction_design import (
    DETAIL,
    DETECTION,
    GROUP_CENTRIC,
    INFORMATION,
    MEMBER_CENTRIC,
    cells,
    finish,
)
from trials.studies.information.abstraction_figures import figures
from trials.studies.information.law_survey import LAW
from trials.types import Trial

REPEATS = 20
RECORD = "none"
CONDITIONS = {
    LAW: law_survey.taking_part(),
    INFORMATION: ("poses", "bearings"),
    DETAIL: (MEMBER_CENTRIC, GROUP_CENTRIC),
    DETECTION: DETECTIONS,
}
KEY_MEASURES = ("largest_share", "polarization", "mmd")


def base(repeat: int) -> Trial:
    """Twenty-five members in the law's own space, of whose ways only the ends are kept."""
    return trial("information-abstraction", repeat, [group(law_survey.CONTROL, law_survey.COUNT)], keeps_way=False)


__all__ = [
    "CONDITIONS",
    "KEY_MEASURES",
    "RECORD",
    "REPEATS",
    "base",
    "cells",
    "claims",
    "figures",
    "finish",
]
