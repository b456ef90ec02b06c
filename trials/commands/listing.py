"""`herd list` and `herd show` as text for the terminal: what there is, and what a run will do."""

from __future__ import annotations

import ast
import importlib.util
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from flocking import found
from flocking.obstacle_selection import OBSTACLE_SELECTIONS
from flocking.selection import SELECTIONS
from generation import found as schemas
from trials import simulations
from trials.commands.constants import constants
from trials.design import experiments
from trials.evidence.summary import naming, shown_value
from trials.types import Trial

SHOWN_TRIALS = 12
"""Number of trials of a long list that are shown from its beginning, before the last one."""
BY_FILES: Mapping[str, Callable[[], dict[str, str]]] = {
    "experiments": experiments,
    "laws": lambda: found.modules("flocking.laws"),
    "pipelines": lambda: found.modules("sensing.pipelines"),
    "filters": lambda: found.modules("generation.filters"),
    "behaviours": lambda: found.modules("generation.behaviours"),
}
"""Kinds that are a file each: their docstrings are read without running the files."""
KINDS = [
    "experiments", "laws", "pipelines", "selections", "formations", "bodies", "worlds", "schemas", "filters",
    "behaviours",
]  # fmt: skip


def listing(what: str | None) -> str:
    """Names with one line each, of one kind or of all."""
    kinds = [what] if what is not None else KINDS
    parts = []
    for kind in kinds:
        names = _names(kind)
        width = max(map(len, names), default=0)
        lines = [f"{name:{width}}  {about}".rstrip() for name, about in names.items()]
        parts.append("\n".join(lines if what is not None else [kind, *(f"  {line}" for line in lines)]))
    return "\n".join(parts)


def planned(plan: Any, chosen: Sequence[Trial]) -> str:
    """A plan: its parameters and the trials that will run."""
    rows = [
        (row.key, shown_value(row.value), row.unit, "published" if row.published else "chosen", row.source)
        for row in plan.parameters
    ]
    lines = [f"{plan.experiment}: {plan.title}", "", *_table(("parameter", "value", "unit", "", "source"), rows), ""]
    fixed = [
        (constant.name, f"{constant.value:g}", constant.remark)
        for constant in constants(simulations.of(plan.trials[0]).constants(plan.trials[0]))
    ]
    lines += [*_table(("constant, not to be set", "value", "unit and source"), fixed), ""]
    for factor, values in (*plan.conditions.items(), *plan.sweep.items()):
        lines.append(f"varied: {factor} = {', '.join(map(shown_value, values))}")
    lines += [f"note: {note}" for note in plan.notes]
    some = "" if len(chosen) == len(plan.trials) else f" of {len(plan.trials)}"
    told = f"{len(chosen)}{some} trial{'s' * (len(plan.trials) != 1)}, {plan.repeats} repeat{'s' * (plan.repeats != 1)}"
    lines += ["", f"{told} of each cell:"]
    words = naming(trial.conditions for trial in plan.trials)
    shown = chosen if len(chosen) <= SHOWN_TRIALS + 2 else [*chosen[:SHOWN_TRIALS], chosen[-1]]
    trials = [
        (str(trial.index), str(trial.repeat), str(trial.seed), trial.formation, words(trial.conditions))
        for trial in shown
    ]
    if len(shown) < len(chosen):
        trials.insert(SHOWN_TRIALS, ("…", "", "", "", ""))
    return "\n".join([*lines, *_table(("trial", "repeat", "seed", "formation", "conditions"), trials)])


def _names(kind: str) -> dict[str, str]:
    """Names of one kind and the first sentences of their docstrings."""
    if kind == "selections":
        documented: dict[str, Any] = {name: about.function for name, about in SELECTIONS.items()}
        documented |= {f"obstacles: {name}": about.function for name, about in OBSTACLE_SELECTIONS.items()}
    elif kind == "schemas":
        return {name: schemas.load(name).about.rstrip(".") for name in schemas.schemas()}
    elif kind in BY_FILES:
        return {name: _first_sentence(module) for name, module in sorted(BY_FILES[kind]().items())}
    else:
        ways = [simulations.named(name) for name in reversed(simulations.names())]
        documented = {name: thing for way in ways for name, thing in way.listed(kind).items()}
    return {name: _opening(thing.__doc__ or "") for name, thing in documented.items()}


def _sentence(paragraph: str) -> str:
    """The first sentence of a paragraph, without its full stop: that of "et al." ends none."""
    return re.split(r"(?<!et al)\. ", paragraph, maxsplit=1)[0].rstrip(".")


def _opening(docstring: str) -> str:
    """The first sentence of a docstring, without its full stop."""
    return _sentence(" ".join(docstring.partition("\n\n")[0].split()))


def _first_sentence(module: str) -> str:
    """The first sentence of a module's docstring, read without running the module."""
    spec = importlib.util.find_spec(module)
    if spec is None or spec.origin is None:
        return ""
    try:
        text = ast.get_docstring(ast.parse(Path(spec.origin).read_text(encoding="utf-8"))) or ""
    except SyntaxError:  # told when the file is loaded
        text = ""
    return _opening(text)


def _table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> list[str]:
    widths = [max(len(row[column]) for row in (head, *rows)) for column in range(len(head))]
    return [
        "  ".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)).rstrip() for row in (head, *rows)
    ]
