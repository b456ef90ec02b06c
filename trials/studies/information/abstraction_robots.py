"""Information abstraction on Creates: the cells, the claims and the map of `information-abstraction-robots`.

Judged as in the kinematic herd. The four LCH variations are told different things of the same rule: all are held
against the member-centric one with poses from global knowledge; any other law against itself with that knowledge.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from trials.evidence.claims import Entry, Judged, Question, answers, published
from trials.evidence.outcomes import Outcome
from trials.evidence.runs import Cells, Run, UndecidedError
from trials.evidence.summary import shown_value
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import Figure, Place
from trials.studies.information.abstraction_design import LCH, VARIATIONS, rule_of
from trials.studies.information.law_judges import IN_WORDS, Cell, alike, better, held_in_all, mean_of, verdict
from trials.studies.information.law_survey import CONTROL, LAW, judged_by, told_apart_by
from trials.studies.information.verdict_maps import Square, verdict_map
from trials.types import Value
from worlds.formations import SingleGroup

SPACING = SingleGroup().spacing_m
"""m between neighbours of the starting formation."""
DETAIL, DETECTION = "herd.selection", "herd.pipeline"
KEYS = (LAW, DETAIL, DETECTION)
DETECTIONS = PERFECT, *_ = ("perfect", "member-based", "member-extrapolated", "sensor-based")
MEMBER_CENTRIC, GROUP_CENTRIC = "all", f"densest-distance({SPACING:g})"
LAWS = (*VARIATIONS.values(), "extended-hamilton", "snn", "couzin")
TEST = (
    "in each condition every measure equivalent to the same rule with poses from global knowledge (two one-sided "
    "tests, paired) and better than random motion (t test, paired); the number is the share for which that is shown; "
    f"{IN_WORDS}"
)


def cells(conditions: Mapping[str, Sequence[Any]]) -> list[dict[str, Value]]:
    """Of each law what it is asked, and the control."""
    found: list[dict[str, Value]] = [
        {LAW: law, DETAIL: detail, DETECTION: detection}
        for law in conditions[LAW]
        for detail in conditions[DETAIL]
        if detail == MEMBER_CENTRIC or rule_of(law) != LCH
        for detection in conditions[DETECTION]
    ]
    return [*found, {LAW: CONTROL, DETAIL: MEMBER_CENTRIC, DETECTION: PERFECT}]


def best_of(law: str) -> Cell:
    """The cell that a law is held against."""
    return "lch-member-pose" if rule_of(law) == LCH else law, MEMBER_CENTRIC, PERFECT


def kept(cells: Cells, cell: Cell) -> list[Outcome]:
    """That a law does as it does at its best, and better than random motion. Raises `UndecidedError`."""
    law = str(cell[0])
    return [*alike(cells, judged_by(law), cell, best_of(law), SPACING), *flocks(cells, cell)]


def flocks(cells: Cells, cell: Cell) -> list[Outcome]:
    """That it does better than random motion. Raises `UndecidedError`."""
    return better(cells, told_apart_by(str(cell[0])), cell, (CONTROL, MEMBER_CENTRIC, PERFECT), SPACING)


def asked_of(cells: Cells) -> dict[str, list[Cell]]:
    """The cells of each law in the run, in order."""
    found: dict[str, list[Cell]] = {}
    for cell in cells.planned():
        if cell[0] != CONTROL:
            found.setdefault(str(cell[0]), []).append(cell)
    return found


def claims(run: Run) -> list[Entry]:
    """An entry for each law, for each arm of the run."""
    return answers(run, KEYS, _questions)


def _questions(cells: Cells) -> list[Question]:
    told = published(__package__, "fine2015", "information")
    words = told["claims"][1]
    return [
        Question(
            source=f"fine2015, section {told['sections'][1]}",
            quantity=shown_value(law),
            claim=words if rule_of(law) == LCH else f"{words}: left open",
            judge=partial(_judged, cells, law, asked),
        )
        for law, asked in asked_of(cells).items()
    ]


def figures(run: Run, folder: Path) -> list[Figure]:
    """The map of each arm of the run."""
    return by_arm(run, folder, KEYS, _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    cells = Cells(run.trials, run.rows(), KEYS)
    columns = [(detail, detection) for detail in (MEMBER_CENTRIC, GROUP_CENTRIC) for detection in DETECTIONS]
    rows = {
        shown_value(law): [_square(cells, (law, *column)) if (law, *column) in asked else None for column in columns]
        for law, asked in asked_of(cells).items()
    }
    names = [f"{'members' if detail == MEMBER_CENTRIC else 'group'}, {detection}" for detail, detection in columns]
    key = "numbers: what the law is judged by (largest group's share; MMD in metres, or polarization)"
    caption = (
        "Green: shown to do as the same rule with poses from global knowledge, and better than random motion; red: "
        "shown not to; grey: neither; white: not asked of this law."
    )
    title = "Who keeps flocking on Creates as information is taken away"
    return [draw.save(verdict_map(rows, names, key), place, "information", title, caption)]


def _square(cells: Cells, cell: Cell) -> Square:
    law = str(cell[0])
    try:
        agrees = verdict(flocks(cells, cell) if cell == best_of(law) else kept(cells, cell))
    except UndecidedError:
        agrees = None
    return Square(agrees, " ".join(f"{mean_of(cells, measure, cell):.2f}" for measure in judged_by(law)))


def _judged(cells: Cells, law: str, asked: Sequence[Cell]) -> Judged:
    outcomes = [kept(cells, cell) for cell in asked if cell != best_of(law)]
    found = [verdict(each) for each in outcomes]
    n = len(cells.values("mmd", *best_of(law)))
    if not found:
        raise UndecidedError("the run takes no information away")
    label = f"shown in {found.count(True)} of {len(found)} conditions, lost in {found.count(False)}"
    return held_in_all(outcomes, label, n, TEST)
