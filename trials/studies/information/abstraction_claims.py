"""Which laws are information-abstracted, by a run of `information-abstraction`.

A law keeps flocking with less information if, in every measure it is judged by, its herd is equivalent to itself with
perfect poses (two one-sided tests) and better than random motion; one that is not better than random motion with
perfect poses does not flock in this herd, and has nothing to lose. Fine 2015, section 4, calls a law
information-abstracted if what it is told changes nothing; it claims so of the four LCH variations.
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

from trials.evidence.claims import Entry, Judged, Question, answers, published
from trials.evidence.outcomes import Outcome
from trials.evidence.runs import Cells, Run, UndecidedError
from trials.evidence.summary import shown_value
from trials.studies.information import law_survey
from trials.studies.information.abstraction_design import (
    ALL_TOLD,
    KEYS,
    LCH,
    LENGTH,
    Told,
    cell,
    law_of,
    permits,
    rule_of,
)
from trials.studies.information.law_judges import IN_WORDS, Cell, alike, better, both, held_in_all, verdict
from trials.studies.information.law_survey import LAW

TEST = (
    "in each of the conditions every measure equivalent to perfect poses (two one-sided tests, paired) and better than "
    f"random motion (t test, paired); the number is the share of conditions for which that is shown; {IN_WORDS}"
)


class Kept(NamedTuple):
    """What became of a law in one condition."""

    told: Told
    agrees: bool | None
    as_before: bool | None
    """Equivalent to perfect poses."""
    flocks: bool | None
    """Better than random motion."""
    outcomes: list[Outcome]
    """Of both."""


def claims(run: Run) -> list[Entry]:
    """An entry for each rule, for each arm of the run."""
    return answers(run, KEYS, _questions)


def _questions(cells: Cells) -> list[Question]:
    told = published(__package__, "fine2015", "information")
    of_lch, _, of_others = told["claims"]
    return [
        Question(
            source=f"fine2015, section {told['sections'][0]}",
            quantity=f"{shown_value(rule)}, by {' and '.join(law_survey.judged_by(law_of(rule)))}",
            claim=of_lch if rule == LCH else of_others,
            judge=partial(_judged, cells, rule),
        )
        for rule in rules_of(cells)
    ]


def rules_of(cells: Cells) -> list[str]:
    """The rules of a run, without their controls."""
    return list(dict.fromkeys(rule_of(law) for law in cells.levels(LAW) if law != law_survey.CONTROL))


def kept(cells: Cells, rule: str) -> list[Kept]:
    """What becomes of a rule in each condition that the run has of it. Raises `UndecidedError`."""
    law, best, control = law_of(rule), cell_of(rule, ALL_TOLD[0]), control_of(rule)
    spacing_m, found = law_survey.herd_of(law).spacing_m, []
    for told in told_of(cells, rule):
        here = cell_of(rule, told)
        same = alike(cells, law_survey.judged_by(law), here, best, spacing_m)
        gained = better(cells, law_survey.told_apart_by(law), here, control, spacing_m)
        as_before, flocks = verdict(same), verdict(gained)
        found.append(Kept(told, both(as_before, flocks), as_before, flocks, [*same, *gained]))
    return found


def told_of(cells: Cells, rule: str) -> list[Told]:
    """The conditions of a rule that the run has."""
    planned = cells.planned()
    return [
        told for told in ALL_TOLD if permits(rule, told.information, told.detail) and cell_of(rule, told) in planned
    ]


def cell_of(rule: str, told: Told) -> Cell:
    """The values of `KEYS` of a rule's cell."""
    values = cell(rule, told)
    return tuple(values.get(key) for key in KEYS)


def control_of(rule: str) -> Cell:
    """Likewise of its control."""
    values = law_survey.control(law_of(rule), LENGTH)
    return tuple(values.get(key) for key in KEYS)


def _judged(cells: Cells, rule: str) -> Judged:
    first, *less = kept(cells, rule)
    if not less:
        raise UndecidedError("the run takes no information away")
    if first.flocks is not True:
        raise UndecidedError("with perfect poses it is not shown to be better than random motion in this herd")
    verdicts = [one.agrees for one in less]
    n = len(cells.values(law_survey.ORDER, *cell_of(rule, ALL_TOLD[0])))
    label = f"shown in {verdicts.count(True)} of {len(verdicts)} conditions, lost in {verdicts.count(False)}"
    return held_in_all([one.outcomes for one in less], label, n, TEST)
