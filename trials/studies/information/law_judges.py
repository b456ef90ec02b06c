"""Whether a law's herd still flocks in one condition: against itself in the best one, and against random motion.

The margins are choices: 0.15 of the largest group's share or of polarization; of MMD, a quarter of the spacing at the
herd's start. All tests are on differences of trials of one repeat, which share their start; every one must hold. Where
a share or a polarization lies near 0 or 1 in one of the two cells, the test is exact, of the median.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from flocking.types import Floats
from trials.evidence import statistics
from trials.evidence.claims import Judged
from trials.evidence.outcomes import Outcome, above, same
from trials.evidence.runs import Cells, UndecidedError
from trials.evidence.statistics import Decision
from trials.studies.information.law_survey import ORDER, SHARE, SPREAD

MARGINS = {SHARE: 0.15, ORDER: 0.15, SPREAD: 0.25}
IN_WORDS = (
    f"margins: {MARGINS[SHARE]:g} of the share, {MARGINS[ORDER]:g} of the polarization, {MARGINS[SPREAD]:g} spacings "
    "of the MMD; where a share or a polarization lies near 0 or 1, exact tests of the median"
)
WORDS = {SHARE: "largest group's share", ORDER: "polarization", SPREAD: "MMD in spacings, taken off"}
Cell = tuple[object, ...]


def gain(cells: Cells, measure: str, cell: Cell, other: Cell, spacing_m: float) -> Floats:
    """(n,) by how much a herd flocks more in one cell than in the other: a smaller MMD is more, and is in spacings."""
    difference = cells.difference(measure, cell, other)
    return -difference / spacing_m if measure == SPREAD else difference


def tested_exactly(cells: Cells, measure: str, *compared: Cell) -> bool:
    """Whether differences between cells are to be tested exactly: of what lies between 0 and 1, near one of them."""
    return measure != SPREAD and any(statistics.near_a_bound(cells.array(measure, *cell)) for cell in compared)


def alike(cells: Cells, measures: Sequence[str], cell: Cell, best: Cell, spacing_m: float) -> list[Outcome]:
    """That a herd flocks as much in one cell as in the best one, neither less nor more."""
    found = []
    for name in measures:
        exact = tested_exactly(cells, name, cell, best)
        found.append(same(WORDS[name], gain(cells, name, cell, best, spacing_m), MARGINS[name], exact=exact))
    return found


def no_worse(cells: Cells, measures: Sequence[str], cell: Cell, best: Cell, spacing_m: float) -> list[Outcome]:
    """That a herd does not flock less than in the best cell by as much as a margin."""
    found = []
    for name in measures:
        exact, margin = tested_exactly(cells, name, cell, best), MARGINS[name]
        found.append(above(WORDS[name], gain(cells, name, cell, best, spacing_m), -margin, margin, exact=exact))
    return found


def better(cells: Cells, measures: Sequence[str], cell: Cell, control: Cell, spacing_m: float) -> list[Outcome]:
    """That a herd flocks more than its control, by however little; the margin is only that in which it is shown."""
    found = []
    for name in measures:
        exact = tested_exactly(cells, name, cell, control)
        label = f"{WORDS[name]}, against random motion"
        found.append(above(label, gain(cells, name, cell, control, spacing_m), 0.0, MARGINS[name], exact=exact))
    return found


def verdict(outcomes: Sequence[Outcome]) -> bool | None:
    """Of all outcomes, each of which must hold."""
    return statistics.all_hold([outcome.decision for outcome in outcomes])


def both(*verdicts: bool | None) -> bool | None:
    """Of several claims at once."""
    return False if False in verdicts else None if None in verdicts else True


def held_in_all(conditions: Sequence[Sequence[Outcome]], label: str, n: int, test: str) -> Judged:
    """A claim that must hold in every one of several conditions, of `n` repeats each, with all outcomes of each.

    It does not hold where an outcome fails after Holm's correction for all of them. The report shows the share of the
    conditions in which it is shown to hold.
    """
    agrees, nan = verdict([outcome for outcomes in conditions for outcome in outcomes]), math.nan
    share = sum(verdict(outcomes) is True for outcomes in conditions) / len(conditions)
    decision = Decision(agrees, nan, nan, share, nan, nan, n, nan)
    return Judged(agrees, Outcome(label, decision, "share", nan, nan, True), (), test)


def mean_of(cells: Cells, measure: str, cell: Cell) -> float:
    """Mean over the repeats; nan where there is none."""
    try:
        values = cells.array(measure, *cell)
    except UndecidedError:
        return math.nan
    finite = values[np.isfinite(values)]
    return float(finite.mean()) if len(finite) else math.nan
