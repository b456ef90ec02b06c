"""Whether what differs in an ablation matters to who is guided by robots, as claims of ours.

Compared are the least and the largest value of each thing that is a number, in pairs of trials with the same start.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from generation.piloting import plan as plans
from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of
from trials.evidence.outcomes import Outcome, more
from trials.evidence.runs import Cells, Run
from trials.studies.piloting.claims import MARGIN
from trials.studies.piloting.design import MEASURE, PILOTS

KEYS = (
    "piloting.guides", "piloting.robots_a_wall", "pilots.speed_m_s", "herd.count", "herd.law", "herd.pipeline",
)  # fmt: skip
Values = tuple[Any, ...]
"""Of the keys, in one cell."""
NUMBERS = ("robots a wall", "speed of the pilots", "members of the herd")
"""Of `KEYS`, those from the second on that are numbers: each has a claim."""


def claims(run: Run) -> list[Entry]:
    """An entry for each of what could explain the gap, as far as the run has its cells."""
    return answers(run, KEYS, _questions)


def _questions(cells: Cells) -> list[Question]:
    planned, found = list(cells.planned()), []
    for number, told in enumerate(NUMBERS, start=1):
        ends = _ends(planned, number)
        if ends is None:
            continue
        least, most = ends
        judge = all_must_hold(f"paired difference of the shares above {MARGIN:g}", partial(_more, cells, most, least))
        quantity = f"{told}: {_shown(number, most[number])} less {_shown(number, least[number])}"
        found.append(claim_of(__package__, "ours", "ablation_claims", number, quantity, judge))
    return found


def _shown(number: int, value: object) -> str:
    """A value, with the number of pilots where that follows from it."""
    return (
        f"{value} ({plans.AT_ONCE * int(str(value))} pilots)" if KEYS[number].endswith("robots_a_wall") else str(value)
    )


def _ends(planned: Sequence[Values], key: int) -> tuple[Values, Values] | None:
    """Of the cells that robots guide and that differ in one key alone, that with its least and that with its largest
    value; None where there are no two."""
    groups: dict[Values, list[Values]] = {}
    for cell in planned:
        if cell[0] == PILOTS:
            groups.setdefault((*cell[:key], *cell[key + 1 :]), []).append(cell)
    most = max((len(each) for each in groups.values()), default=0)
    if most < 2:
        return None
    largest = next(each for each in groups.values() if len(each) == most)
    ordered = sorted(largest, key=lambda cell: float(cell[key]))
    return ordered[0], ordered[-1]


def _more(cells: Cells, one: Values, other: Values) -> list[Outcome]:
    return [more("share that arrives", cells.difference(MEASURE, one, other), MARGIN)]
