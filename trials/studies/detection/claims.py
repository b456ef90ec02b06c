"""The claims of Fine 2015's detection case study (chapter 2) held against a run and its supplements.

The tests stand in trials.studies.detection.judges, their reasons in docs/detection-case-study.md.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from typing import Any

from flocking.errors import InputError
from trials.evidence.claims import Cells, Entry, Run, UndecidedError, arms, published, undecided
from trials.studies.detection.judges import JUDGES, KEYS, Data, Judged
from trials.types import Trial

Find = Callable[[Run, str, Mapping[str, Any], Collection[str]], Cells]
"""(run, experiment, arm, keys in which its trials may differ) → the trials of a supplement, or
`UndecidedError`."""


def claims(run: Run, find: Find | None = None) -> list[Entry]:
    """An entry for each of the 13 claims, for each arm of the run; `find` brings the supplements' trials."""
    find = find or supplement
    table = published(__package__, "fine2015", "detection_case_study")
    entries = []
    for arm, trials in arms(run, KEYS):
        study = Cells(trials, run.rows(), KEYS)

        def ideal(arm: Mapping[str, Any] = arm) -> Cells:
            return find(run, "detection-ideal", arm, ("herd.sensors",))

        def sweep(arm: Mapping[str, Any] = arm) -> Cells:
            return find(run, "detection-exclusion-sweep", arm, ())

        data = Data(study, ideal, sweep)
        for number, (judge, words, section) in enumerate(
            zip(JUDGES, table["claims"], table["sections"], strict=True), start=1
        ):
            source = f"fine2015 detection_case_study, claim {number} (section {section})"
            entries.append(_entry(judge, data, source, number, words, arm))
    return entries


def _entry(
    judge: Callable[[Data], Judged], data: Data, source: str, number: int, words: str, arm: Mapping[str, Any]
) -> Entry:
    used: list[Cells] = []

    def opened(source_of: Callable[[], Cells]) -> Callable[[], Cells]:
        def get() -> Cells:
            used.append(source_of())
            used[-1].begin()
            return used[-1]

        return get

    data.study.begin()
    used.append(data.study)
    try:
        judged = judge(Data(data.study, opened(data.ideal), opened(data.sweep)))
    except UndecidedError as why:
        return undecided(source, f"claim {number}", words, str(why), arm)
    failed = sum(cells.failed() for cells in used)
    left_out = f"; {failed} failed trial{'s' if failed > 1 else ''} left out" if failed else ""
    measured, low, high, margin = judged.shown.shown()
    return Entry(
        source=source,
        quantity=f"claim {number}: {judged.shown.label}",
        published=words,
        measured=measured,
        low=low,
        high=high,
        n=judged.shown.decision.n,
        agrees=judged.agrees,
        test=f"{judged.test}{left_out}",
        margin=margin,
        effect=judged.shown.decision.effect,
        arm=arm,
        outcomes=tuple(judged.outcomes),
    )


def supplement(run: Run, experiment: str, arm: Mapping[str, Any], besides: Collection[str]) -> Cells:
    """The trials of the newest run of a supplementary experiment whose settings are those of an arm of `run`.

    Looked for beside the run and below `runs/`. They may differ in the claims' own conditions, in their
    formation (it goes by repeat), and in the keys `besides` with all below them. Raises `UndecidedError` if there
    is none.
    """
    from trials.batch.store import opened

    folder = _newest(run, experiment)
    if folder is None:
        raise UndecidedError(f"needs trials of {experiment} (herd run {experiment})")
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
    raise UndecidedError(f"needs trials of {experiment} with {key} = {wanted[key]}; the newest, {folder}, have {value}")


def _newest(run: Run, experiment: str) -> Path | None:
    from trials.batch.store import newest

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
