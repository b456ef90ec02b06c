"""Akama and Naruse 2014 held against a run of its two simulations: tables 1 and 2, and the three claims.

A published count is of one trial with one seed. It counts as reproduced where it lies within Student's 95 % prediction
interval of one more of our seeds; of a table, all four. A claim is tested on each trial's share of links. Thresholds
and margins are choices: `most` links are more than half of them, an index that is right is so of 95 % of them, and two
settings are almost the same where shares differ by at most 0.1 (two one-sided tests, paired by seed).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np

from flocking.measures.links import Outcomes
from flocking.types import Floats
from trials.evidence.claims import (
    Cells,
    Entry,
    Outcome,
    Question,
    Run,
    UndecidedError,
    above,
    answered,
    arms,
    published,
    same,
)
from trials.simulations.kinematic.lattice_starts import BOTH, POSITION, VELOCITY
from trials.simulations.kinematic.links import counts, share
from trials.studies.link_tension.estimates import foretold, one_more
from trials.types import Trial

KEYS = ("formation", "herd.law.range_m", "formation.strength")
ALPHA, STRENGTH = 1.6, 3.0
"""The setting of tables 1 and 2."""
TABLES = {"table_1": VELOCITY, "table_2": POSITION}
PERIODS = {"t0_to_t1": 0, "t1_to_t2": 1}
RIGHT, MOST, ALMOST = 0.95, 0.5, 0.1
WIDEST = 26.0
"""Links, a tenth of the publication's 262: an interval that reaches farther would agree with almost any number."""
SOURCE = "akama2014"
READING = {VELOCITY: "", POSITION: "", BOTH: ", read with velocities below 3 as well"}


class Linked(Cells):
    """Cells that also give what is counted of links."""

    def outcomes(self, start: int, *cell: Any) -> dict[int, Outcomes | None]:
        """The contingency one unit of time after a moment, by repeat."""
        self.values("links", *cell)  # raises where trials of the cell have not run
        found = {}
        for repeat, row in self.rows_of(*cell).items():
            counted = counts(row, start, 1.0) if row is not None else None
            found[repeat] = counted.outcomes() if counted is not None else None
        return found

    def rows_of(self, *cell: Any) -> dict[int, Mapping[str, float] | None]:
        """The measures of a cell's trials by repeat; None of one that failed."""
        rows = self._planned[cell]
        return {
            repeat: row.measures if row is not None and row.status == "done" else None for repeat, row in rows.items()
        }


def claims(run: Run) -> list[Entry]:
    """An entry for each table, for the numbers told in the text and for each claim, for each arm of the run."""
    entries, rows = [], run.rows()
    for arm, trials in arms(run, KEYS):
        cells = Linked(trials, rows, KEYS)
        entries += [answered(question, cells, arm) for question in _questions(cells, trials)]
    return entries


def held_share(made: Outcomes | None) -> float:
    """Of the links that were foretold to hold, those that did."""
    return np.nan if made is None else share(made.intact_intact, made.intact_intact + made.broken_predicted_intact)


def stayed_share(made: Outcomes | None) -> float:
    """Of the links that were foretold to break, those that held."""
    return np.nan if made is None else share(made.intact_predicted_broken, foretold(made))


def _questions(cells: Linked, trials: list[Trial]) -> list[Question]:
    told, simulations = published(__package__, SOURCE, "claims"), published(__package__, SOURCE, "simulations")
    found = []
    for table, formation in TABLES.items():
        number = table[-1]
        readings = (formation,) if formation == VELOCITY else (POSITION, BOTH)
        for part, (period, counted) in zip("ab", published(__package__, SOURCE, table).items(), strict=True):
            for reading in readings:
                found.append(
                    Question(
                        source=f"{SOURCE} table {number} ({part}){READING[reading]}",
                        quantity=f"table {number} ({part}), {reading}",
                        words=", ".join(f"{name.replace('_', ' ')} {value}" for name, value in counted.items()),
                        test=f"each count in the 95 % prediction interval of one more seed, ±{WIDEST:g} links at most",
                        outcomes=partial(_table, cells, reading, PERIODS[period], counted),
                    )
                )
        first = published(__package__, SOURCE, table)["t0_to_t1"]
        for reading in readings:
            found.append(
                Question(
                    source=f"{SOURCE} table {number} (a){READING[reading]}",
                    quantity=f"links at t = 0, {reading}",
                    words=f"{sum(first.values())} links in all",
                    test=f"within the 95 % prediction interval of one more seed, if at most ±{WIDEST:g} links wide",
                    outcomes=partial(_number, cells, reading, "links", sum, sum(first.values())),
                )
            )
            value = simulations["predicted_broken"][table]
            found.append(
                Question(
                    source=f"{SOURCE} section 4.{int(number) + 1}{READING[reading]}",
                    quantity=f"foretold at t = 0, {reading}",
                    words=f"{value} links predicted to break",
                    test=f"within the 95 % prediction interval of one more seed, if at most ±{WIDEST:g} links wide",
                    outcomes=partial(_number, cells, reading, "links foretold to break", foretold, value),
                )
            )
    judges: tuple[Callable[[Linked], list[Outcome]], ...] = (_negative_holds, _positive_stays, _others_alike)
    tests = (
        f"share of links foretold to hold that do, above {RIGHT:g} in both simulations and both periods",
        f"share of links foretold to break that hold, above {MOST:g} in both simulations and both periods",
        f"both shares within ±{ALMOST:g} of those at alpha 1.6 and 3, paired by seed (two one-sided tests); all must",
    )
    for k, (judge, test) in enumerate(zip(judges, tests, strict=True)):
        found.append(
            Question(
                source=f"{SOURCE} claims, claim {k + 1} (section {told['sections'][k]})",
                quantity=f"claim {k + 1}",
                words=told["claims"][k],
                test=test,
                outcomes=partial(judge, cells),
            )
        )
    return found


def _table(cells: Linked, formation: str, start: int, counted: Mapping[str, int]) -> list[Outcome]:
    made = [one for one in cells.outcomes(start, formation, ALPHA, STRENGTH).values() if one is not None]
    return [
        _single(f"{name.replace('_', ' ')}, links", np.array([getattr(one, name) for one in made], dtype=float), value)
        for name, value in counted.items()
    ]


def _number(
    cells: Linked, formation: str, label: str, number: Callable[[Outcomes], int], value: float
) -> list[Outcome]:
    made = [one for one in cells.outcomes(0, formation, ALPHA, STRENGTH).values() if one is not None]
    return [_single(label, np.array([number(one) for one in made], dtype=float), value)]


def _single(label: str, values: Floats, value: float) -> Outcome:
    """The outcome that a published number could be one more of ours."""
    decision = one_more(values, value, WIDEST)
    reach = max(0.5, 0.5 * (decision.high - decision.low)) if np.isfinite(decision.high) else np.nan
    shown = decision._replace(low=max(0.0, decision.low))  # a count
    return Outcome(label, shown, "equivalent", float(value), float(reach), True)


def _shares(
    cells: Linked, of: Callable[[Outcomes | None], float], start: int, cell: tuple[Any, ...]
) -> dict[int, float]:
    return {repeat: of(made) for repeat, made in cells.outcomes(start, *cell).items()}


def _negative_holds(cells: Linked) -> list[Outcome]:
    return _above(cells, held_share, "held of those foretold to hold", RIGHT, 0.05)


def _positive_stays(cells: Linked) -> list[Outcome]:
    return _above(cells, stayed_share, "held of those foretold to break", MOST, 0.5)


def _above(
    cells: Linked, of: Callable[[Outcomes | None], float], told: str, threshold: float, scale: float
) -> list[Outcome]:
    """Of both simulations and periods, which decide, and of the third start, which does not."""
    found = []
    for formation in (VELOCITY, POSITION, BOTH):
        for start in PERIODS.values():
            values = np.array(list(_shares(cells, of, start, (formation, ALPHA, STRENGTH)).values()))
            label = f"share {told}, {formation}, t = {start} to {start + 1}"
            if np.isfinite(values).any():
                found.append(above(label, values, threshold, scale, decides=formation != BOTH, bounds=(0.0, 1.0)))
    if not any(outcome.decides for outcome in found):
        raise UndecidedError("the run has no links that were so foretold")
    return found


def _others_alike(cells: Linked) -> list[Outcome]:
    found = []
    for formation in (VELOCITY, POSITION, BOTH):
        for start in PERIODS.values():
            for name, of in (("foretold to hold", held_share), ("foretold to break", stayed_share)):
                usual = _shares(cells, of, start, (formation, ALPHA, STRENGTH))
                for alpha in cells.levels("herd.law.range_m"):
                    for strength in cells.levels("formation.strength"):
                        if (alpha, strength) == (ALPHA, STRENGTH):
                            continue
                        other = _shares(cells, of, start, (formation, alpha, strength))
                        differences = np.array([other[r] - usual[r] for r in sorted(other.keys() & usual.keys())])
                        if np.isfinite(differences).sum() < 2:
                            continue
                        told = f"{formation}, alpha {alpha:g}, strength {strength:g}, t = {start} to {start + 1}"
                        label = f"share held of those {name}, {told}"
                        found.append(same(label, differences, ALMOST, decides=formation != BOTH))
    if not any(outcome.decides for outcome in found):
        raise UndecidedError("the run has no other setting with links that were so foretold")
    return found
