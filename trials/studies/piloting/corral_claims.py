"""Whether robots in the place of a corralling construct corral the herd as its walls do: figure 8.2 of Fine 2015."""

from __future__ import annotations

from functools import partial

from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of
from trials.evidence.outcomes import Outcome, more, same
from trials.evidence.runs import Cells, Run
from trials.simulations.robots import guided

KEYS = GUIDES, COUNT = ("piloting.guides", "pilots.count")
CONSTRUCT = "construct"
MEASURE = "elicited"
SAME = 0.2
"""Shares of trials that differ by less are the same. A choice: one trial of five, as in tables 7.3 and 7.4."""
SHOWN = 0.05


def claims(run: Run) -> list[Entry]:
    """Two entries for each number of robots."""
    return answers(run, KEYS, _questions)


def _questions(cells: Cells) -> list[Question]:
    planned, found = cells.planned(), []
    walls, nothing = (
        next((cell for cell in planned if cell[0] == guides), None) for guides in (guided.WALLS, guided.NOTHING)
    )
    for cell in planned:
        if cell[0] != guided.PILOTS:
            continue
        for number, other, test in ((1, nothing, _more), (2, walls, _same)):
            if other is None:
                continue
            judge = all_must_hold(
                f"paired difference of the shares above {SHOWN:g}" if number == 1 else f"within ±{SAME:g}",
                partial(test, cells, cell, other),
            )
            told = "the empty world" if number == 1 else "the walls"
            quantity = f"{cell[1]} robots beside {told}: share of the trials with the herd corralled"
            found.append(claim_of(__package__, "fine2015", "corral_claims", number, quantity, judge))
    return found


def _more(cells: Cells, robots: tuple[object, ...], nothing: tuple[object, ...]) -> list[Outcome]:
    return [more("robots less empty world", cells.difference(MEASURE, robots, nothing), SHOWN)]


def _same(cells: Cells, robots: tuple[object, ...], walls: tuple[object, ...]) -> list[Outcome]:
    return [same("robots less walls", cells.difference(MEASURE, robots, walls), SAME)]
