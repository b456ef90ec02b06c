"""The number that a claim hangs on: the slack of its outcomes, in margins.

The slack of an outcome that is to exceed a bound is (measured - bound) / margin, that of one that is to lie within a
margin of a threshold (margin - |measured - threshold|) / margin. A claim that holds if all of its outcomes do has the
least of theirs. It is positive where the estimate holds; the verdict needs its interval to hold as well.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from trials.evidence.claims import Entry
from trials.evidence.outcomes import Outcome


class Output(NamedTuple):
    """What a point gives for a claim."""

    slack: float
    """In margins; nan where the trials do not give it."""
    agrees: bool | None
    """The verdict; None = undecided."""


NOTHING = Output(math.nan, None)


def output(entry: Entry) -> Output:
    """The slack of a judged claim, with its verdict."""
    found = [slack(outcome) for outcome in _deciding(entry)]
    if not found or not all(map(math.isfinite, found)):
        return NOTHING
    return Output(min(found), entry.agrees)


def slack(outcome: Outcome) -> float:
    """By how many margins an outcome's estimate holds; negative where it does not, nan where there is none."""
    measured, margin = outcome.decision.measured, outcome.margin
    if not margin > 0.0:
        return math.nan
    if outcome.kind == "equivalent":
        return (margin - abs(measured - outcome.threshold)) / margin
    if outcome.kind == "exceeds":
        bound = outcome.tested.bound if outcome.tested is not None else outcome.threshold + margin
        return (measured - bound) / margin
    return math.nan


def lacking(entry: Entry) -> str:
    """Why a claim has no such number, in one line; empty where it has one."""
    if entry.words:
        return f"it needs trials of {entry.words[1]}"
    deciding = _deciding(entry)
    if not deciding and entry.test.startswith("undecided: "):
        return entry.test.removeprefix("undecided: ")
    if not deciding or any(outcome.kind not in ("equivalent", "exceeds") for outcome in deciding):
        return "it counts verdicts, and has no estimate of its own"
    return "" if math.isfinite(output(entry).slack) else "its estimate is not finite"


def _deciding(entry: Entry) -> list[Outcome]:
    return [outcome for outcome in entry.outcomes if outcome.decides]
