"""The claims of Fine 2015's detection case study (chapter 2) held against a run and its supplements.

The tests stand in trials.studies.detection.judges, their reasons in docs/detection.md.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from flocking.errors import InputError
from trials.batch.folders import newest
from trials.batch.store import opened
from trials.design import plan
from trials.evidence.claims import Entry, answered, claim_of
from trials.evidence.runs import Cells, Run, UndecidedError, arms
from trials.invoked import spelled
from trials.studies.detection.conditions import KEYS, VIEW
from trials.studies.detection.judges import JUDGES, Data
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

    Looked for beside the run and below `runs/`. They may differ in the claims' own conditions and in the keys `besides`
    with all below them; formations, which go by repeat, are compared repeat by repeat. Raises `UndecidedError` if there
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
    differences = []
    mine, others = _of_arm(run, arm), arms(other, KEYS)
    try:
        settings = [_settings(trials, besides) for trials in (mine, *(trials for _, trials in others))]
    except InputError as error:  # a world or a body of the user's own, which is not executed
        raise UndecidedError(f"needs trials of {experiment}, which cannot be compared: {error}") from error
    wanted = settings[0]
    for (_, trials), given in zip(others, settings[1:], strict=True):
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
    settings: dict[str, Any] = {}
    for _ in range(2):  # names first: a law's parameters are known once it is put in
        try:
            mine, planned = _of_arm(run, arm)[0], plan(experiment, repeats=1, settings=settings).trials[0]
            another = ("formation",) if mine.formation != planned.formation else ()  # its parameters are others too
            wanted, given = (_settings([t], (*besides, *another), by_repeat=False) for t in (mine, planned))
        except InputError:  # a file of the user's own is no longer there, or is not executed
            return []
        settings |= {key: value for key, value in wanted.items() if key in given and given[key] != value}
    return [
        "run",
        experiment,
        *(word for key, value in settings.items() for word in ("--set", f"{key}={spelled(value)}")),
    ]


def _of_arm(run: Run, arm: Mapping[str, Any]) -> list[Trial]:
    return [trial for trial in run.trials if arm.items() <= trial.conditions.items()]


def _newest(run: Run, experiment: str) -> Path | None:
    for base in (run.folder.resolve().parent.parent, Path("runs")):
        try:
            return newest(experiment, base)
        except InputError:
            continue
    return None


def _settings(trials: Sequence[Trial], besides: Collection[str], by_repeat: bool = True) -> dict[str, Any]:
    """What trials of one arm were run with, but for their conditions and `besides`; the formation of each repeat.

    The laser's view is no part of its noise: it is compared whatever `besides` says.
    """
    from trials.keys import rows

    left_out = (*KEYS, *besides)
    found = {
        row.key: row.value
        for row in rows(trials[0])
        if row.key == VIEW or not any(row.key == key or row.key.startswith(f"{key}.") for key in left_out)
    }
    if not by_repeat:
        return found
    return found | {f"formation of repeat {trial.repeat}": trial.formation for trial in trials}
