"""What Fine 2015 says of Hamilton's simulations (section 2.1.1), held against a run; and where the groups end.

Groups: single linkage at the trial's `cut_m`. "Many small" is read as: more than `MANY` groups at the end, none of
which holds half of the members. "A single compact group": one group, whose members stand nearer to its middle at the
end than at the start.
"""

from __future__ import annotations

from functools import partial
from pathlib import Path

from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of
from trials.evidence.outcomes import Outcome, above, more, near
from trials.evidence.runs import Cells, Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm, panels
from trials.reports.figures import Figure, Place
from trials.reports.ways import ways

LAW = "herd.law"
ORIGINAL, MERGING = ("viscido-ha", "hamilton-2d"), "hamilton-merging"
MANY = 5.0
"""Groups of a hundred members; a choice."""
HALF = 0.5
GROUPS_MARGIN, SHARE_MARGIN, SPREAD_MARGIN_M = 0.5, 0.1, 0.5
"""Choices: half a group; a tenth of the members; half a body-length."""


def claims(run: Run) -> list[Entry]:
    """An entry for each rule's small groups and one for the merging, for each arm of the run."""
    return answers(run, (LAW,), _questions)


def _questions(cells: Cells) -> list[Question]:
    small = f"more than {MANY:g} groups at the end, the largest of less than half of the members"
    single = f"one group within ±{GROUPS_MARGIN:g} (two one-sided tests), nearer together than at the start"
    asked = [(1, law, all_must_hold(small, partial(_small, cells, law))) for law in ORIGINAL]
    asked.append((2, MERGING, all_must_hold(single, partial(_single, cells))))
    return [claim_of(__package__, "fine2015", "hamilton_claims", number, law, judge) for number, law, judge in asked]


def _small(cells: Cells, law: str) -> list[Outcome]:
    free = 1.0 - cells.array("largest_share_end", law)
    return [
        above(f"groups at the end, {law}", cells.array("groups_end", law), MANY, GROUPS_MARGIN),
        above(f"share of the members outside the largest group, {law}", free, HALF, SHARE_MARGIN, bounds=(0.0, 1.0)),
    ]


def _single(cells: Cells) -> list[Outcome]:
    shrunk = cells.array("mmd_start", MERGING) - cells.array("mmd_end", MERGING)
    return [
        near("groups at the end", cells.array("groups_end", MERGING), 1.0, GROUPS_MARGIN),
        more("MMD at the start less that at the end, m", shrunk, SPREAD_MARGIN_M),
    ]


def figures(run: Run, folder: Path) -> list[Figure]:
    """The ways of the first trial with each rule."""
    return by_arm(run, folder, (LAW,), _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    shown = panels(run, [(law, {LAW: law}) for law in (*ORIGINAL, MERGING)])
    caption = "Blue: where members start; green: where they end. The first trial with each rule: same start."
    return [draw.save(ways(shown, columns=3), place, "ways", "Ways", caption, dots=True)]
