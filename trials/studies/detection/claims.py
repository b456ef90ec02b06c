"""The claims of Fine 2015's detection case study (chapter 2) held against a run and its supplements.

The tests stand in trials.studies.detection.judges, their reasons in docs/detection.md.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from flocking.errors import InputError
from trials.batch.store import newest, opened
from trials.design import plan
from trials.evidence.claims import Entry, answered, claim_of
from trials.evidence.runs import Cells, Run, UndecidedError, arms
from trials.invoked import spelled
from trials.studies.detection.judges import JUDGES, KEYS, Data
from trials.types import Trial

Find = Callable[[Run, str, Mapping[str, Any], Collection[str]], Cells]
"""(run, experiment, arm, keys in which its trials may differ) → the trials of a supplement, or `UndecidedError`."""


def claims(run: Run, find: Find | None = None) -> list[Entry]:
    """An entry for each of the 13 claims, for each arm of the run; `find` brings the supplements' trials."""
    find, rows = find or supplement, run.rows()
    entries = []
    for arm, trials in arms(run, KEYS):
        study = Cells(trials, rows, KEYS)
        for number, judge in enumerate(JUDGES, start=1):
            used = [study]
            data = Data(
                study,
                ideal=partial(_opened, used, partial(find, run, "detection-ideal", arm, ("herd.sensors",))),
                sweep=partial(_opened, used, partial(find, run, "detection-exclusion-sweep", arm, ())),
            )
            question = claim_of(
                __package__,
                "fine2015",
                "detection_case_study",
                number,
                f"claim {number}",
                partial(judge, data),
            )
            entries.append(answered(question, used, arm))
    return entries


def _opened(used: list[Cells], find: Callable[[], Cells]) -> Cells:
    """The trials of a supplement, which join those that a claim uses."""
    cells = find()
    cells.begin()
    used.append(cells)
    return cells


def supplement(run: Run, experiment: str, arm: Mapping[str, Any], besides: Collection[str]) -> Cells:
    """The trials of the newest run of a supplementary experiment whose settings are those of an arm of `run`.

    Looked for beside the run and below `runs/`. They may differ in the claims' own conditions, in their
    formation (it goes by repeat), and in the keys `besides` with all below them. Raises `UndecidedError` if there
    is none.
    """
    folder = _newest(run, experiment)
    if folder is None:
        raise UndecidedError(f"needs trials of {experiment}", _words(run, experiment, arm, besides))
    try:
        other = opened(folder)
    except InputError as error:
        raise UndecidedError(f"needs trials of {experiment}: {error}") from error
    try:
        rows = other.rows()
    finally:
        other.close()
    wanted = _settings(next(t for t in run.trials if arm.items() <= t.conditions.items()), besides)
    differences = []
    for _, trials in arms(other, KEYS):
        given = _settings(trials[0], besides)
        differ = sorted(key for key in wanted.keys() & given.keys() if wanted[key] != given[key])
        if not differ:
            return Cells(trials, rows, KEYS)
        differences.append((len(differ), differ[0], given[differ[0]]))
    _, key, value = min(differences)
    raise UndecidedError(
        f"needs trials of {experiment} with {key} = {wanted[key]}; the newest, {folder}, have {value}",
        _words(run, experiment, arm, besides),
    )


def _words(run: Run, experiment: str, arm: Mapping[str, Any], besides: Collection[str]) -> list[str]:
    """Of the command that runs the trials of a supplement with the settings of an arm of `run`."""
    wanted = _settings(next(t for t in run.trials if arm.items() <= t.conditions.items()), besides)
    settings: dict[str, Any] = {}
    for _ in range(2):  # names first: a law's parameters are known once it is put in
        try:
            given = _settings(plan(experiment, repeats=1, settings=settings).trials[0], besides)
        except InputError:  # a file of the user's own is no longer there
            return []
        settings |= {key: value for key, value in wanted.items() if key in given and given[key] != value}
    return [
        "run",
        experiment,
        *(word for key, value in settings.items() for word in ("--set", f"{key}={spelled(value)}")),
    ]


def _newest(run: Run, experiment: str) -> Path | None:
    for base in (run.folder.resolve().parent.parent, Path("runs")):
        try:
            return newest(experiment, base)
        except InputError:
            continue
    return None


def _settings(trial: Trial, besides: Collection[str]) -> dict[str, Any]:
    """What a trial was run with, but for its conditions, formation and `besides`."""
    from trials.keys import rows

    left_out = (*KEYS, *besides)
    return {
        row.key: row.value
        for row in rows(trial)
        if row.key != "formation" and not any(row.key == key or row.key.startswith(f"{key}.") for key in left_out)
    }
