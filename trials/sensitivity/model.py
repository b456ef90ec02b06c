"""A point of a sensitivity analysis as trials, and its trials as the outputs of claims.

Each point has the experiment's own planned trials, with the same seed and repeats: the same start and noise at all
points (common random numbers). Of its cells those are run that a claim reads.
"""

from __future__ import annotations

import dataclasses
import itertools
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from flocking.errors import InputError
from flocking.types import Floats
from trials import simulations
from trials.batch import runfile, store
from trials.batch.store import Row
from trials.design import plan
from trials.evidence.claims import Entry
from trials.experiments import load, run_in
from trials.sensitivity.choices import Choice, settings
from trials.sensitivity.quantity import NOTHING, Output, output
from trials.types import Trial, TrialResult, Value

OFF_REFERENCE = 0.123
"""A place of all choices at which no run is likely to lie."""
Cell = tuple[str, tuple[tuple[str, Value], ...]]
"""An experiment and the conditions of some of its trials."""


class Supplement(NamedTuple):
    """Another experiment whose trials a claim reads as well."""

    experiment: str
    settings: Mapping[str, Value]


class Part(NamedTuple):
    """The trials that a point has of one experiment; indices run through all parts of a point."""

    experiment: str
    trials: list[Trial]


@dataclass(frozen=True)
class Model:
    """An experiment with its claims, as a function of its choices."""

    experiment: str
    repeats: int
    seed: int
    varied: Sequence[Choice]
    claims: tuple[int, ...] = ()
    """Of the report's entries, from 1."""
    supplements: tuple[Supplement, ...] = ()
    wanted: frozenset[Cell] | None = None
    """Cells that are run; None: all."""

    def parts(self, point: Floats) -> list[Part]:
        """The trials of a point (k,), checked. Raises `InputError` where its values do not fit together."""
        found = self.planned(point)
        for part in found:
            for trial in part.trials:
                simulations.check(trial)
        return found

    def planned(self, point: Floats) -> list[Part]:
        """The trials of a point (k,)."""
        given = settings(self.varied, point)
        numbers, found = itertools.count(1), []
        for experiment, own in ((self.experiment, {}), *self.supplements):
            made = plan(experiment, repeats=self.repeats, seed=self.seed, settings={**own, **given}).trials
            kept = [trial for trial in made if self.wanted is None or cell(experiment, trial) in self.wanted]
            found.append(Part(experiment, [dataclasses.replace(trial, index=next(numbers)) for trial in kept]))
        return found

    def outputs(self, parts: Sequence[Part], rows: Mapping[int, Row]) -> list[Output]:
        """What a point's claims make of its finished trials."""
        entries = judged(parts, rows)
        return [output(entries[claim - 1]) if claim <= len(entries) else NOTHING for claim in self.claims]


@dataclass(frozen=True)
class _PointRun:
    """The trials of a point as claims read them; there are no series."""

    folder: Path
    trials: list[Trial]
    finished: Sequence[Row]

    def rows(self) -> Sequence[Row]:
        return self.finished

    def series(self, index: int) -> TrialResult:
        raise InputError(f"trial {index} left no series: a sensitivity analysis keeps measures alone")


def cell(experiment: str, trial: Trial) -> Cell:
    """Of which cell a trial is."""
    return experiment, tuple(trial.conditions.items())


def judged(parts: Sequence[Part], rows: Mapping[int, Row]) -> list[Entry]:
    """The entries of a point; `rows`: by index, those of its trials that have ended.

    Claims look for the trials of supplements in the folders of runs: there they are laid for them.
    """
    with tempfile.TemporaryDirectory(prefix="herd-") as base:
        for part in parts[1:]:
            _lay(Path(base) / part.experiment / "001", part, rows)
        own = parts[0]
        run = _PointRun(Path(base) / own.experiment / "001", own.trials, _of(own, rows))
        found: list[Entry] = run_in(load(own.experiment), "claims", run)
    return found


def supplements(model: Model, claim: int) -> tuple[Supplement, ...]:
    """The other experiments of which a claim reads trials."""
    place = np.full(len(model.varied), OFF_REFERENCE)
    given, found = settings(model.varied, place), list[Supplement]()
    while True:
        parts = dataclasses.replace(model, supplements=tuple(found), wanted=None).planned(place)
        entries = judged(parts, {})
        words = entries[claim - 1].words if claim <= len(entries) else ()
        if len(words) < 2 or words[0] != "run" or words[1] in [each.experiment for each in found]:
            return tuple(found)
        found.append(Supplement(words[1], _set_by(words, plan(words[1], repeats=1).trials[0], given)))


def read_cells(model: Model, parts: Sequence[Part], rows: Mapping[int, Row]) -> frozenset[Cell]:
    """The cells without which a claim of the model is judged otherwise; all where leaving out the rest changes it."""
    entries = judged(parts, rows)
    every = list(dict.fromkeys(cell(part.experiment, trial) for part in parts for trial in part.trials))
    found = frozenset(
        each for each in every if _differs(model, entries, judged(_without(parts, frozenset({each})), rows))
    )
    left_out = frozenset(every) - found
    return frozenset(every) if _differs(model, entries, judged(_without(parts, left_out), rows)) else found


def _differs(model: Model, entries: Sequence[Entry], others: Sequence[Entry]) -> bool:
    return any(
        len(others) < claim or repr(entries[claim - 1].outcomes) != repr(others[claim - 1].outcomes)
        for claim in model.claims
    )


def _without(parts: Sequence[Part], cells: frozenset[Cell]) -> list[Part]:
    return [
        Part(part.experiment, [trial for trial in part.trials if cell(part.experiment, trial) not in cells])
        for part in parts
    ]


def _of(part: Part, rows: Mapping[int, Row]) -> list[Row]:
    return [rows[trial.index] for trial in part.trials if trial.index in rows]


def _lay(folder: Path, part: Part, rows: Mapping[int, Row]) -> None:
    """The folder of a run of a supplement, with what of its trials has ended."""
    run = {
        "format": runfile.FORMAT,
        "experiment": part.experiment,
        "laws": {},
        "trials": [trial.as_dict() for trial in part.trials],
    }
    kept = store.create(folder, run, {})
    try:
        for row in _of(part, rows):
            kept.add(row, {})
    finally:
        kept.close()


def _set_by(words: Sequence[str], trial: Trial, but: Mapping[str, Any]) -> dict[str, Value]:
    """The settings in a command's words, of the types that a trial of it has; not those of the keys in `but`."""
    from trials.keys import rows

    usual = {row.key: row.value for row in rows(trial)}
    found: dict[str, Value] = {}
    for option, text in itertools.pairwise(words):
        key, _, value = text.partition("=")
        if option == "--set" and key not in but:
            found[key] = _typed(value, usual.get(key, ""))
    return found


def _typed(text: str, like: Value) -> Value:
    if isinstance(like, bool):
        return text == "true"
    return type(like)(text.strip('"'))
