"""Table 8.1 of Fine 2015 held against a run, and what it shows as a claim: walls guide better than robots do.

A mean of ours agrees with a published one within `TENTH`: a published mean of ten trials of four robots comes in steps
of 0.025, and its standard error is some 0.05 to 0.1.
"""

from __future__ import annotations

from functools import partial

from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of, published
from trials.evidence.outcomes import Outcome, more, near
from trials.evidence.runs import Cells, Run
from trials.studies.piloting.design import KEYS, MEASURE, PILOTS, WALLS

TENTH = 0.1
MARGIN = 0.025
"""The smallest difference of means that counts: one robot of four, in one trial of ten. A choice."""
NAMES = {WALLS: "walls", PILOTS: "six robots"}


def claims(run: Run) -> list[Entry]:
    """An entry a cell of the table, and one a task for the claim."""
    return answers(run, KEYS, _questions)


def _questions(cells: Cells) -> list[Question]:
    table = published(__package__, "fine2015", "table_8_1")
    found = [
        Question(
            source="fine2015 table_8_1 (section 8.2)",
            quantity=f"{task}, guided by {NAMES[guides]}",
            claim=f"mean fitness of ten trials of {task} guided by {NAMES[guides]}: {rate:g}",
            judge=all_must_hold(
                f"mean of the trials within ±{TENTH:g} of it (two one-sided tests)",
                partial(_rate, cells, task, guides, rate),
            ),
            published=rate,
        )
        for guides in NAMES
        for task, rate in table[guides].items()
    ]
    tasks = list(dict.fromkeys(cell[0] for cell in cells.planned()))
    return found + [
        claim_of(
            __package__, "ours", "piloting_claims", 1, f"{task}: walls less robots",
            all_must_hold(f"paired difference of the shares above {MARGIN:g}", partial(_less, cells, task)),
        )
        for task in tasks
    ]  # fmt: skip


def _rate(cells: Cells, task: str, guides: str, rate: float) -> list[Outcome]:
    return [near("share that arrives", cells.array(MEASURE, task, guides), rate, TENTH)]


def _less(cells: Cells, task: str) -> list[Outcome]:
    differences = cells.difference(MEASURE, (task, WALLS), (task, PILOTS))
    return [more("share that arrives, walls less robots", differences, MARGIN)]
