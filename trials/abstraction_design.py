"""The cells of `information-abstraction`: each law with less and less information about the others, and its control.

Poses are taken away by bearings alone (every input stands at an assumed distance, the law's own spacing), single
members by the largest group of them (linked by gaps up to the law's spacing, or by the angle of figure 4.5), perfect
detection by a laser's view of discs of a Create's proportions. Bearings alone are for the laws that read no more than
positions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from trials import law_survey
from trials.kinematic.fields import DETECTIONS
from trials.kinematic.herd import BEARINGS_ALONE
from trials.law_survey import LAW
from trials.types import Trial, Value

INFORMATION, DETAIL, DETECTION = "herd.information", "herd.selection", "herd.pipeline"
KEYS = (LAW, INFORMATION, DETAIL, DETECTION, *law_survey.CONTROL_KEYS)
POSES, BEARINGS = "poses", "bearings"
PERFECT = DETECTIONS[0]
MEMBER_CENTRIC, GROUP_CENTRIC = "all", "densest"
"""The second stands for a selection with the law's own threshold."""
ANGLE_DEG = 10.0
"""Splitting threshold of bearings: Fine 2015, figure 4.5."""
LINK = 1.0
"""Splitting threshold of poses, in spacings of the law's herd: as figure 4.5's 0.5 to the spacing of that herd."""
BODY = 0.165
"""Radius of a member in spacings: a Create's at its formations' spacing of 1 m."""
LENGTH = law_survey.Length(spacings=6.0, most_steps=600)
"""More than once across the starting square of 25, where that is not too long."""


class Told(NamedTuple):
    """What members are told of one another."""

    information: str
    detail: str
    detection: str

    def words(self) -> str:
        detail = "members" if self.detail == MEMBER_CENTRIC else "group"
        return f"{self.information}, {detail}, {self.detection}"


ALL_TOLD = tuple(
    Told(information, detail, detection)
    for information in (POSES, BEARINGS)
    for detail in (MEMBER_CENTRIC, GROUP_CENTRIC)
    for detection in DETECTIONS
)
"""From everything to next to nothing; the first is perfect poses."""


def permits(law: str, information: str, detail: str = MEMBER_CENTRIC) -> bool:
    """Whether a law can do with that."""
    told = information == POSES or law_survey.needs(law) <= BEARINGS_ALONE
    return told and (detail == MEMBER_CENTRIC or not law_survey.tessellates(law))


def cell(law: str, told: Told) -> dict[str, Value]:
    """The conditions of a law that is told so much."""
    return {
        LAW: law,
        INFORMATION: told.information,
        DETAIL: selection(law, told.information, told.detail),
        DETECTION: told.detection,
    }


def selection(law: str, information: str, detail: str) -> str:
    """The text of the selection that a level of detail means for a law; another text means itself."""
    if detail != GROUP_CENTRIC:
        return detail
    if information == BEARINGS:
        return f"densest-angle({ANGLE_DEG:g})"
    return f"densest-distance({LINK * law_survey.herd_of(law).spacing_m:g})"


def cells(conditions: Mapping[str, Sequence[Any]]) -> list[dict[str, Value]]:
    """Of every law all that it permits, and the controls."""
    laws = law_survey.wanted_laws(conditions)
    found = [
        cell(law, Told(information, detail, detection))
        for law in laws
        for information in conditions[INFORMATION]
        for detail in conditions[DETAIL]
        if permits(law, information, detail)
        for detection in conditions[DETECTION]
    ]
    return found + law_survey.controls(laws, LENGTH)


def finish(trial: Trial) -> Trial:
    """Lengths in proportion to the law's spacing."""
    spacing = law_survey.herd_of(trial.groups[0].law).spacing_m
    return law_survey.finished(trial, LENGTH, assumed_distance_m=spacing, silhouette_m=BODY * spacing)


def words_left_out() -> str:
    """The laws that take no part, and those of which less is asked, with the reasons."""
    laws = law_survey.taking_part()
    reasons = [f"{law} ({why})" for law, why in law_survey.left_out().items()]
    whole = [law for law in laws if not permits(law, BEARINGS)]
    cells = [law for law in laws if law_survey.tessellates(law)]
    return (
        f"Left out: {'; '.join(reasons)}. Not by bearings alone, since they read headings or velocities, which "
        f"bearings do not give: {', '.join(whole)}. Not by groups, since they select by the Voronoi cells of all: "
        f"{', '.join(cells)}."
    )
