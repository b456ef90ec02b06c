"""Writes the outcomes of runs of a study into its page, docs/STUDY.md.

    python -m scripts.study_outcomes runs/lch-table-4-1/001 runs/lch-robots/001 …
    python -m scripts.study_outcomes docs/boids_predator.md runs/boids-predator/001 …

One table for each run, in the order given; all runs are of one study. A page comes first where it is not docs/STUDY.md.
All numbers are those of `herd report`.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

from flocking.errors import InputError
from trials.batch.store import Store, opened
from trials.design import experiments, load
from trials.evidence.summary import cells, mean, named
from trials.reports.report import judged
from trials.reports.wording import VERDICTS, counted, key_measures, shown_interval, shown_number
from trials.simulations import measures_of

DOCS = Path(__file__).parents[1] / "docs"
BEGIN, END = "<!-- outcomes: begin", "<!-- outcomes: end -->"
MOST_ROWS = 60
"""Entries of a run that the page shows; the report shows all."""


def main(given: Sequence[str]) -> None:
    """Replaces the text between the marks of the page of the runs' study, or of the page that is given first."""
    own = Path(given[0]) if given[:1] and given[0].endswith(".md") else None
    folders = given if own is None else given[1:]
    page = _page(folders) if own is None else own
    parts = [
        "## Outcomes",
        "",
        "Made by `python -m scripts.study_outcomes` from these runs; `herd report` has more.",
    ]
    for folder in folders:
        parts += ["", *_run(Path(folder))]
    text = page.read_text(encoding="utf-8")
    start, end = text.index(BEGIN), text.index(END)
    mark = text[start : text.index("-->", start) + 3]
    body = "\n".join(parts)
    page.write_text(f"{text[:start]}{mark}\n\n{body}\n\n{text[end:]}", encoding="utf-8")


def _page(folders: Sequence[str]) -> Path:
    """The page of the study that all these runs are of."""
    known, studies = experiments(), set()
    for folder in folders:
        store = opened(Path(folder))
        studies.add(known[store.run["experiment"]].split(".")[-2])
        store.close()
    if len(studies) != 1:
        raise InputError(f"runs of {len(studies)} studies: expected runs of one")
    return DOCS / f"{studies.pop()}.md"


def _run(folder: Path) -> list[str]:
    store = opened(folder)
    command = store.run.get("command", f"herd run {store.run['experiment']}")
    experiment = load(store.run["experiment"])
    judgements, shown = judged(store, experiment)
    trials = counted(shown)
    means = _means(store, experiment) if judgements is None else []
    entries = [entry.as_json() for entry in judgements or []]
    store.close()
    lines = [f"### {command.removeprefix('herd run ')}", "", f"`{command}`: {trials}.", ""]
    if means:
        return lines + means
    lines += ["| published | quantity | measured | interval | n | verdict |", "|---|---|---|---|---|---|"]
    for entry in entries[:MOST_ROWS]:
        low, high = (float("nan") if entry[key] is None else entry[key] for key in ("low", "high"))
        measured = "-" if entry["measured"] is None else shown_number(entry["measured"])
        arm = f"{named(entry['arm'])}: " if "arm" in entry else ""
        interval = shown_interval(low, high) or "-"
        row = (entry["claim"], f"{arm}{entry['quantity']}", measured, interval, entry["n"] or "-")
        lines.append(f"| {' | '.join(str(cell).replace('|', '/') for cell in row)} | {VERDICTS[entry['agrees']]} |")
    if len(entries) > MOST_ROWS:
        lines.append(f"\n… and {len(entries) - MOST_ROWS} more in the report.")
    return lines


def _means(store: Store, experiment: ModuleType) -> list[str]:
    """The key measures of each cell of an experiment that nothing published is held against."""
    names = key_measures(store, experiment)
    lines = [f"| means over the repeats | {' | '.join(names)} |", f"|---{'|---' * len(names)}|"]
    for cell in cells(store, measures_of(store.trials)):
        numbers = [mean(cell, name) for name in names]
        told = [f"{shown_number(n.measured)} {shown_interval(n.low, n.high)}".strip() for n in numbers]
        lines.append(f"| {named(cell.conditions)} | {' | '.join(told)} |")
    return lines


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except InputError as error:
        sys.exit(f"scripts.study_outcomes: {error}")
