"""The tightness of each schema with its interval, and what its constructs add to their workspaces.

Fine 2015 defines tightness (section 7.4) and gives it for no schema. All environments of a schema are generated and
tried independently of one another, so that those of all repeats are counted together: a rate has Wilson's interval, an
uplift Newcombe's for paired proportions. The p-values shown are one minus the confidence at which an interval reaches
what it is held against.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy import optimize

from generation.validation.uplift import Rate, Uplift, paired, rate
from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of
from trials.evidence.outcomes import Outcome
from trials.evidence.runs import Cells, FinishedTrial, Run, UndecidedError
from trials.evidence.statistics import ALPHA, Decision, overall

KEYS = ("world",)
LEAST = 0.01
"""One construct in a hundred: the least share, and the least uplift, that counts. A choice."""


class Counts(NamedTuple):
    """The environments of a schema, those of all repeats together."""

    generated: int
    both: int
    """Of those that passed: with the construct and without it."""
    gained: int
    """With it alone."""
    lost: int
    """Without it alone."""
    neither: int

    @property
    def passed(self) -> int:
        """Those that passed the filter."""
        return self.both + self.gained + self.lost + self.neither

    def tightness(self, confidence: float = 1.0 - ALPHA) -> Rate:
        """Share of all that were generated."""
        return rate(np.arange(self.generated) < self.both + self.gained, confidence)

    def valid(self) -> Rate:
        """Share of those that passed."""
        return rate(np.arange(self.passed) < self.both + self.gained)

    def control(self) -> Rate:
        """Likewise, of the workspaces alone."""
        return rate(np.arange(self.passed) < self.both + self.lost)

    def uplift(self, confidence: float = 1.0 - ALPHA) -> Uplift:
        """The difference of both, in pairs."""
        counts = (self.both, self.gained, self.lost, self.neither)
        return paired(np.repeat([True, True, False, False], counts), np.repeat([True, False, True, False], counts),
                      confidence)  # fmt: skip


def counted(rows: list[FinishedTrial]) -> Counts:
    """The environments of finished trials together."""
    found = np.zeros(5, np.int64)
    for row in rows:
        measures = row.measures
        passed, valid = measures["passed"], measures["valid"]
        gained, lost = (measures[name] * passed if passed else 0.0 for name in ("gained", "lost"))
        both = valid - gained
        found += np.rint([measures["generated"], both, gained, lost, passed - both - gained - lost]).astype(np.int64)
    return Counts(*found.tolist())


def claims(run: Run) -> list[Entry]:
    """Two entries a schema for each arm of the run."""
    return answers(run, KEYS, _questions)


def _questions(cells: Cells) -> list[Question]:
    found = []
    for (schema,) in cells.planned():
        for number, quantity, test, outcome in (
            (1, f"tightness of {schema}", f"Wilson's interval of all constructs against {LEAST:g}", _tightness),
            (2, f"uplift of {schema} over its workspace",
             f"Newcombe's interval of those that passed against {LEAST:g}", _uplift),
        ):  # fmt: skip
            judge = all_must_hold(test, partial(_judged, cells, schema, outcome))
            found.append(claim_of(__package__, "ours", "tightness_claims", number, quantity, judge))
    return found


def _judged(cells: Cells, schema: str, outcome: Callable[[Counts], Outcome]) -> list[Outcome]:
    rows = [row for row in cells.rows(schema).values() if row is not None]
    counts = counted(rows)
    if counts.passed == 0:
        raise UndecidedError("no environment passed its filter")
    return [outcome(counts)]


def _tightness(counts: Counts) -> Outcome:
    return _outcome("share that elicits its behaviour", counts.tightness)


def _uplift(counts: Counts) -> Outcome:
    label = f"share {counts.valid().rate:.3f} of those that passed, {counts.control().rate:.3f} in the empty world"
    return _outcome(label, counts.uplift)


def _outcome(label: str, interval: Callable[[float], Rate | Uplift]) -> Outcome:
    """The outcome that what an interval is of exceeds `LEAST`; `interval`: at a confidence."""
    found = interval(1.0 - ALPHA)
    measured = found[0]
    p_holds = _of_all_looks(_reaching(lambda confidence: interval(confidence).low - LEAST))
    p_fails = _of_all_looks(_reaching(lambda confidence: LEAST - interval(confidence).high))
    agrees = True if p_holds < ALPHA else False if p_fails < ALPHA else None
    decision = Decision(agrees, p_holds, p_fails, measured, found.low, found.high, found.n, float("nan"))
    return Outcome(label, decision, "exceeds", 0.0, LEAST, True)


def _of_all_looks(p: float) -> float:
    """A two-sided p-value of one look as that of all planned looks, which are known of one-sided ones."""
    return min(1.0, 2.0 * float(overall(p / 2.0)))


def _reaching(clear: Callable[[float], float]) -> float:
    """One minus the confidence at which the end of an interval comes to `LEAST`; `clear`: how far it is beyond it.

    1 where the measured number is not beyond it, also by rounding alone.
    """

    def gap(tail: float) -> float:
        return clear(1.0 - np.exp(tail))

    least, most = np.log(1e-12), np.log(1.0 - 1e-9)
    if gap(most) <= 0.0:
        return 1.0
    return float(np.exp(optimize.brentq(gap, least, most))) if gap(least) < 0.0 else 0.0
