"""Which laws are information-abstracted, by a run of `information-abstraction`.

A law keeps flocking with less information if, in every measure it is judged by, its herd is equivalent to itself with
perfect poses (two one-sided tests) and better than random motion; one that is not better than random motion with
perfect poses does not flock in this herd, and has nothing to lose. Fine 2015, section 4, calls a law
information-abstracted if what it is told changes nothing; it claims so of the four LCH variations.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from trials import law_survey
from trials.abstraction_design import (
    ALL_TOLD,
    DETAIL,
    DETECTION,
    INFORMATION,
    KEYS,
    LENGTH,
    Told,
    permits,
    selection,
)
from trials.claims import Cells, Entry, Run, UndecidedError, arms, undecided
from trials.law_judges import Cell, alike, better, both, verdict
from trials.law_survey import LAW

SOURCE = "fine2015, section 4"
WORDS = "information-abstracted: its behaviour does not depend on the type and detail of what it is told"
CLAIMED_OF = ("lch-group-pose", "lch-member-pose", "lch-group-bearing", "lch-member-bearing")
LEFT_OPEN = "whether it is information-abstracted: left open"
TEST = (
    "in each of the conditions every measure equivalent to perfect poses (two one-sided tests, paired) and better than "
    "random motion (t test, paired); the number is the share of conditions for which that is shown"
)


class Kept(NamedTuple):
    """What became of a law in one condition."""

    told: Told
    agrees: bool | None
    as_before: bool | None
    """Equivalent to perfect poses."""
    flocks: bool | None
    """Better than random motion."""


def claims(run: Run) -> list[Entry]:
    """An entry for each law, for each arm of the run."""
    entries = []
    for arm, trials in arms(run, KEYS):
        cells = Cells(trials, run.rows(), KEYS)
        entries += [_entry(cells, law, arm) for law in laws_of(cells)]
    return entries


def laws_of(cells: Cells) -> list[str]:
    """The laws of a run, without their controls."""
    return [law for law in cells.levels(LAW) if law != law_survey.CONTROL]


def kept(cells: Cells, law: str) -> list[Kept]:
    """What becomes of a law in each condition that the run has of it. Raises `UndecidedError`."""
    measures, best, control = law_survey.judged_by(law), cell_of(law, ALL_TOLD[0]), control_of(law)
    spacing_m, found = law_survey.herd_of(law).spacing_m, []
    for told in told_of(cells, law):
        cell = cell_of(law, told)
        as_before = verdict(alike(cells, measures, cell, best, spacing_m))
        flocks = verdict(better(cells, measures, cell, control, spacing_m))
        found.append(Kept(told, both(as_before, flocks), as_before, flocks))
    return found


def told_of(cells: Cells, law: str) -> list[Told]:
    """The conditions of a law that the run has."""
    planned = {tuple(trial.conditions.get(key) for key in KEYS) for trial in cells.trials}
    return [told for told in ALL_TOLD if permits(law, told.information, told.detail) and cell_of(law, told) in planned]


def cell_of(law: str, told: Told) -> Cell:
    """The values of `KEYS` of a law's cell."""
    values = {
        LAW: law,
        INFORMATION: told.information,
        DETAIL: selection(law, told.information, told.detail),
        DETECTION: told.detection,
    }
    return tuple(values.get(key) for key in KEYS)


def control_of(law: str) -> Cell:
    """Likewise of its control."""
    values = law_survey.control(law, LENGTH)
    return tuple(values.get(key) for key in KEYS)


def _entry(cells: Cells, law: str, arm: dict[str, object]) -> Entry:
    measures = " and ".join(law_survey.judged_by(law))
    quantity = f"{law}, by {measures}"
    words = WORDS if law in CLAIMED_OF else LEFT_OPEN
    cells.begin()
    try:
        found = kept(cells, law)
    except UndecidedError as why:
        return undecided(SOURCE, quantity, words, str(why), arm)
    first, less = found[0], found[1:]
    if not less:
        return undecided(SOURCE, quantity, words, "the run takes no information away", arm)
    share = sum(one.agrees is True for one in less) / len(less)
    if first.flocks is not True:
        told = "with perfect poses it is not shown to be better than random motion in this herd"
        return undecided(SOURCE, quantity, words, told, arm)
    return Entry(
        source=SOURCE,
        quantity=f"{quantity}: shown in {sum(one.agrees is True for one in less)} of {len(less)} conditions, "
        f"lost in {sum(one.agrees is False for one in less)}",
        published=words,
        measured=share,
        low=math.nan,
        high=math.nan,
        n=len(cells.values(law_survey.ORDER, *cell_of(law, ALL_TOLD[0]))),
        agrees=both(*(one.agrees for one in less)),
        test=TEST,
        margin=math.nan,
        arm=arm,
    )
