"""Runs until decided: their budget, and which trials they run next."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from time import monotonic
from types import ModuleType
from typing import Any, NamedTuple

from flocking.errors import InputError
from trials import experiments
from trials.batch.batch import Progress
from trials.batch.store import DIED, Store
from trials.evidence import until_decided
from trials.evidence.claims import Entry
from trials.evidence.runs import Part, Run
from trials.evidence.until_decided import Course, course
from trials.experiments import run_in
from trials.invoked import command
from trials.types import Trial

_UNITS = {"s": 1.0, "m": 60.0, "min": 60.0, "h": 3600.0}
_BUDGET = re.compile(r"([0-9]{1,9}(?:\.[0-9]{1,9})?)\s*([a-z]*)")


class Budget(NamedTuple):
    """When a run until decided ends, whatever is decided by then."""

    repeats: int | None = None
    """None: as many as the most looks take."""
    seconds: float | None = None
    """Wall time after which no other look is begun; None: any."""

    def __str__(self) -> str:
        return f"{self.repeats}" if self.repeats is not None else f"{self.seconds:g}s"


NO_BUDGET = Budget()


def budget(text: str) -> Budget:
    """`--budget 10m` or `--budget 40`. Raises `InputError`."""
    number, seconds = time_or_number(text, "repeats", "10m, 90s or 40")
    return Budget(number, seconds)


def time_or_number(text: str, counted: str, example: str) -> tuple[int | None, float | None]:
    """A budget as a number of what is counted, or as a time, s; the other of the two is None. Raises `InputError`."""
    match = _BUDGET.fullmatch(text.strip())
    if match is not None and float(match[1]) > 0.0:
        if match[2] in _UNITS:
            return None, float(match[1]) * _UNITS[match[2]]
        if match[2] in ("", counted, counted.removesuffix("s")) and match[1].isdecimal():
            return int(match[1]), None
    raise InputError(f"--budget {text!r}: expected a time above 0 or a number of {counted}, as in {example}")


def laid_down(
    folder: Path, trials: list[Trial], experiment: ModuleType, looks: Sequence[int], most: Budget
) -> dict[str, Any]:
    """The plan that a run's run.json holds. Raises `InputError` if no number of repeats decides any claim."""
    run = Part(_Planned(folder, trials), trials, [])
    plan = until_decided.laid_down(run, _claims_of(experiment), looks, "" if most == NO_BUDGET else str(most))
    if not any(claim["by repeats"] for claim in plan["claims"]):
        raise InputError(f"--until-decided: {_needs(run, experiment)}")
    return {**plan, "seconds": most.seconds}


def experiment_of(kept: Store, path: str | None) -> ModuleType:
    """The module of a run's experiment, of a user's own from `path`. Raises `InputError` where that is missing."""
    name = str(kept.run["experiment"])
    if path is not None and experiments.name_of(path) != name:
        raise InputError(f"--experiment {path}: the run is of {name!r}; expected the file of that experiment")
    if path is None and not experiments.known(name):
        again = command("resume", str(kept.folder), "--experiment", "FILE.py")
        raise InputError(
            f"{name!r} is not among the experiments here, and its claims say what is left; if yours: {again}"
        )
    return experiments.load(path or name)


def looks_of(run: Any) -> tuple[int, ...]:
    """The looks that a run.json holds."""
    return tuple(run["until_decided"]["looks"])


def course_of(kept: Store, experiment: ModuleType) -> Course:
    """How far a run until decided has come."""
    return course(kept, _claims_of(experiment), looks_of(kept.run))


class Blocks:
    """The blocks of trials of a run until decided, one after another."""

    def __init__(self, kept: Store, experiment: ModuleType) -> None:
        self.kept, self.experiment = kept, experiment
        self.course: Course | None = None
        self.expected = 0
        """Trials that there are to be by the next look."""
        self._begun = monotonic()

    def first(self) -> Sequence[Trial]:
        """The trials to begin with; no look counts a trial whose worker died, which is to be run again."""
        rows = [row for row in self.kept.rows() if not row.reason.startswith(DIED)]
        return self._advance(Part(self.kept, self.kept.trials, rows))

    def next(self, progress: Progress) -> Sequence[Trial]:
        """The trials to go on with; none when all is decided or the budget is used up."""
        taken = self.course.taken if self.course is not None else 0
        missing = self._advance(self.kept)
        assert self.course is not None
        if self.course.taken > taken:
            progress.goes_on(told(self.course), self.expected)
        seconds = self.kept.run["until_decided"].get("seconds")
        if missing and seconds is not None and monotonic() - self._begun >= seconds:
            progress.goes_on(f"the budget of {seconds:g} s is used up", self.expected - len(missing))
            return []
        return missing

    def _advance(self, run: Run) -> Sequence[Trial]:
        self.course = course(run, _claims_of(self.experiment), looks_of(self.kept.run), self.course)
        self.expected = len(self.kept.rows()) + len(self.course.missing)
        return self.course.missing


def told(state: Course) -> str:
    """A course in one line."""
    if state.taken == 0:
        return f"no look of {len(state.looks)} was taken yet"
    entries = [entry for entry in state.entries if entry.cells]
    still, repeats = len(state.open()), state.looks[state.taken - 1]
    return (
        f"look {state.taken} of at most {len(state.looks)}, {repeats} repeat{'s' * (repeats != 1)}: "
        f"{len(entries) - still} of {len(entries)} claims decided"
    )


def _claims_of(experiment: ModuleType) -> until_decided.Claims:
    def claims(run: Run) -> list[Entry]:
        found: list[Entry] = run_in(experiment, "claims", run)
        return found

    return claims


def _needs(run: Run, experiment: ModuleType) -> str:
    """Why no number of repeats decides any claim."""
    entries = _claims_of(experiment)(run)
    words = next((entry.words for entry in entries if entry.words), ())
    why = next((entry.test for entry in entries if entry.test), "there are no claims")
    return f"no number of repeats decides a claim of it ({why}){f'; needs: {command(*words)}' if words else ''}"


class _Planned:
    """A run before its first trial."""

    def __init__(self, folder: Path, trials: list[Trial]) -> None:
        self.folder, self.trials = folder, trials

    def rows(self) -> list[Any]:
        return []

    def series(self, index: int) -> Any:
        raise InputError(f"trial {index} has not run")
