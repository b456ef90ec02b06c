"""`herd report`: what was published beside what was measured: on the terminal, as JSON, and as one page of HTML."""

from __future__ import annotations

import dataclasses
import json
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from flocking import users_files
from flocking.errors import InputError, StorageError
from flocking.found import is_path
from trials import experiments
from trials.batch import deciding
from trials.batch.folders import newest
from trials.batch.store import Store, opened
from trials.evidence.claims import Entry
from trials.evidence.summary import Cell, Mean, cells, mean, naming
from trials.evidence.until_decided import Course, changed, levels_of
from trials.experiments import run_in
from trials.invoked import command
from trials.reports.wording import (
    VERDICTS,
    arms_of,
    columns,
    counted,
    misfits,
    notes_of,
    shown_interval,
    shown_number,
    verdicts,
)
from trials.simulations import measures_of

STYLES = {True: "green", False: "red", None: "yellow"}


def report(folder: Path | None = None, as_json: bool = False, experiment: str | None = None) -> str:
    """The table of a run to print, having written its report.html and figures; or its entries as a JSON list.

    `folder` defaults to the newest run; `experiment`: the path of the file of a user's own experiment. Nothing that
    the folder holds is executed. Where the page cannot be written, the table's last line says so. Raises `InputError`
    if the folder holds no run that can be read.
    """
    store = opened(folder if folder is not None else newest())
    try:
        with users_files.executed(False, others=False):
            return _told(store, as_json, experiment)
    finally:
        store.close()


def _told(store: Store, as_json: bool, experiment: str | None) -> str:
    module = _experiment(store.run["experiment"], experiment)
    entries, store = judged(store, module)
    found = cells(store, measures_of(store.trials))
    if as_json:
        told = [entry.as_json() for entry in entries or _of_cells(store.run["experiment"], found)]
        return json.dumps(told, indent=2, ensure_ascii=False, allow_nan=False)
    from trials.reports.report_page import write

    unwritten = ""
    try:
        write(store, module, entries, found)
    except StorageError as error:
        unwritten = f"\nthe report's page and figures are not written: {error}"
    except OSError as error:
        unwritten = f"\nthe report's page and figures are not written into {store.folder}: {error.strerror or error}"
    return _on_terminal(store, module, entries, found) + unwritten


def judged(store: Store, module: Any) -> tuple[list[Entry] | None, Store]:
    """The entries of a run by its experiment's claims, None where it has none, and what of the run is to be shown."""
    if not hasattr(module, "claims"):
        return None, store
    if "until_decided" not in store.run:
        return run_in(module, "claims", store), store
    state = deciding.course_of(store, module)
    return list(state.entries) or run_in(module, "claims", store), _so_far(store, state)


def _so_far(store: Store, state: Course) -> Store:
    """A run until decided as that of the trials that it has and that its next look needs, with notes on its looks."""
    ended = {row.index for row in store.rows()} | {trial.index for trial in state.missing}
    plan = store.run["until_decided"]
    now = levels_of(state.looks)
    level = f"each at the two-sided level {now['two-sided']:.4f}, {now['of the whole']:g} of all"
    if any(abs(plan["levels"][name] - value) > 1e-9 for name, value in now.items()):
        level += "; the plan has changed: its levels are not those of its looks"
    notes = [
        f"until decided: {deciding.told(state)}; looks at {', '.join(map(str, state.looks))} repeats, {level}",
        *(f"the plan has changed: {line}" for line in changed(plan, state.entries)),
    ]
    part = store.of([trial for trial in store.trials if trial.index in ended])
    return dataclasses.replace(part, run={**part.run, "notes": [*(store.run.get("notes") or ()), *notes]})


def _experiment(name: str, path: str | None) -> Any:
    """The module of the experiment of that name; None where there is no such: its measures are still shown.

    A user's own is loaded where its path is given, never from what a run's folder says. Raises `InputError`.
    """
    if path is not None:
        if experiments.name_of(path) != name:
            raise InputError(f"--experiment {path}: the run is of {name!r}; expected the file of that experiment")
        return experiments.load(path)
    if is_path(name) or not experiments.known(name):  # a user's own, or of another version
        return None
    return experiments.load(name)


def _of_cells(experiment: str, found: Sequence[Cell]) -> list[Entry]:
    """For an experiment without published numbers: each measure of each cell, beside nothing."""
    entries, words = [], naming(cell.conditions for cell in found)
    for cell in found:
        for name in cell.measures:
            at: Mean = mean(cell, name)
            quantity = f"{words(cell.conditions)}: {name}"
            test = "mean over the repeats, 95 % t interval; nothing was published"
            entries.append(
                Entry(
                    source=experiment,
                    quantity=quantity,
                    claim="",
                    published="",
                    measured=at.measured,
                    low=at.low,
                    high=at.high,
                    n=at.n,
                    agrees=None,
                    test=test,
                    margin=math.nan,
                )
            )
    return entries


def _on_terminal(store: Store, module: Any, entries: Sequence[Entry] | None, found: Sequence[Cell]) -> str:
    from rich.console import Console
    from rich.text import Text

    console = Console()
    with console.capture() as capture:
        decided = entries and any(math.isfinite(entry.measured) for entry in entries)
        if entries and decided:
            for arm, some in arms_of(entries):
                console.print(_claims_table(some, f"{store.run['experiment']}{f': {arm}' if arm else ''}"))
                console.print(Text(f"{verdicts(some)}\n"))
            for line in needed(entries, store.folder):
                _print(console, line)
        else:  # nothing published, or none of its cells in this run: what was measured stands alone
            console.print(_cells_table(found, store.run["experiment"], columns(store, module)))
            if entries:
                console.print(Text(f"{verdicts(entries)}\n"))
        console.print(Text(counted(store)))
        for line in misfits(store):
            _print(console, line, "red")
        for note in notes_of(store, module):
            _print(console, note)
        if len(store.rows()) < len(store.trials):
            for line in ("finish it with:", f"  {command('resume', str(store.folder))}"):
                _print(console, line)
        lost = [row.index for row in store.rows() if row.status == "done" and not store.has_series(row.index)]
        if lost:
            console.print(
                Text(f"the series of {len(lost)} trials are missing, the first of trial {lost[0]}", style="red")
            )
        for row in store.rows():
            if row.status != "done":
                console.print(Text(f"trial {row.index} failed: {row.reason}", style="red"))
    return capture.get().rstrip("\n")


def _print(console: Any, line: str, style: str = "") -> None:
    """Prints a line; one that is a command, which begins with two spaces, is never broken."""
    from rich.text import Text

    console.print(Text(line, style=style), soft_wrap=line.startswith("  "))


def needed(entries: Sequence[Entry], folder: Path) -> list[str]:
    """Which supplementary experiments would decide more of the claims of a run, each command on a line of its own."""
    counts = Counter(entry.words for entry in entries if entry.words)
    lines = []
    for words, count in counts.items():
        lines += [f"{count} claim{'s' * (count != 1)} cannot be decided without:", f"  {command(*words)}"]
    return [*lines, "and then:", f"  {command('report', str(folder))}"] if lines else []


def _claims_table(entries: Sequence[Entry], title: str) -> Any:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(title=Text(title), box=box.SIMPLE_HEAD, title_justify="left", pad_edge=False)
    table.add_column("published, and what was measured for it", ratio=1, min_width=32)
    table.add_column("measured", justify="right", min_width=9)
    table.add_column("margin", justify="right")
    table.add_column("n", justify="right")
    table.add_column("verdict", min_width=9)
    for entry in entries:
        words = Text(f"{entry.claim}\n")
        words.append(entry.quantity if math.isfinite(entry.measured) else entry.test, style="dim")
        interval = shown_interval(entry.low, entry.high).replace(", ", ",\n")
        measured = Text(shown_number(entry.measured))
        if interval:
            measured.append(f"\n{interval}", style="dim")
        verdict = Text(VERDICTS[entry.agrees], style=STYLES[entry.agrees])
        count = str(entry.n) if entry.n else "-"
        table.add_row(words, measured, shown_number(entry.margin), count, verdict, end_section=True)
    return table


def _cells_table(found: Sequence[Cell], title: str, columns: Mapping[str, str]) -> Any:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    names = [name for name in columns if any(name in cell.measures for cell in found)]
    table = Table(title=Text(title), box=box.SIMPLE_HEAD, title_justify="left", pad_edge=False)
    table.add_column("means over n repeats", ratio=1, min_width=20)
    table.add_column("n", justify="right")
    for name in names:
        table.add_column(columns[name], justify="right", no_wrap=False)
    words = naming(cell.conditions for cell in found)
    for cell in found:
        means = [shown_number(mean(cell, name).measured) for name in names]
        table.add_row(Text(words(cell.conditions)), str(cell.done), *means)
    return table
