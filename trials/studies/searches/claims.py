"""What the searches are held against: random search at equal budget, on the same starts. None of it is published.

Robustness is that of the best environment on new starts. A difference counts from `MARGIN` on, a fiftieth of what a
rate can be, and a number of environments from one on; both are choices.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of
from trials.evidence.outcomes import Outcome, more
from trials.evidence.runs import Cells, Run
from trials.studies.searches.design import METHOD

MARGIN = 0.02
CELLS_MARGIN = 1.0
RANDOM, CMA_ES = "random", "cma-es"
ARCHIVES = ("cma-me", "map-elites")


def claims(run: Run) -> list[Entry]:
    """An entry for each claim that the run's methods bear on, for each arm of the run."""
    return answers(run, (METHOD,), _questions)


def _questions(cells: Cells) -> list[Question]:
    methods = [method for (method,) in cells.planned()]
    archives = [method for method in ARCHIVES if method in methods]
    found = []
    if CMA_ES in methods:
        best, early = partial(_above, cells, "best", [CMA_ES]), partial(_above, cells, "mean_best", [CMA_ES])
        found += [
            _claim(1, "robustness of the best, CMA-ES less random", best),
            _claim(3, "mean of the best so far, CMA-ES less random", early),
            _claim(4, "share of robust points", partial(_above, cells, "robust_points", [CMA_ES])),
        ]
    if archives:
        found += [
            _claim(2, "robustness of the best, archive less random", partial(_above, cells, "best", archives)),
            _claim(5, "cells with a robust elite", partial(_above, cells, "robust_cells", archives, CELLS_MARGIN)),
        ]
    if not archives and CMA_ES in methods:
        judge = all_must_hold("uplift over the empty world above the margin", partial(_focused, cells))
        found.append(claim_of(__package__, "fine2015", "proposals", 1, "uplift of the best probabilities", judge))
    return found


def _claim(number: int, quantity: str, outcomes: Callable[[], Sequence[Outcome]]) -> Question:
    judge = all_must_hold("paired differences above the margin", outcomes)
    return claim_of(__package__, "ours", "searches", number, quantity, judge)


def _above(cells: Cells, measure: str, methods: Sequence[str], margin: float = MARGIN) -> list[Outcome]:
    return [
        more(f"{measure}, {method} less {RANDOM}", cells.difference(measure, (method,), (RANDOM,)), margin)
        for method in methods
    ]


def _focused(cells: Cells) -> list[Outcome]:
    return [more(f"uplift, {CMA_ES}", cells.array("uplift", CMA_ES), MARGIN)]
