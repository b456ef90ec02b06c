"""Precision, recall and calibration of the link tension index from the counts of many trials, with intervals.

A share of links is a ratio of two sums over the trials. Its interval is Student's t over the trials' residuals (the
linearised ratio of Cochran 1977, chapter 6), for links of one flock are not independent of one another.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy import stats

from flocking.measures.links import Outcomes
from flocking.types import Floats
from trials.evidence.looks import nominal, overall
from trials.evidence.runs import FinishedTrial, Run
from trials.evidence.statistics import ALPHA, FEWEST, Decision, hedges_g
from trials.simulations.kinematic.links import BINS, EDGES, Counts, counts


class Ratio(NamedTuple):
    """A share with its 95 % interval, cut to [0, 1]; nan where there was nothing to share."""

    measured: float
    low: float
    high: float
    n: int
    """Trials that had something to share."""


class Finished:
    """The measures of a run's finished trials, by conditions; read once."""

    def __init__(self, run: Run) -> None:
        self._rows: list[FinishedTrial] = [row for row in run.rows() if row.status == "done"]

    def measures(self, conditions: Mapping[str, Any]) -> list[Mapping[str, float]]:
        """Those of the trials with these among their conditions."""
        return [row.measures for row in self._rows if conditions.items() <= row.conditions.items()]

    def counts(
        self, conditions: Mapping[str, Any], start: int, horizon: float, kind: str = "apart", reading: str = "printed"
    ) -> list[Counts]:
        """Of each of these trials that lasted so long."""
        found = (counts(measures, start, horizon, kind, reading) for measures in self.measures(conditions))
        return [one for one in found if one is not None]


def ratio(part: Sequence[float] | Floats, whole: Sequence[float] | Floats) -> Ratio:
    """The sum of `part` (n,) over that of `whole` (n,)."""
    parts, wholes = np.asarray(part, dtype=np.float64), np.asarray(whole, dtype=np.float64)
    shared = wholes > 0.0
    parts, wholes = parts[shared], wholes[shared]
    n = len(wholes)
    if n == 0:
        return Ratio(math.nan, math.nan, math.nan, 0)
    share = float(parts.sum() / wholes.sum())
    if n < FEWEST:
        return Ratio(share, math.nan, math.nan, n)
    residuals = parts - share * wholes
    error = math.sqrt(float(residuals @ residuals) / (n - 1) / n) / float(wholes.mean())
    reach = float(stats.t.ppf(1.0 - ALPHA / 2.0, n - 1)) * error
    return Ratio(share, max(0.0, share - reach), min(1.0, share + reach), n)


def precision(found: Iterable[Counts]) -> Ratio:
    """Of the links that were foretold to break, those that broke."""
    made = [one.outcomes() for one in found]
    return ratio([one.broken_broken for one in made], [foretold(one) for one in made])


def recall(found: Iterable[Counts]) -> Ratio:
    """Of the links that broke, those of which it was foretold."""
    made = [one.outcomes() for one in found]
    return ratio([one.broken_broken for one in made], [one.broken_broken + one.broken_predicted_intact for one in made])


def base_rate(found: Iterable[Counts]) -> Ratio:
    """Of all links, those that broke: the precision of an index that foretells at random."""
    made = [one.outcomes() for one in found]
    return ratio([one.broken_broken + one.broken_predicted_intact for one in made], [sum(one) for one in made])


def reliability(found: Sequence[Counts]) -> list[Ratio]:
    """For each bin of the index, which of its links broke: (BINS,)."""
    return [ratio([one.broken[b] for one in found], [one.links[b] for one in found]) for b in range(BINS)]


def foretold(made: Outcomes) -> int:
    """Links that were foretold to break."""
    return made.broken_broken + made.intact_predicted_broken


def bin_names() -> list[str]:
    """What each bin of the index holds, in rest lengths."""
    inner = [f"{low:g} to {high:g}" for low, high in itertools.pairwise(EDGES)]
    return [f"to {EDGES[0]:g}", *inner, f"above {EDGES[-1]:g}"]


FEWEST_FORETELLING = 20
"""Seeds from which one more can be foretold."""


def one_more(values: Floats, number: float, widest: float = math.inf) -> Decision:
    """The claim that `number`, told of a single trial, could be one more of `values` (n,).

    It does not hold if the number lies outside of the interval given, Student's 95 % prediction interval. Inside, it
    holds if the interval reaches no farther than `widest` to either side: a wider one would hold almost anything, and
    nothing is decided.
    """
    values = np.asarray(values, dtype=np.float64)
    values = values[np.isfinite(values)]
    n = len(values)
    if n < FEWEST_FORETELLING:
        mean = float(values.mean()) if n else math.nan
        return Decision(None, 1.0, 1.0, mean, math.nan, math.nan, n, math.nan)
    mean, spread = float(values.mean()), float(values.std(ddof=1)) * math.sqrt(1.0 + 1.0 / n)
    reach = float(stats.t.isf(nominal(ALPHA / 2.0), n - 1)) * spread
    beyond = overall(stats.t.sf(abs(number - mean) / spread, n - 1)) if spread > 0.0 else 0.5 * (number == mean)
    p = min(1.0, 2.0 * float(beyond))
    agrees = False if p < ALPHA else True if reach <= widest else None
    return Decision(agrees, 1.0 - p, p, mean, mean - reach, mean + reach, n, hedges_g(values, number))
