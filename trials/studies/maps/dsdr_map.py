"""Deviations along x that DSDR's four parameters bring about in ten members, and in 1, 3 and 7: 1,024 configurations.

Fine 2015, section 7.4.2 and figure 7.14. Eight angles and four lengths of each of both walls make them. Its claims
are on ten members; the other group sizes stand beside them. A member alone has no deviation.
"""

from __future__ import annotations

from flocking.parameters import Parameter
from trials.studies.maps import design
from trials.studies.maps.claims import of_dsdr as claims
from trials.studies.maps.design import COUNT, IN_A_LINE, SIZES
from trials.studies.maps.figures import of_dsdr as figures
from trials.types import Trial

REPEATS = 6
RECORD = "none"
CONDITIONS = {COUNT: (IN_A_LINE, *SIZES)}
SOURCES = {
    COUNT: Parameter("members", "ten: Fine 2015, section 7.4.2; 1, 3 and 7: as in its other maps", published=True),
    "grid": Parameter("", "1,024 configurations as in figure 7.14; eight angles and four lengths are a choice"),
    "formation.size_m": Parameter("m", "not published: members all over the corridor's width, less a metre each side"),
}
KEY_MEASURES = ("configurations", "x_deviation_low", "x_deviation", "x_deviation_high", "x_deviation_below")


def base(repeat: int) -> Trial:
    """Ten members all over the corridor's width."""
    return design.base(
        "dsdr-map",
        repeat,
        "dsdr",
        IN_A_LINE,
        refined="left_deg, left_m, right_deg, right_m",
        grid="8, 4, 8, 4",
        formation_parameters={"size_m": 10.0},
    )


__all__ = ["CONDITIONS", "KEY_MEASURES", "RECORD", "REPEATS", "SOURCES", "base", "claims", "figures"]
