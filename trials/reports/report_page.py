"""The report's page: one file of HTML with its figures inside; nothing is loaded from anywhere."""

from __future__ import annotations

import base64
import re
import sys
from collections.abc import Mapping, Sequence
from html import escape
from importlib import resources
from pathlib import Path
from string import Template
from typing import Any

from trials.batch.folders import write_whole
from trials.batch.store import Store
from trials.batch.worker import one_line
from trials.evidence.claims import Entry
from trials.evidence.summary import Cell, mean, naming
from trials.experiments import run_in
from trials.reports import figures as draw
from trials.reports.figures import Figure
from trials.reports.paths import paths
from trials.reports.wording import (
    VERDICTS,
    arms_of,
    counted,
    key_measures,
    misfits,
    notes_of,
    shown_interval,
    shown_number,
    verdicts,
)
from trials.simulations import measures_of
from trials.types import Measure

PAGE = "report.html"
CLASSES = {True: "holds", False: "fails", None: "open"}
TOLD = ("command", "only", "seed", "repeats", "started", "commit", "cpu", "system")
"""What of run.json stands at the page's head, beside the versions."""


def write(store: Store, module: Any, entries: Sequence[Entry] | None, found: Sequence[Cell]) -> Path:
    """Writes the figures and the page into the run's folder; returns the page's path."""
    folder, parts = store.folder, []
    for arm, some in arms_of(entries or []):
        parts.append(f"<h2>Published and measured{escape(f': {arm}') if arm else ''}</h2>")
        parts.append(f"<p>{escape(verdicts(some))}.</p>{_claims(some)}")
        name = f"claims-{re.sub('[^a-z0-9]+', '-', arm.lower())}" if arm else "claims"
        caption = (
            "Every tested outcome with its interval, in units of its margin (grey band). Full dots decide, open dots "
            "are shown beside them. Green: shown to hold; red: shown not to hold; grey: neither."
        )
        if any(entry.outcomes for entry in some):
            parts.append(
                _figure(draw.save(draw.forest(some), folder, name, "The claims with their intervals", caption))
            )
        if any(len(entry.looks) > 1 for entry in some):
            name = name.replace("claims", "looks", 1)
            caption = (
                "The number on which each verdict hangs, with its interval, at each look at the growing run; the "
                "intervals hold at all looks together. Green: shown to hold; red: shown not to hold; grey: still open."
            )
            parts.append(_figure(draw.save(paths(some), folder, name, "The claims at each look", caption)))
    for figure in _figures(store, module, found):
        parts.append(f"<h2>{escape(figure.title)}</h2>{_figure(figure)}")
    parts.append(f"<h2>All measures by cell</h2>{_measures(found, measures_of(store.trials))}")
    parts.append(_failures(store))
    text = resources.files("trials.reports").joinpath("report.html").read_text(encoding="utf-8")
    title = f"{store.run['experiment']}: {folder.name}"
    page = Template(text).substitute(title=escape(title), about=_about(store, module), body="\n".join(parts))
    path = folder / PAGE
    write_whole(path, page.encode())
    return path


def _figures(store: Store, module: Any, found: Sequence[Cell]) -> list[Figure]:
    """The experiment's own figures, then the measures by cell, which every experiment has."""
    own: list[Figure] = []
    if hasattr(module, "figures"):
        try:
            own = run_in(module, "figures", store, store.folder)
        except (ValueError, OverflowError) as error:  # numbers that no axis takes: the tables still stand
            print(f"herd: the figures could not be drawn: {one_line(str(error))}", file=sys.stderr)
    names = [name for name in key_measures(store, module) if any(name in cell.measures for cell in found)]
    if names:
        canvas = draw.measures_by_cell(found, names, measures_of(store.trials))
        caption = "Mean over the repeats with its 95 % interval."
        own = [*own, draw.save(canvas, store.folder, "measures", "Measures by cell", caption)]
    return own


def _figure(figure: Figure) -> str:
    """A figure with its caption, its picture inside the page."""
    data = figure.path.read_bytes()
    if figure.path.suffix == ".svg":
        text = data.decode()
        picture = text[text.index("<svg") :]
    else:
        picture = f'<img alt="{escape(figure.title)}" src="data:image/png;base64,{base64.b64encode(data).decode()}">'
    return f"<figure>{picture}<figcaption>{escape(figure.caption)}</figcaption></figure>"


def _claims(entries: Sequence[Entry]) -> str:
    head = "<tr><th>Source</th><th>Published</th><th>Measured</th>"
    head += '<th class="number">[interval]</th><th class="number">margin</th><th class="number">g</th>'
    head += '<th class="number">n</th><th>Verdict</th></tr>'
    rows = []
    for entry in entries:
        rows.append(
            f"<tr><td>{escape(entry.source)}</td><td>{escape(entry.claim)}</td>"
            f"<td>{escape(entry.quantity)}<br><span class='small'>{escape(entry.test)}</span>{_outcomes(entry)}</td>"
            f"<td class='number'>{_measured(entry.measured, entry.low, entry.high)}</td>"
            f"<td class='number'>{shown_number(entry.margin)}</td>"
            f"<td class='number'>{shown_number(entry.effect)}</td><td class='number'>{entry.n or '-'}</td>"
            f"<td class='{CLASSES[entry.agrees]}'>{VERDICTS[entry.agrees]}</td></tr>"
        )
    return f"<div class='wide'><table>{head}{''.join(rows)}</table></div>"


def _outcomes(entry: Entry) -> str:
    if len(entry.outcomes) < 2:
        return ""
    rows = []
    for outcome in entry.outcomes:
        measured, low, high, margin = outcome.shown()
        verdict = outcome.decision.agrees
        rows.append(
            f"<tr{'' if outcome.decides else ' class=aside'}><td>{escape(outcome.label)}</td>"
            f"<td class='number'>{_measured(measured, low, high)}</td><td class='number'>{shown_number(margin)}</td>"
            f"<td class='number'>{outcome.decision.n}</td>"
            f"<td>{VERDICTS[verdict] if outcome.decides else f'({VERDICTS[verdict]}; shown only)'}</td></tr>"
        )
    return f"<details><summary>{len(rows)} outcomes</summary><table>{''.join(rows)}</table></details>"


def _measured(measured: float, low: float, high: float) -> str:
    return f"{shown_number(measured)} <span class='small'>{shown_interval(low, high)}</span>"


def _measures(found: Sequence[Cell], known: Mapping[str, Measure]) -> str:
    """A row a measure, a column a cell: mean and interval."""
    names = dict.fromkeys(name for cell in found for name in cell.measures)
    words = naming(cell.conditions for cell in found)
    head = "".join(f"<th class='number'>{escape(words(cell.conditions))}<br>n {cell.done}</th>" for cell in found)
    rows = []
    for name in names:
        meant = known.get(name)
        told = f"{escape(name)} <span class='small'>{escape(meant.unit)}</span>" if meant else escape(name)
        note = f" title='{escape(meant.text)}'" if meant else ""
        numbers = ""
        for cell in found:
            at = mean(cell, name)
            numbers += f"<td class='number'>{_measured(at.measured, at.low, at.high)}</td>"
        rows.append(f"<tr><td{note}>{told}</td>{numbers}</tr>")
    meaning = "".join(f"<li><b>{escape(name)}</b>: {escape(known[name].text)}</li>" for name in names if name in known)
    return (
        f"<div class='wide'><table><tr><th>measure</th>{head}</tr>{''.join(rows)}</table></div>"
        f"<details><summary>What each measure is</summary><ul class='small'>{meaning}</ul></details>"
    )


def _failures(store: Store) -> str:
    alien = "".join(f"<p class='small'>{escape(line)}</p>" for line in misfits(store))
    failed = [row for row in store.rows() if row.status != "done"]
    if not failed:
        return alien
    words = naming(trial.conditions for trial in store.trials)
    rows = "".join(
        f"<tr><td class='number'>{row.index}</td><td>{escape(words(row.conditions))}, repeat {row.repeat}</td>"
        f"<td>{escape(row.reason)}</td></tr>"
        for row in failed
    )
    return (
        f"{alien}<h2>Failed trials</h2><table><tr><th>trial</th><th>conditions</th><th>reason</th></tr>{rows}</table>"
    )


def _about(store: Store, module: Any) -> str:
    run, told = store.run, [counted(store), *notes_of(store, module)]
    told += [f"{key} {run[key]}" for key in TOLD if run.get(key) not in (None, "")]
    versions = run.get("versions")
    if isinstance(versions, Mapping):
        told.append(", ".join(f"{name} {version}" for name, version in versions.items()))
    return escape("; ".join(told))
