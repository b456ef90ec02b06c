"""Outcomes: single tested quantities that bear on a claim, and the verdict of several of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from flocking.types import Floats
from trials.evidence import statistics
from trials.evidence.statistics import Decision


class Tested(NamedTuple):
    """The numbers behind an outcome, for the power of its test."""

    values: Floats
    """(n,)."""
    supposed: float
    """Where their middle would lie if the claim were true: at 0 for sameness, at twice the least excess that counts, or
    half a margin beyond a threshold."""
    bound: float
    """They are held above it; for sameness within ± it."""
    exact: bool = False
    """Tested by the median."""


class Outcome(NamedTuple):
    """One tested quantity that bears on a claim."""

    label: str
    """What was measured, in which conditions, with its unit."""
    decision: Decision
    kind: str
    """`exceeds`, `equivalent`, or `share`: no test of its own, but the share of several verdicts."""
    threshold: float
    margin: float
    decides: bool
    """False: shown beside the others, but without a say in the verdict."""
    ratio: bool = False
    """The numbers tested are logarithms of ratios; `shown` turns them back."""
    published: float = math.nan
    """The published number that it is held against, where the claim has several; else nan."""
    tested: Tested | None = None
    """None: no numbers of its own, or none that a power can be told of."""

    def shown(self) -> tuple[float, float, float, float]:
        """Measured, low, high and margin in the unit of the label."""
        numbers = (self.decision.measured, self.decision.low, self.decision.high, self.margin)
        return tuple(map(math.exp, numbers)) if self.ratio else numbers  # type: ignore[return-value]

    def in_margins(self) -> tuple[float, float, float]:
        """Measured, low and high, less the threshold, in units of the margin: what a forest plot puts on one axis."""
        decision, scale = self.decision, self.margin
        return (
            (decision.measured - self.threshold) / scale,
            (decision.low - self.threshold) / scale,
            (decision.high - self.threshold) / scale,
        )


def same(label: str, differences: Floats, margin: float, decides: bool = True, exact: bool = False) -> Outcome:
    """The outcome that paired differences lie within ±margin; `exact`: tested by their median."""
    decision = statistics.equivalent(differences, margin, exact)
    tested = Tested(differences, 0.0, margin, exact)
    return Outcome(_told(label, exact), decision, "equivalent", 0.0, margin, decides, tested=tested)


def near(label: str, values: Floats, target: float, margin: float, decides: bool = True) -> Outcome:
    """The outcome that values lie within ±margin of a published number; it shows the values themselves."""
    differences = np.asarray(values) - target
    decision = statistics.equivalent(differences, margin)
    shown = decision._replace(
        measured=decision.measured + target, low=decision.low + target, high=decision.high + target
    )
    return Outcome(label, shown, "equivalent", target, margin, decides, tested=Tested(differences, 0.0, margin))


def more(
    label: str, values: Floats, margin: float, threshold: float = 0.0, decides: bool = True, exact: bool = False
) -> Outcome:
    """The outcome that values exceed the threshold by more than the margin; `exact`: tested by their median."""
    decision = statistics.exceeds(values, threshold, margin, exact)
    tested = Tested(values, threshold + 2.0 * margin, threshold + margin, exact)
    return Outcome(_told(label, exact), decision, "exceeds", threshold, margin, decides, tested=tested)


def above(
    label: str,
    values: Floats,
    threshold: float,
    scale: float,
    decides: bool = True,
    bounds: tuple[float, float] = (-math.inf, math.inf),
    exact: bool = False,
) -> Outcome:
    """The outcome that values lie above a threshold: not below it. `scale` is the margin shown.

    `bounds`: between which values can lie at all; the interval shown ends there. Where the threshold or the values lie
    near one of them, the test is exact, as it is with `exact`.
    """
    exact = exact or statistics.near_a_bound(np.array([threshold]), bounds) or statistics.near_a_bound(values, bounds)
    decision = statistics.exceeds(values, threshold, exact=exact)
    shown = decision._replace(low=max(decision.low, bounds[0]), high=min(decision.high, bounds[1]))
    return Outcome(
        _told(f"{label}, to lie above {threshold:g}", exact),
        shown,
        "exceeds",
        threshold,
        scale,
        decides,
        tested=Tested(values, threshold + scale / 2.0, threshold, exact),
    )


def ratio(label: str, logs: Floats, factor: float, decides: bool = True) -> Outcome:
    """The outcome that ratios, given as logarithms, exceed `factor`, the least that counts."""
    decision, margin = statistics.exceeds(logs, 0.0, math.log(factor)), math.log(factor)
    tested = Tested(logs, 2.0 * margin, margin)
    return Outcome(label, decision, "exceeds", 0.0, margin, decides, ratio=True, tested=tested)


def _told(label: str, exact: bool) -> str:
    return f"{label} (median)" if exact else label


def decided_by_all(outcomes: Sequence[Outcome]) -> tuple[bool | None, Outcome]:
    """The verdict of the outcomes that decide, all of which must hold, and the one on which it hangs: the
    clearest failure, else the weakest success."""
    deciding = [outcome for outcome in outcomes if outcome.decides]
    agrees = statistics.all_hold([outcome.decision for outcome in deciding])
    return agrees, weakest(deciding, agrees)


def weakest(outcomes: Sequence[Outcome], agrees: bool | None) -> Outcome:
    """The outcome on which a verdict of all hangs."""
    if agrees is False:
        return min(outcomes, key=lambda outcome: outcome.decision.p_fails)
    return max(outcomes, key=lambda outcome: outcome.decision.p_holds)
