"""Published numbers and claims held against a run: the questions that a study asks of it, and the entries of its
report."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib import resources
from typing import Any, NamedTuple

from flocking.errors import InputError
from trials.evidence.outcomes import Outcome, decided_by_all
from trials.evidence.runs import CellName, Cells, Run, UndecidedError, arms

VERDICTS = {True: "holds", False: "does not hold", None: "undecided"}


class Look(NamedTuple):
    """A claim at one look of a run until decided, in the unit of its quantity."""

    n: int
    measured: float
    low: float
    high: float
    """The interval holds at all looks together."""
    agrees: bool | None


@dataclass(frozen=True)
class Entry:
    """A published number or claim beside what was measured: one line of the report."""

    source: str
    quantity: str
    """What was measured for it, with its unit."""
    claim: str
    """What was published, in words."""
    published: float | str
    """The number that `measured` is held against, where one was published; else the words of the claim."""
    measured: float
    low: float
    high: float
    n: int
    agrees: bool | None
    """None = undecided."""
    test: str
    margin: float
    power: float = math.nan
    """How often the publication's own number of repeats would show the claim if it is true; nan if that is not told."""
    effect: float = math.nan
    """Hedges' g of what was measured."""
    arm: Mapping[str, Any] = field(default_factory=dict)
    """The values of a sweep's keys in the trials that it is about."""
    outcomes: tuple[Outcome, ...] = ()
    """All that was tested, of which `measured` is the one that the verdict hangs on."""
    words: tuple[str, ...] = ()
    """Of the command of `herd` that makes the trials which an undecided claim needs; empty where there is none."""
    cells: frozenset[CellName] = frozenset()
    """What it was judged on."""
    looks: tuple[Look, ...] = ()
    """Of a run until decided: the claim at each look so far."""

    def as_json(self) -> dict[str, Any]:
        """As `herd report --json` prints it; nan becomes null."""
        names = ("source", "quantity", "published", "measured", "low", "high", "n", "agrees", "test", "margin")
        told = {name: _plain(getattr(self, name)) for name in (*names, "effect", "claim")}
        told |= {"power": _plain(self.power)} if math.isfinite(self.power) else {}
        if self.looks:
            told["looks"] = [{name: _plain(value) for name, value in look._asdict().items()} for look in self.looks]
        return told | ({"arm": dict(self.arm)} if self.arm else {})


@cache
def published(study: str, source: str, table: str) -> dict[str, Any]:
    """A table of the published.toml of a study, whose package is named."""
    text = resources.files(study).joinpath("published.toml").read_text(encoding="utf-8")
    found: dict[str, Any] = tomllib.loads(text)[source][table]
    return found


class Judged(NamedTuple):
    """A claim after its tests."""

    agrees: bool | None
    """None = undecided."""
    shown: Outcome
    """The outcome that the verdict hangs on: the report shows its numbers."""
    outcomes: Sequence[Outcome]
    """All that was tested."""
    test: str
    """How the verdict came about, in words."""
    power: float = math.nan
    """As in `Entry`."""


class Question(NamedTuple):
    """A published number or claim, and how it is held against a run."""

    source: str
    quantity: str
    claim: str
    """As published, in words."""
    judge: Callable[[], Judged]
    """Tests it. Raises `UndecidedError` where the run does not have what that takes."""
    published: float | None = None
    """The number, where one was published that is held against what was measured."""


def claim_of(study: str, source: str, table: str, number: int, quantity: str, judge: Callable[[], Judged]) -> Question:
    """The question on a claim, numbered from 1, of a table of a study's published.toml that has claims and sections."""
    told = published(study, source, table)
    section = told["sections"][number - 1]
    place = f"section {section}" if section[0].isdigit() else section
    return Question(
        source=f"{source} {table}, claim {number} ({place})",
        quantity=quantity,
        claim=told["claims"][number - 1],
        judge=judge,
    )


def all_must_hold(test: str, outcomes: Callable[[], Sequence[Outcome]]) -> Callable[[], Judged]:
    """The judge of a claim that holds if every outcome that decides it does."""

    def judge() -> Judged:
        found = list(outcomes())
        if not any(outcome.decides for outcome in found):
            raise UndecidedError("the run has no trials that decide it")
        agrees, shown = decided_by_all(found)
        return Judged(agrees, shown, found, test)

    return judge


def answers(run: Run, keys: Sequence[str], questions: Callable[[Cells], Iterable[Question]]) -> list[Entry]:
    """The entries of a study: for each arm of the run those of all questions on its cells, which `keys` tell apart."""
    entries, rows = [], run.rows()
    for arm, trials in arms(run, keys):
        cells = Cells(trials, rows, keys)
        entries += [answered(question, [cells], arm) for question in questions(cells)]
    return entries


def answered(question: Question, used: Sequence[Cells], arm: Mapping[str, Any]) -> Entry:
    """The entry of a question on one arm. `used`: the cells that it reads; a judge may add to them while it judges.

    Raises `InputError` for an outcome without a margin: it could be neither drawn nor told apart from a hair's breadth.
    """
    for cells in used:
        cells.begin()
    try:
        judged = question.judge()
    except UndecidedError as why:
        return _undecided(question, why, arm, used)
    for outcome in judged.outcomes:
        if outcome.margin <= 0.0:
            raise InputError(
                f"{question.source}, {question.quantity}: outcome {outcome.label!r} has margin {outcome.margin:g}; "
                "expected one above 0: the least that counts, or for `above` the scale that it is shown on"
            )
    shown, failed = judged.shown, sum(cells.failed() for cells in used)
    left_out = f"; {failed} failed trial{'s' if failed > 1 else ''} left out" if failed else ""
    measured, low, high, margin = shown.shown()
    return Entry(
        source=question.source,
        quantity=f"{question.quantity}: {shown.label}",
        claim=question.claim,
        published=shown.published if math.isfinite(shown.published) else _published(question),
        measured=measured,
        low=low,
        high=high,
        n=shown.decision.n,
        agrees=judged.agrees,
        test=f"{judged.test}{left_out}",
        margin=margin,
        power=judged.power,
        effect=shown.decision.effect,
        arm=arm,
        outcomes=tuple(judged.outcomes),
        cells=_read(used),
    )


def _undecided(question: Question, why: UndecidedError, arm: Mapping[str, Any], used: Sequence[Cells]) -> Entry:
    """The entry of a question that the run cannot answer."""
    nan = math.nan
    return Entry(
        source=question.source,
        quantity=question.quantity,
        claim=question.claim,
        published=_published(question),
        measured=nan,
        low=nan,
        high=nan,
        n=0,
        agrees=None,
        test=f"undecided: {why}",
        margin=nan,
        arm=arm,
        words=why.words,
        cells=_read(used),
    )


def _read(used: Sequence[Cells]) -> frozenset[CellName]:
    return frozenset(name for cells in used for name in cells.names())


def _published(question: Question) -> float | str:
    return question.claim if question.published is None else float(question.published)


def _plain(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value
