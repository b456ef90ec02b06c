"""The transfer of elites from kinematic members to Creates, beside the junction without a wall. Not published.

A wall transfers where Creates show the behaviour with it: 90 % of seven are all seven. A difference of shares counts
from `MARGIN` on, a choice.
"""

from __future__ import annotations

from functools import partial

from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of
from trials.evidence.outcomes import Outcome, above, more
from trials.evidence.runs import Cells, Run

WALL = "world.wall"
HALF, MARGIN = 0.5, 0.05


def claims(run: Run) -> list[Entry]:
    """Two entries for each arm of the run."""
    return answers(run, (WALL,), _questions)


def _questions(cells: Cells) -> list[Question]:
    most = all_must_hold("share of the elites in which all Creates turn right above one half", partial(_rate, cells))
    uplift = all_must_hold("paired differences above the margin", partial(_uplift, cells))
    return [
        claim_of(__package__, "ours", "transfer", 1, "transfer rate of the elites", most),
        claim_of(__package__, "ours", "transfer", 2, "with the wall less without", uplift),
    ]


def _rate(cells: Cells) -> list[Outcome]:
    return [above("share of the elites", cells.array("elicited", True), HALF, MARGIN, bounds=(0.0, 1.0))]


def _uplift(cells: Cells) -> list[Outcome]:
    return [
        more("share of the Creates that turn right", cells.difference("fitness", (True,), (False,)), MARGIN),
        more("share in which all do", cells.difference("elicited", (True,), (False,)), MARGIN, decides=False),
    ]
