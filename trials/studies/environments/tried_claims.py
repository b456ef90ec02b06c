"""Tables 7.3 and 7.4 of Fine 2015 held against runs of single environments, and the transfer from members to Creates.

The published rates are of five trials each; a rate counts as reproduced where ours lies within one trial of five of it.
Transfer is ours: of the environments in which kinematic members showed the behaviour, the share in which Creates do,
and do more often than in the empty world: what a herd does anyway is no transfer.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path

import numpy as np

from flocking.errors import InputError
from trials.batch.folders import newest
from trials.batch.store import opened
from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of, published
from trials.evidence.outcomes import Outcome, above, more, near
from trials.evidence.runs import Cells, Run, UndecidedError
from trials.studies.environments.claims import BEHAVIOURS, NAMES
from trials.studies.environments.design import LAWS
from trials.studies.environments.tried import BEHAVIOURS as TRIED
from trials.studies.environments.tried import KEYS, TABLE_KEYS

ONE_OF_FIVE = 0.2
"""One trial of the publication's five; a choice."""
MEASURE = "elicited"
MEMBERS = "maebe-transfer-members"
HALF, SHOWN_MARGIN = 0.5, 0.1


def of_table(table: str, section: str) -> Callable[[Run], list[Entry]]:
    """The claims of an experiment on one of the two tables: an entry a rate."""

    def claims(run: Run) -> list[Entry]:
        return answers(run, TABLE_KEYS, partial(_rates, table, section))

    return claims


def _rates(table: str, section: str, cells: Cells) -> list[Question]:
    return [
        Question(
            source=f"fine2015 {table} ({section})",
            quantity=f"{BEHAVIOURS[behaviour]}, {NAMES[law]}",
            claim=f"share of five trials in which {NAMES[law]} shows {BEHAVIOURS[behaviour]}: {rate:g}",
            judge=all_must_hold(
                f"mean of the trials within ±{ONE_OF_FIVE:g} of it (two one-sided tests)",
                partial(_rate, cells, behaviour, law, rate),
            ),
            published=rate,
        )
        for behaviour in TRIED
        for law, rate in published(__package__, "fine2015", table)[behaviour].items()
    ]


def _rate(cells: Cells, behaviour: str, law: str, rate: float) -> list[Outcome]:
    """The rate, and beside it what the construct adds to that of the empty world."""
    found = [near("share of the trials that show it", cells.array(MEASURE, behaviour, law, True), rate, ONE_OF_FIVE)]
    with suppress(UndecidedError):
        uplift = cells.difference(MEASURE, (behaviour, law, True), (behaviour, law, False))
        found.append(more("uplift over the empty world", uplift, SHOWN_MARGIN, decides=False))
    return found


def transfer(run: Run) -> list[Entry]:
    """The claims of `maebe-transfer`: an entry a behaviour and law, read beside the newest run with members."""
    return answers(run, TABLE_KEYS, lambda cells: _transfers(run, cells))


def _transfers(run: Run, cells: Cells) -> list[Question]:
    return [
        claim_of(
            __package__,
            "ours",
            "transfer_claims",
            1,
            f"transfer, {BEHAVIOURS[behaviour]}, {NAMES[law]}",
            all_must_hold(
                "share of them in which Creates show it above one half (exact), and above that in the empty world by "
                f"{SHOWN_MARGIN:g}",
                partial(_transferred, run, cells, behaviour, law),
            ),
        )
        for behaviour in TRIED
        for law in LAWS
    ]


def _transferred(run: Run, cells: Cells, behaviour: str, law: str) -> list[Outcome]:
    valid = _valid(run, behaviour, law)
    found, empty = (cells.values(MEASURE, behaviour, law, construct) for construct in (True, False))
    values = np.array([found[repeat] for repeat in sorted(found.keys() & valid)])
    if len(values) == 0:
        raise UndecidedError("kinematic members showed it in none of the environments")
    pairs = np.array([found[repeat] - empty[repeat] for repeat in sorted(found.keys() & empty.keys() & valid)])
    return [
        above("share of the valid ones", values, HALF, SHOWN_MARGIN, bounds=(0.0, 1.0), exact=True),
        more("uplift over the empty world", pairs, SHOWN_MARGIN),
    ]


def _valid(run: Run, behaviour: str, law: str) -> set[int]:
    """The repeats whose environment was valid for members, in the newest run of those on the same environments."""
    wanted = {trial.repeat: trial.world_source for trial in run.trials if trial.conditions.get(KEYS[0]) == behaviour}
    for base in (run.folder.resolve().parent.parent, Path("runs")):
        try:
            other = opened(newest(MEMBERS, base))
        except InputError:
            continue
        try:
            rows = {row.index: row for row in other.rows()}
            trials = [trial for trial in other.trials if tuple(map(trial.conditions.get, KEYS)) == (behaviour, law)]
        finally:
            other.close()
        same = [trial for trial in trials if wanted.get(trial.repeat) == trial.world_source and trial.index in rows]
        if same:
            return {trial.repeat for trial in same if rows[trial.index].measures.get(MEASURE) == 1.0}
    raise UndecidedError(f"needs trials of {MEMBERS}", ("run", MEMBERS))
