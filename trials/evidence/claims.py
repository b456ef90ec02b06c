"""How published claims are held against a run: its cells of repeats, the outcomes that decide, the entries
reported."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import numpy as np

from flocking.types import Floats
from trials.evidence import statistics
from trials.evidence.statistics import Decision
from trials.types import Trial, TrialResult


class FinishedTrial(Protocol):
    """A row of a run's results (as `trials.batch.store.Row`)."""

    @property
    def index(self) -> int: ...
    @property
    def status(self) -> str: ...
    @property
    def reason(self) -> str: ...
    @property
    def repeat(self) -> int: ...
    @property
    def conditions(self) -> Mapping[str, Any]: ...
    @property
    def measures(self) -> Mapping[str, float]: ...


class Run(Protocol):
    """A run as the claims and figures read it (as `trials.batch.store.Store`)."""

    @property
    def folder(self) -> Path: ...
    @property
    def trials(self) -> list[Trial]:
        """All trials that the run is to have, finished or not."""

    def rows(self) -> Sequence[FinishedTrial]: ...
    def series(self, index: int) -> TrialResult: ...


class UndecidedError(Exception):
    """A claim cannot be judged on this run; the message says why."""


class Outcome(NamedTuple):
    """One tested quantity that bears on a claim."""

    label: str
    """What was measured, in which conditions, with its unit."""
    decision: Decision
    kind: str
    """`exceeds` or `equivalent`."""
    threshold: float
    margin: float
    decides: bool
    """False: shown beside the others, but without a say in the verdict."""
    ratio: bool = False
    """The numbers tested are logarithms of ratios; `shown` turns them back."""

    def shown(self) -> tuple[float, float, float, float]:
        """Measured, low, high and margin in the unit of the label."""
        numbers = (self.decision.measured, self.decision.low, self.decision.high, self.margin)
        return tuple(map(math.exp, numbers)) if self.ratio else numbers  # type: ignore[return-value]

    def in_margins(self) -> tuple[float, float, float]:
        """Measured, low and high, less the threshold, in units of the margin: what a forest plot puts on one
        axis."""
        decision, scale = self.decision, self.margin
        return (
            (decision.measured - self.threshold) / scale,
            (decision.low - self.threshold) / scale,
            (decision.high - self.threshold) / scale,
        )


@dataclass(frozen=True)
class Entry:
    """A published number or claim beside what was measured: one line of the report."""

    source: str
    quantity: str
    published: str | float
    measured: float
    low: float
    high: float
    n: int
    agrees: bool | None
    """None = undecided."""
    test: str
    margin: float
    effect: float = math.nan
    """Hedges' g of what was measured."""
    arm: Mapping[str, Any] = field(default_factory=dict)
    """The values of a sweep's keys in the trials that it is about."""
    outcomes: tuple[Outcome, ...] = ()
    """All that was tested, of which `measured` is the one that the verdict hangs on."""

    def as_json(self) -> dict[str, Any]:
        """As `herd report --json` prints it; nan becomes null."""
        names = ("source", "quantity", "published", "measured", "low", "high", "n", "agrees", "test", "margin")
        told = {name: _plain(getattr(self, name)) for name in (*names, "effect")}
        return told | ({"arm": dict(self.arm)} if self.arm else {})


class Cells:
    """The finished trials of one arm of a run, by condition, in pairs by repeat.

    Failed trials are left out and counted; a trial that has not run yet makes what needs it `UndecidedError`.
    """

    def __init__(self, trials: Iterable[Trial], rows: Iterable[FinishedTrial], keys: Sequence[str]) -> None:
        """`keys`: the conditions, in the order in which `values` is given theirs."""
        self.keys = tuple(keys)
        self.trials = list(trials)
        self._rows = {row.index: row for row in rows}
        self._planned: dict[tuple[Any, ...], dict[int, FinishedTrial | None]] = {}
        for trial in self.trials:
            cell = tuple(trial.conditions.get(key) for key in self.keys)
            self._planned.setdefault(cell, {})[trial.repeat] = self._rows.get(trial.index)
        self.used: set[tuple[Any, ...]] = set()
        """Cells that were asked for since the last `begin`."""

    def begin(self) -> None:
        """Forgets which cells were asked for."""
        self.used.clear()

    def levels(self, key: str) -> list[Any]:
        """The values of a condition that the run has, in order; `UndecidedError` if it varies no such thing."""
        column = self.keys.index(key)
        found = {cell[column] for cell in self._planned} - {None}
        if not found:
            raise UndecidedError(f"the run has no trials with {key}")
        return sorted(found)

    def values(self, measure: str, *cell: Any) -> dict[int, float]:
        """A measure of one cell by repeat; nan where it could not be measured or the trial failed."""
        self.used.add(cell)
        if cell not in self._planned:
            told = ", ".join(f"{key} = {value}" for key, value in zip(self.keys, cell, strict=True))
            raise UndecidedError(f"the run has no trials with {told}")
        rows = self._planned[cell]
        if any(row is None for row in rows.values()):
            missing = sum(row is None for used in self.used for row in self._planned.get(used, {}).values())
            raise UndecidedError(f"{missing} of the trials that it needs have not run (herd resume finishes them)")
        return {
            repeat: row.measures.get(measure, math.nan) if row is not None and row.status == "done" else math.nan
            for repeat, row in rows.items()
        }

    def array(self, measure: str, *cell: Any) -> Floats:
        """(n,) the same without the repeats' numbers."""
        return np.array(list(self.values(measure, *cell).values()))

    def failed(self) -> int:
        """Failed trials in the cells that were asked for."""
        rows = [row for cell in self.used for row in self._planned.get(cell, {}).values()]
        return sum(row is not None and row.status != "done" for row in rows)

    def difference(self, measure: str, cell: tuple[Any, ...], other: tuple[Any, ...]) -> Floats:
        """(n,) `measure` in `cell` minus that in `other`, paired by repeat; nan where one of the two is
        missing."""
        first, second = self.values(measure, *cell), self.values(measure, *other)
        return np.array([first[repeat] - second[repeat] for repeat in sorted(first.keys() & second.keys())])

    def log_ratio(self, measure: str, cell: tuple[Any, ...], other: tuple[Any, ...]) -> Floats:
        """(n,) natural logarithm of `measure` in `cell` over that in `other`; nan where either is not
        positive."""
        first, second = self.values(measure, *cell), self.values(measure, *other)
        pairs = np.array([(first[r], second[r]) for r in sorted(first.keys() & second.keys())]).reshape(-1, 2)
        with np.errstate(divide="ignore", invalid="ignore"):
            logs = np.log(np.where(pairs > 0.0, pairs, np.nan))
        change: Floats = logs[:, 0] - logs[:, 1]
        return change


def same(label: str, differences: Floats, margin: float, decides: bool = True) -> Outcome:
    """The outcome that paired differences lie within ±margin."""
    decision = statistics.equivalent(differences, margin)
    return Outcome(label, decision, "equivalent", 0.0, margin, decides)


def near(label: str, values: Floats, target: float, margin: float, decides: bool = True) -> Outcome:
    """The outcome that values lie within ±margin of a published number; it shows the values themselves."""
    decision = statistics.equivalent(np.asarray(values) - target, margin)
    shown = decision._replace(
        measured=decision.measured + target, low=decision.low + target, high=decision.high + target
    )
    return Outcome(label, shown, "equivalent", target, margin, decides)


def more(label: str, values: Floats, margin: float, threshold: float = 0.0, decides: bool = True) -> Outcome:
    """The outcome that values exceed the threshold; an excess below the margin does not count."""
    return Outcome(label, statistics.exceeds(values, threshold, margin), "exceeds", threshold, margin, decides)


def above(
    label: str,
    values: Floats,
    threshold: float,
    scale: float,
    decides: bool = True,
    bounds: tuple[float, float] = (-math.inf, math.inf),
) -> Outcome:
    """The outcome that values lie above a threshold: not below it. `scale` is the margin shown.

    `bounds`: between which values can lie at all; the interval shown ends there.
    """
    decision = statistics.exceeds(values, threshold)
    shown = decision._replace(low=max(decision.low, bounds[0]), high=min(decision.high, bounds[1]))
    return Outcome(
        f"{label}, to lie above {threshold:g}",
        shown,
        "exceeds",
        threshold,
        scale,
        decides,
    )


def ratio(label: str, logs: Floats, factor: float, decides: bool = True) -> Outcome:
    """The outcome that ratios, given as logarithms, exceed 1; less than `factor` does not count."""
    decision, margin = statistics.exceeds(logs, 0.0, math.log(factor)), math.log(factor)
    return Outcome(label, decision, "exceeds", 0.0, margin, decides, ratio=True)


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


@cache
def published(study: str, source: str, table: str) -> dict[str, Any]:
    """A table of the published.toml of a study, whose package is named."""
    text = resources.files(study).joinpath("published.toml").read_text(encoding="utf-8")
    found: dict[str, Any] = tomllib.loads(text)[source][table]
    return found


def arms(run: Run, keys: Sequence[str]) -> list[tuple[dict[str, Any], list[Trial]]]:
    """The arms of a run: for each combination of the conditions other than `keys`, its values and its
    trials."""
    found: dict[tuple[tuple[str, Any], ...], list[Trial]] = {}
    for trial in run.trials:
        others = tuple((key, value) for key, value in trial.conditions.items() if key not in keys)
        found.setdefault(others, []).append(trial)
    return [(dict(others), trials) for others, trials in found.items()]


class Question(NamedTuple):
    """A published number or claim, and how it is held against a run."""

    source: str
    quantity: str
    words: str
    """As published."""
    test: str
    outcomes: Callable[[], Sequence[Outcome]]
    """What is tested: all that decide must hold. May raise `UndecidedError`."""


def answered(question: Question, cells: Cells, arm: Mapping[str, Any]) -> Entry:
    """The entry of a question that reads one arm's cells."""
    cells.begin()
    try:
        outcomes = list(question.outcomes())
        if not any(outcome.decides for outcome in outcomes):
            raise UndecidedError("the run has no trials that decide it")
    except UndecidedError as why:
        return undecided(question.source, question.quantity, question.words, str(why), arm)
    agrees, shown = decided_by_all(outcomes)
    measured, low, high, margin = shown.shown()
    failed = cells.failed()
    left_out = f"; {failed} failed trial{'s' if failed > 1 else ''} left out" if failed else ""
    return Entry(
        source=question.source,
        quantity=f"{question.quantity}: {shown.label}",
        published=question.words,
        measured=measured,
        low=low,
        high=high,
        n=shown.decision.n,
        agrees=agrees,
        test=f"{question.test}{left_out}",
        margin=margin,
        effect=shown.decision.effect,
        arm=arm,
        outcomes=tuple(outcomes),
    )


def undecided(source: str, quantity: str, words: str, why: str, arm: Mapping[str, Any]) -> Entry:
    """The entry of a claim that could not be judged."""
    nan = math.nan
    return Entry(source, quantity, words, nan, nan, nan, 0, None, f"undecided: {why}", nan, arm=arm)


def _plain(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value
