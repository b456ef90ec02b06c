"""Corralling of one Create and of four held against figures 1.2 and 5.1 of Fine 2015, each beside the empty world.

A trial shows the behaviour or does not; of both sizes and both worlds the repeat's environment, start and random
numbers are the same, so that trials come in pairs. A difference of shares counts from `MARGIN` on, a choice.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of
from trials.evidence.outcomes import Outcome, more
from trials.evidence.runs import Cells, Run

COUNT, CONSTRUCT, ITERATION = KEYS = ("herd.count", "world.construct", "behaviour.iteration_s")
ALONE, GROUP = COUNTS = (1, 4)
UNITS = {0.4: 2, 0.2: 1}
"""What an iteration lasts, s, and the way of a robot in it, in units of the environment."""
MEASURE = "elicited"
MARGIN = 0.05


def claims(run: Run) -> list[Entry]:
    """Two entries for each speed that the run has, for each of its arms."""
    return answers(run, KEYS, _questions)


def told(iteration_s: float) -> str:
    """A speed in words."""
    units = UNITS.get(iteration_s, 5.0 * iteration_s)
    return f"{units:g} unit{'s' * (units != 1)} an iteration"


def _questions(cells: Cells) -> list[Question]:
    found = []
    for iteration_s in dict.fromkeys(cell[2] for cell in cells.planned()):
        differ = all_must_hold(
            f"share of the environments in which one of both alone is corralled above {MARGIN:g}",
            partial(_differ, cells, iteration_s),
        )
        larger = all_must_hold(
            f"paired differences above {MARGIN:g}: of the share corralled, and of the uplift over the empty world",
            partial(_larger, cells, iteration_s),
        )
        found += [
            claim_of(__package__, "fine2015", "robots_size_claims", number, f"{quantity}, {told(iteration_s)}", judge)
            for number, quantity, judge in ((1, "one Create and four", differ), (2, "four Creates less one", larger))
        ]
    return found


def _differ(cells: Cells, iteration_s: float) -> list[Outcome]:
    both = cells.difference(MEASURE, (GROUP, True, iteration_s), (ALONE, True, iteration_s))
    differ = more("share of the environments in which they differ", np.abs(both), MARGIN)
    return [differ, *_uplifts(cells, iteration_s)]


def _larger(cells: Cells, iteration_s: float) -> list[Outcome]:
    of = {
        (count, world): cells.values(MEASURE, count, world, iteration_s) for count in COUNTS for world in (True, False)
    }
    repeats = sorted(set.intersection(*map(set, of.values())))
    table = {cell: np.array([found[repeat] for repeat in repeats]) for cell, found in of.items()}
    by_size = table[GROUP, True] - table[ALONE, True]
    return [
        more("share that is corralled, with the construct", by_size, MARGIN),
        more("uplift over the empty world", by_size - (table[GROUP, False] - table[ALONE, False]), MARGIN),
        *_uplifts(cells, iteration_s),
    ]


def _uplifts(cells: Cells, iteration_s: float) -> list[Outcome]:
    """What the construct does to each size, beside the claim."""
    pairs = {count: ((count, True, iteration_s), (count, False, iteration_s)) for count in COUNTS}
    return [
        more(f"uplift of {count}", cells.difference(MEASURE, *pair), MARGIN, decides=False)
        for count, pair in pairs.items()
    ]
