"""Kirchner 2006, appendix A: distances of a cone from half a foot to six, five tests each, by runs of pixels.

The thesis's equations take 5.12 pixels a degree over the whole image, as an equal-angle lens has them; what they make
of a pinhole image is told beside it. The cone stands before the left camera, put down to within 3 mm.
"""

from __future__ import annotations

from flocking.parameters import Parameter
from trials.evidence.claims import published
from trials.simulations.cones.fields import trial
from trials.studies.monocular.cone_claims import DISTANCE, PROJECTION
from trials.studies.monocular.cone_claims import distance_claims as claims
from trials.studies.monocular.cone_figures import distance_figures as figures
from trials.studies.monocular.design import FOOT
from trials.types import Trial

REPEATS = 5
RECORD = "none"
ROWS: list[list[float]] = published(__package__, "kirchner2006", "appendix_a")["rows"]
CONDITIONS = {DISTANCE: tuple(round(row[0] * FOOT, 6) for row in ROWS), PROJECTION: ("equal-angle", "pinhole")}
SOURCES = {
    DISTANCE: Parameter("m", "Kirchner 2006, appendix A", published=True),
    PROJECTION: Parameter("", "Kirchner 2006, section 3.6.6, and what a renderer gives"),
}
KEY_MEASURES = ("distance", "distance_error", "bearing_error", "run")


def base(repeat: int) -> Trial:
    """One look at a cone."""
    return trial("cone-distance", repeat, looks=1)


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures"]
