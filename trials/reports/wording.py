"""What the terminal and the page both say of a run: its verdicts, its numbers, how much of it is finished."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from trials.batch.runfile import own_experiment
from trials.batch.store import Store
from trials.evidence.claims import VERDICTS as VERDICTS
from trials.evidence.claims import Entry
from trials.evidence.summary import naming
from trials.invoked import command
from trials.simulations import headings_of, key_measures_of


def shown_number(value: float) -> str:
    """A measured number in three significant digits; a dash where there is none."""
    if not math.isfinite(value):
        return "-"
    if value == 0.0 or 1e-3 <= abs(value) < 1e4:
        decimals = max(0, 2 - math.floor(math.log10(abs(value)))) if value else 2
        return f"{value:.{min(decimals, 4)}f}"
    return f"{value:.2e}"


def shown_interval(low: float, high: float) -> str:
    """An interval in brackets; empty where there is none."""
    return f"[{shown_number(low)}, {shown_number(high)}]" if math.isfinite(low) and math.isfinite(high) else ""


def counted(store: Store) -> str:
    """How many of a run's trials are done, failed and still to run."""
    rows = store.rows()
    failed = [row for row in rows if row.status != "done"]
    missing = len(store.trials) - len(rows)
    parts = [f"{len(rows) - len(failed)} of {len(store.trials)} trials done"]
    parts += [f"{len(failed)} failed"] if failed else []
    parts += [f"{missing} have not run"] if missing else []
    return ", ".join(parts)


MOST_MISFITS = 10
"""Lines of `misfits`."""


def misfits(store: Store) -> list[str]:
    """What is kept in a run's folder and does not belong to the run, in lines: reports leave it out."""
    if not store.misfits:
        return []
    lines = [f"trial {index} is left out: {why}" for index, why in store.misfits.items()]
    if len(lines) > MOST_MISFITS:
        lines[MOST_MISFITS:] = [f"so are {len(lines) - MOST_MISFITS} more"]
    if any(trial.index in store.misfits for trial in store.trials):
        lines += ["run them again with:", f"  {command('resume', str(store.folder))}"]
    return lines


def notes_of(store: Store, experiment: Any) -> list[str]:
    """What a reader of a run's numbers should know, one line each."""
    found = [f"note: {note}" for note in store.run.get("notes") or () if isinstance(note, str)]
    if experiment is None:
        again = command("report", str(store.folder), "--experiment", own_experiment(store.run) or "FILE.py")
        name = store.run["experiment"]
        found += [
            f"note: {name} is not among the experiments here: without its claims and figures; if yours:",
            f"  {again}",
        ]
    return found


def verdicts(entries: Sequence[Entry]) -> str:
    """How many claims hold, do not hold and are undecided."""
    counts = Counter(entry.agrees for entry in entries)
    return f"{counts[True]} hold, {counts[False]} do not hold, {counts[None]} undecided"


def arms_of(entries: Sequence[Entry]) -> list[tuple[str, list[Entry]]]:
    """The entries by arm, each arm with its words (empty where there is but one)."""
    found: dict[str, list[Entry]] = {}
    words = naming(entry.arm for entry in entries)
    for entry in entries:
        found.setdefault(words(entry.arm) if entry.arm else "", []).append(entry)
    return list(found.items())


def key_measures(store: Store, experiment: Any) -> tuple[str, ...]:
    """The measures that a first look at a run needs: those that its experiment names, or those of its simulation."""
    found: tuple[str, ...] = getattr(experiment, "KEY_MEASURES", key_measures_of(store.trials))
    return found


def columns(store: Store, experiment: Any) -> Mapping[str, str]:
    """The measures of a run that fit on a terminal, and their headings."""
    return dict(headings_of(store.trials)) or {
        name: name.replace("_", "\n") for name in key_measures(store, experiment)
    }
