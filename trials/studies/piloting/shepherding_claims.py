"""What `shepherding` asks of a run: whether formations guide better than sheepdogs, and these better than nothing.

Shares are compared in pairs of trials with the same start.
"""

from __future__ import annotations

from functools import partial

from generation.piloting import sheepdogs
from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of
from trials.evidence.outcomes import Outcome, more
from trials.evidence.runs import Cells, Run
from trials.simulations.robots import guided
from trials.studies.piloting.claims import MARGIN
from trials.studies.piloting.design import GUIDES, MEASURE, NOTHING, PILOTS, SHEEPDOGS, TASK

RULE, COUNT = f"{guided.PREFIX}rule", f"{guided.GROUP}.count"
KEYS = (TASK, GUIDES, RULE, COUNT)
RULES = sheepdogs.RULES
COUNTS = (1, 3, 6)
AS_MANY = COUNTS[-1]
"""As many dogs as a formation has robots."""
NAMES = {sheepdogs.VAUGHAN: "Vaughan and others", sheepdogs.STROMBOM: "Strömbom and others"}


def claims(run: Run) -> list[Entry]:
    """For each task and rule an entry of each claim."""
    return answers(run, KEYS, _questions)


def _questions(cells: Cells) -> list[Question]:
    tasks = list(dict.fromkeys(cell[0] for cell in cells.planned()))
    test = f"paired difference of the shares above {MARGIN:g}"
    found = []
    for task in tasks:
        formation, nothing = (task, PILOTS, None, None), (task, NOTHING, None, None)
        for rule, name in NAMES.items():
            as_many, one = (task, SHEEPDOGS, rule, AS_MANY), (task, SHEEPDOGS, rule, 1)
            pairs = (
                (1, formation, as_many, f"{task}: formations less six sheepdogs by {name}"),
                (2, one, nothing, f"{task}: one sheepdog by {name} less none"),
            )
            found += [
                claim_of(
                    __package__, "ours", "shepherding_claims", number, told,
                    all_must_hold(test, partial(_less, cells, first, other)),
                )
                for number, first, other, told in pairs
            ]  # fmt: skip
    return found


def _less(cells: Cells, first: tuple[object, ...], other: tuple[object, ...]) -> list[Outcome]:
    return [more("share that arrives, the first less the other", cells.difference(MEASURE, first, other), MARGIN)]
