"""Akama and Naruse 2014 held against a run of its two simulations: tables 1 and 2, and the three claims.

A published count is of one trial with one seed. It counts as reproduced where it lies within Student's 95 % prediction
interval of one more of our seeds; of a table, all four. A claim is tested on each trial's share of links. Thresholds
and margins are choices: `most` links are more than half of them, an index that is right is so of 95 % of them, and two
settings are almost the same where shares differ by at most 0.1 (two one-sided tests, paired by seed).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from itertools import product
from typing import Any

import numpy as np

from flocking.measures.links import Outcomes
from flocking.types import Floats
from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of, published
from trials.evidence.outcomes import Outcome, above, same
from trials.evidence.runs import Cells, Run, UndecidedError
from trials.evidence.statistics import near_a_bound
from trials.simulations.kinematic.lattice_starts import BOTH, POSITION, VELOCITY
from trials.simulations.kinematic.links import counts, share
from trials.studies.link_tension.estimates import foretold, one_more

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


def claims(run: Run) -> list[Entry]:
    """An entry for each table, for the numbers told in the text and for each claim, for each arm of the run."""
    return answers(run, KEYS, _questions)


def contingency(cells: Cells, start: int, *cell: Any) -> dict[int, Outcomes | None]:
    """What became of a cell's links one unit of time after a moment, by repeat; None where it was not counted."""
    found = {}
    for repeat, row in cells.rows(*cell).items():
        counted = counts(row.measures, start, 1.0) if row is not None else None
        found[repeat] = counted.outcomes() if counted is not None else None
    return found


def held_share(made: Outcomes | None) -> float:
    """Of the links that were foretold to hold, those that did."""
    return np.nan if made is None else share(made.intact_intact, made.intact_intact + made.broken_predicted_intact)


def stayed_share(made: Outcomes | None) -> float:
    """Of the links that were foretold to break, those that held."""
    return np.nan if made is None else share(made.intact_predicted_broken, foretold(made))


def _questions(cells: Cells) -> list[Question]:
    everywhere = "in both simulations and both periods"
    alike = f"within ±{ALMOST:g} of those at alpha 1.6 and 3, paired by seed (two one-sided tests)"
    judges: tuple[tuple[str, Callable[[Cells], list[Outcome]]], ...] = (
        (f"share of links foretold to hold that do, above {RIGHT:g} {everywhere}", _negative_holds),
        (f"share of links foretold to break that hold, above {MOST:g} {everywhere}", _positive_stays),
        (f"both shares {alike}; all must", _others_alike),
    )
    return [
        *(question for table in TABLES for question in _of_table(cells, table)),
        *(
            claim_of(__package__, SOURCE, "claims", k, f"claim {k}", all_must_hold(test, partial(outcomes, cells)))
            for k, (test, outcomes) in enumerate(judges, start=1)
        ),
    ]


def _of_table(cells: Cells, table: str) -> list[Question]:
    """The questions on one table in each of its readings: its counts, and the sums that the text tells."""
    number, formation = int(table[-1]), TABLES[table]
    readings = (formation,) if formation == VELOCITY else (POSITION, BOTH)
    periods = published(__package__, SOURCE, table)
    links = sum(periods["t0_to_t1"].values())
    broken = published(__package__, SOURCE, "simulations")["predicted_broken"][table]
    test = f"each count in the 95 % prediction interval of one more seed, ±{WIDEST:g} links at most"
    found = [
        Question(
            source=f"{SOURCE} table {number} ({part}){READING[reading]}",
            quantity=f"table {number} ({part}), {reading}",
            claim=", ".join(f"{_words(name)} {value}" for name, value in counted.items()),
            judge=all_must_hold(test, partial(_counts, cells, reading, PERIODS[period], counted)),
        )
        for part, (period, counted) in zip("ab", periods.items(), strict=True)
        for reading in readings
    ]
    test = f"within the 95 % prediction interval of one more seed, if at most ±{WIDEST:g} links wide"
    for reading in readings:
        found += [
            Question(
                source=f"{SOURCE} table {number} (a){READING[reading]}",
                quantity=f"links at t = 0, {reading}",
                claim=f"{links} links in all",
                judge=all_must_hold(test, partial(_number, cells, reading, "links", sum, links)),
                published=links,
            ),
            Question(
                source=f"{SOURCE} section 4.{number + 1}{READING[reading]}",
                quantity=f"foretold at t = 0, {reading}",
                claim=f"{broken} links predicted to break",
                judge=all_must_hold(
                    test, partial(_number, cells, reading, "links foretold to break", foretold, broken)
                ),
                published=broken,
            ),
        ]
    return found


def _words(name: str) -> str:
    """The name of a count."""
    return name.replace("_", " ")


def _counts(cells: Cells, formation: str, start: int, counted: Mapping[str, int]) -> list[Outcome]:
    made = [one for one in contingency(cells, start, formation, ALPHA, STRENGTH).values() if one is not None]
    return [
        _single(f"{_words(name)}, links", np.array([getattr(one, name) for one in made], dtype=float), value)
        for name, value in counted.items()
    ]


def _number(cells: Cells, formation: str, label: str, number: Callable[[Outcomes], int], value: float) -> list[Outcome]:
    made = [one for one in contingency(cells, 0, formation, ALPHA, STRENGTH).values() if one is not None]
    return [_single(label, np.array([number(one) for one in made], dtype=float), value)]


def _single(label: str, values: Floats, value: float) -> Outcome:
    """The outcome that a published number could be one more of ours."""
    decision = one_more(values, value, WIDEST)
    reach = max(0.5, 0.5 * (decision.high - decision.low)) if np.isfinite(decision.high) else np.nan
    shown = decision._replace(low=max(0.0, decision.low))  # a count
    return Outcome(label, shown, "equivalent", float(value), float(reach), True, published=float(value))


def _shares(
    cells: Cells, of: Callable[[Outcomes | None], float], start: int, cell: tuple[Any, ...]
) -> dict[int, float]:
    return {repeat: of(made) for repeat, made in contingency(cells, start, *cell).items()}


def _negative_holds(cells: Cells) -> list[Outcome]:
    return _above(cells, held_share, "held of those foretold to hold", RIGHT, 0.05)


def _positive_stays(cells: Cells) -> list[Outcome]:
    return _above(cells, stayed_share, "held of those foretold to break", MOST, 0.5)


def _above(
    cells: Cells, of: Callable[[Outcomes | None], float], told: str, threshold: float, scale: float
) -> list[Outcome]:
    """Of both simulations and periods, which decide, and of the third start, which does not."""
    found = []
    for formation, start in product((VELOCITY, POSITION, BOTH), PERIODS.values()):
        values = np.array(list(_shares(cells, of, start, (formation, ALPHA, STRENGTH)).values()))
        label = f"share {told}, {formation}, t = {start} to {start + 1}"
        if np.isfinite(values).any():
            found.append(above(label, values, threshold, scale, decides=formation != BOTH, bounds=(0.0, 1.0)))
    if not any(outcome.decides for outcome in found):
        raise UndecidedError("the run has no links that were so foretold")
    return found


def _others_alike(cells: Cells) -> list[Outcome]:
    found = []
    kinds = (("foretold to hold", held_share), ("foretold to break", stayed_share))
    for formation, start, (name, of) in product((VELOCITY, POSITION, BOTH), PERIODS.values(), kinds):
        usual = _shares(cells, of, start, (formation, ALPHA, STRENGTH))
        for alpha, strength in product(cells.levels("herd.law.range_m"), cells.levels("formation.strength")):
            if (alpha, strength) == (ALPHA, STRENGTH):
                continue
            other = _shares(cells, of, start, (formation, alpha, strength))
            differences = np.array([other[r] - usual[r] for r in sorted(other.keys() & usual.keys())])
            if np.isfinite(differences).sum() < 2:
                continue
            label = (
                f"share held of those {name}, {formation}, alpha {alpha:g}, strength {strength:g}, "
                f"t = {start} to {start + 1}"
            )
            exact = any(near_a_bound(np.array(list(shares.values()))) for shares in (usual, other))
            found.append(same(label, differences, ALMOST, decides=formation != BOTH, exact=exact))
    if not any(outcome.decides for outcome in found):
        raise UndecidedError("the run has no other setting with links that were so foretold")
    return found
