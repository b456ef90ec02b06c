"""The cells of `information-abstraction`: each law with less and less information about the others, and its control.

Poses are taken away by bearings alone (every input stands at an assumed distance, the law's own spacing), single
members by the largest group of them (linked by gaps up to the law's spacing, or by the angle of figure 4.5), perfect
detection by a laser's view of discs of a Create's proportions. Bearings alone are for the laws that read no more than
positions. The four LCH variations are one rule, `lch`, of which each reads by itself what one column tells; they are
asked that and no more, and all are held against the member-centric one with poses.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from trials.evidence.claims import published
from trials.simulations.kinematic.fields import DETECTIONS
from trials.simulations.kinematic.herd import BEARINGS_ALONE
from trials.studies.information import law_survey
from trials.studies.information.law_survey import LAW
from trials.types import Trial, Value

INFORMATION, DETAIL, DETECTION = "herd.information", "herd.selection", "herd.pipeline"
KEYS = (LAW, INFORMATION, DETAIL, DETECTION, *law_survey.CONTROL_KEYS)
POSES, BEARINGS = "poses", "bearings"
PERFECT = DETECTIONS[0]
MEMBER_CENTRIC, GROUP_CENTRIC = "all", "densest"
"""The second stands for a selection with the law's own threshold."""
LCH = "lch"
VARIATIONS = {
    (POSES, GROUP_CENTRIC): "lch-group-pose",
    (BEARINGS, GROUP_CENTRIC): "lch-group-bearing",
    (POSES, MEMBER_CENTRIC): "lch-member-pose",
    (BEARINGS, MEMBER_CENTRIC): "lch-member-bearing",
}
"""Of LCH, by what each reads: Fine 2015, section 4.1."""
ANGLE_DEG = float(published(__package__, "fine2015", "figure_4_5")["st_angular_deg"])
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


def rule_of(law: str) -> str:
    """What a law is a variation of; most are their own."""
    return LCH if law in VARIATIONS.values() else law


def law_of(rule: str, information: str = POSES, detail: str = MEMBER_CENTRIC) -> str:
    """The law by which a rule does with that."""
    return VARIATIONS[information, detail if detail == GROUP_CENTRIC else MEMBER_CENTRIC] if rule == LCH else rule


def permits(rule: str, information: str, detail: str = MEMBER_CENTRIC) -> bool:
    """Whether a rule can do with that."""
    law = law_of(rule, information, detail)
    told = information == POSES or law_survey.needs(law) <= BEARINGS_ALONE
    return told and (detail == MEMBER_CENTRIC or not law_survey.tessellates(law))


def cell(rule: str, told: Told) -> dict[str, Value]:
    """The conditions of a rule that is told so much."""
    return {
        LAW: law_of(rule, told.information, told.detail),
        INFORMATION: told.information,
        DETAIL: selection(rule, told.information, told.detail),
        DETECTION: told.detection,
    }


def selection(rule: str, information: str, detail: str) -> str:
    """The text of the selection that a level of detail means for a rule; another text means itself."""
    if detail != GROUP_CENTRIC:
        return detail
    if rule == LCH:
        return MEMBER_CENTRIC  # the variation's own sets hold the group alone
    if information == BEARINGS:
        return f"densest-angle({ANGLE_DEG:g})"
    return f"densest-distance({LINK * law_survey.herd_of(rule).spacing_m:g})"


def cells(conditions: Mapping[str, Sequence[Any]]) -> list[dict[str, Value]]:
    """Of every law all that it permits, and the controls."""
    laws = law_survey.wanted_laws(conditions)
    found = [
        cell(rule, Told(information, detail, detection))
        for rule in dict.fromkeys(map(rule_of, laws))
        for information in conditions[INFORMATION]
        for detail in conditions[DETAIL]
        if permits(rule, information, detail) and law_of(rule, information, detail) in laws
        for detection in conditions[DETECTION]
    ]
    return found + law_survey.controls(laws, LENGTH)


def finish(trial: Trial) -> Trial:
    """Lengths in proportion to the law's spacing."""
    spacing = law_survey.herd_of(trial.groups[0].law).spacing_m
    return law_survey.finished(trial, LENGTH, assumed_distance_m=spacing, silhouette_m=BODY * spacing)


def words_left_out() -> str:
    """The laws that take no part, and those of which less is asked, with the reasons."""
    laws = dict.fromkeys(map(rule_of, law_survey.taking_part()))
    reasons = [f"{law} ({why})" for law, why in law_survey.left_out().items()]
    whole = [law for law in laws if not permits(law, BEARINGS)]
    cells = [law for law in laws if law_survey.tessellates(law_of(law))]
    return (
        f"Left out: {'; '.join(reasons)}. Not by bearings alone, since they read headings or velocities, which "
        f"bearings do not give: {', '.join(whole)}. Not by groups, since they select by the Voronoi cells of all: "
        f"{', '.join(cells)}."
    )
