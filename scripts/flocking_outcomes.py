"""Writes the outcomes of runs of the flocking experiments into docs/flocking.md.

    python -m scripts.flocking_outcomes runs/lch-table-4-1/001 runs/hamilton-1971/001 …

One table a run, in the order given. Numbers come from `herd report`, never from here.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path

from flocking.errors import InputError
from trials.report import VERDICTS, counted, report, shown_interval, shown_number
from trials.store import opened

PAGE = Path(__file__).parents[1] / "docs" / "flocking.md"
BEGIN, END = "<!-- outcomes: begin", "<!-- outcomes: end -->"
MOST_ROWS = 40
"""Entries of a run that the page shows; the report has them all."""


def main(folders: Sequence[str]) -> None:
    """Replaces what stands between the page's marks."""
    parts = [
        "## Outcomes",
        "",
        "Made by `python -m scripts.flocking_outcomes` from these runs; `herd report` has more.",
    ]
    for folder in folders:
        parts += ["", *_run(Path(folder))]
    text = PAGE.read_text(encoding="utf-8")
    start, end = text.index(BEGIN), text.index(END)
    mark = text[start : text.index("-->", start) + 3]
    body = "\n".join(parts)
    PAGE.write_text(f"{text[:start]}{mark}\n\n{body}\n\n{text[end:]}", encoding="utf-8")


def _run(folder: Path) -> list[str]:
    entries = json.loads(report(folder, as_json=True))
    store = opened(folder)
    command = store.run.get("command", f"herd run {store.run['experiment']}")
    trials = counted(store)
    store.close()
    lines = [f"### {command.removeprefix('herd run ')}", "", f"`{command}`: {trials}.", ""]
    lines += ["| published | quantity | measured | interval | n | verdict |", "|---|---|---|---|---|---|"]
    for entry in entries[:MOST_ROWS]:
        low, high = (float("nan") if entry[key] is None else entry[key] for key in ("low", "high"))
        measured = "-" if entry["measured"] is None else shown_number(entry["measured"])
        published = entry["published"] if entry["published"] is not None else "-"
        cells = (published, entry["quantity"], measured, shown_interval(low, high) or "-", entry["n"] or "-")
        lines.append(f"| {' | '.join(str(cell).replace('|', '/') for cell in cells)} | {VERDICTS[entry['agrees']]} |")
    if len(entries) > MOST_ROWS:
        lines.append(f"\n… and {len(entries) - MOST_ROWS} more in the report.")
    return lines


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except InputError as error:
        sys.exit(f"scripts.flocking_outcomes: {error}")
