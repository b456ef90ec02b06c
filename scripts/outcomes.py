"""Writes the outcomes of runs of the detection case study into docs/detection.md.

    python -m scripts.outcomes runs/detection-case-study/001 runs/detection-case-study/002 …

One row for each arm of each run, in the order given; the first run is the reference. All numbers are those of
`herd report`.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from flocking.errors import InputError
from trials.batch.store import opened
from trials.reports.report import report
from trials.reports.wording import VERDICTS

PAGE = Path(__file__).parents[1] / "docs" / "detection.md"
BEGIN, END = "<!-- outcomes: begin", "<!-- outcomes: end -->"


def main(folders: Sequence[str]) -> None:
    """Replaces the text between the marks of the page."""
    columns: dict[str, list[dict[str, object]]] = {}
    commands = []
    for folder in folders:
        entries = json.loads(report(Path(folder), as_json=True))
        store = opened(Path(folder))
        commands.append(_command(store.run))
        experiment, repeats = str(store.run["experiment"]), max(trial.repeat for trial in store.trials)
        told = f"{repeats} repeat{'s' * (repeats != 1)}"
        told = f"until decided, at most {told}" if "until_decided" in store.run else told
        store.close()
        for entry in entries:
            columns.setdefault(_name(experiment, entry.get("arm") or {}, told), []).append(entry)
    text = PAGE.read_text(encoding="utf-8")
    start, end = text.index(BEGIN), text.index(END)
    mark = text[start : text.index("-->", start) + 3]
    PAGE.write_text(f"{text[:start]}{mark}\n\n{_tables(columns, commands)}\n{text[end:]}", encoding="utf-8")


def _name(experiment: str, arm: Mapping[str, object], repeats: str) -> str:
    """An arm in words; of another experiment than the case study with that one's name."""
    words = [] if experiment == "detection-case-study" else [experiment.removeprefix("detection-")]
    words += [f"{key.rsplit('.', 1)[-1]} {value}" for key, value in arm.items()]
    return f"{', '.join(words) or 'reference'} ({repeats})"


def _command(run: Mapping[str, object]) -> str:
    return f"`{run['command']}`" if "command" in run else f"`herd run {run['experiment']}`"


def _tables(columns: dict[str, list[dict[str, object]]], commands: list[str]) -> str:
    reference = next(iter(columns))
    lines = ["## Outcomes", "", "Made by `python -m scripts.outcomes` from the runs of"]
    lines += [f"- {command}" for command in dict.fromkeys(commands)]
    lines += ["", "and of the supplements that `herd report` found beside them, if any."]
    lines += ["", f"### {reference[0].upper()}{reference[1:]}", ""]
    lines += ["| # | claim | measured | interval | margin | n | power | verdict |", "|---|---|---|---|---|---|---|---|"]
    for number, entry in enumerate(columns[reference], start=1):
        numbers = (
            f"{_number(entry['measured'])} | {_interval(entry)} | {_number(entry['margin'])} | {entry['n'] or '-'}"
        )
        numbers += f" | {_number(entry.get('power'))}"
        lines.append(f"| {number} | {entry['claim']} | {numbers} | {VERDICTS[entry['agrees']]} |")  # type: ignore[index]
    lines += ["", "What each number is stands in the report (`quantity` and `test`); power: the share of runs of seven"]
    lines += ["repeats that would show the claim if it is true.", ""]
    lines += ["### Every arm", ""]
    lines += ["+ holds, − does not hold, ? undecided; the number is that on which the verdict hangs.", ""]
    lines += ["| arm | " + " | ".join(str(n) for n in range(1, len(columns[reference]) + 1)) + " |"]
    lines += ["|---" * (len(columns[reference]) + 1) + "|"]
    signs = {True: "+", False: "−", None: "?"}
    for name, entries in columns.items():
        cells = [f"{signs[entry['agrees']]} {_number(entry['measured'])}" for entry in entries]  # type: ignore[index]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _number(value: object) -> str:
    return f"{value:.2f}" if isinstance(value, int | float) else "-"


def _interval(entry: dict[str, object]) -> str:
    if entry["low"] is None or entry["high"] is None:
        return "-"
    return f"{_number(entry['low'])} to {_number(entry['high'])}"


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except InputError as error:
        sys.exit(f"scripts.outcomes: {error}")
