"""The transfer of elites from kinematic members to Creates. Not published; a half is what symmetry allows no wall."""

from __future__ import annotations

from functools import partial

from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of
from trials.evidence.outcomes import Outcome, above, more
from trials.evidence.runs import Cells, Run

HALF, SHOWN_MARGIN = 0.5, 0.1


def claims(run: Run) -> list[Entry]:
    """One entry for each arm of the run."""
    return answers(run, (), _questions)


def _questions(cells: Cells) -> list[Question]:
    judge = all_must_hold("share of the elites in which Creates show it above one half (exact)", partial(_shown, cells))
    return [claim_of(__package__, "ours", "transfer", 1, "transfer rate of the elites", judge)]


def _shown(cells: Cells) -> list[Outcome]:
    shares = cells.array("elicited")
    turned = more("share of the robots that turn right", cells.array("fitness"), HALF, decides=False)
    return [above("share of the elites", shares, HALF, SHOWN_MARGIN, bounds=(0.0, 1.0), exact=True), turned]
