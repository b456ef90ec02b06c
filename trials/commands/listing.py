"""What there is and what a run will do, as text for the terminal."""

from __future__ import annotations

import ast
import importlib.util
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from flocking import found
from trials.commands.constants import constants, modules_of
from trials.design import experiments
from trials.types import Trial

SHOWN_TRIALS = 12
"""First trials of a long list that are shown; the last one follows."""
KINDS = ["experiments", "laws", "pipelines", "selections", "formations", "bodies", "worlds"]


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
        (row.key, _value(row.value), row.unit, "published" if row.published else "chosen", row.source)
        for row in plan.parameters
    ]
    lines = [f"{plan.experiment}: {plan.title}", "", *_table(("parameter", "value", "unit", "", "source"), rows), ""]
    fixed = [
        (constant.name, f"{constant.value:g}", constant.remark) for constant in constants(modules_of(plan.trials[0]))
    ]
    lines += [*_table(("constant, not to be set", "value", "unit and source"), fixed), ""]
    for factor, values in (*plan.conditions.items(), *plan.sweep.items()):
        lines.append(f"varied: {factor} = {', '.join(map(_value, values))}")
    lines += [f"note: {note}" for note in plan.notes]
    some = "" if len(chosen) == len(plan.trials) else f" of {len(plan.trials)}"
    lines += ["", f"{len(chosen)}{some} trials, {plan.repeats} repeats of each cell:"]
    trials = [_trial(trial) for trial in chosen]
    if len(trials) > SHOWN_TRIALS + 2:
        trials = [*trials[:SHOWN_TRIALS], ("…", "", "", "", ""), trials[-1]]
    return "\n".join([*lines, *_table(("trial", "repeat", "seed", "formation", "conditions"), trials)])


def _names(kind: str) -> dict[str, str]:
    """Names of one kind and the first lines of their docstrings."""
    if kind in ("selections", "formations"):
        return _functions(kind)
    packages = {
        "laws": "flocking.laws",
        "pipelines": "sensing.pipelines",
        "bodies": "robots",
        "worlds": "worlds",
    }
    modules = experiments() if kind == "experiments" else found.modules(packages[kind])
    if kind in ("bodies", "worlds"):
        from trials.simulations.robots.keys import valid

        modules = {name: modules[name] for name in valid(packages[kind])}
    named = {name: _first_sentence(module) for name, module in sorted(modules.items())}
    if kind == "worlds":
        from trials.simulations.kinematic.fields import WORLD_PARAMETERS

        named |= {f"kinematic: {name}": _opening(fields.__doc__ or "") for name, fields in WORLD_PARAMETERS.items()}
    return named


def _functions(kind: str) -> dict[str, str]:
    """Names of things that are functions or classes, and the first sentences of their docstrings."""
    if kind == "selections":
        from flocking.obstacle_selection import OBSTACLE_SELECTIONS
        from flocking.selection import SELECTIONS

        documented: dict[str, Any] = {name: about.function for name, about in SELECTIONS.items()}
        documented |= {f"obstacles: {name}": about.function for name, about in OBSTACLE_SELECTIONS.items()}
    else:
        from trials.simulations.kinematic.fields import FORMATION_PARAMETERS
        from worlds.formations import FORMATIONS

        documented = {f"robots: {name}": function for name, function in FORMATIONS.items()}
        documented |= {f"kinematic: {name}": fields for name, fields in FORMATION_PARAMETERS.items()}
    return {name: _opening(thing.__doc__ or "") for name, thing in documented.items()}


def _sentence(paragraph: str) -> str:
    """The first sentence of a paragraph, without its full stop: that of "et al." ends none."""
    return re.split(r"(?<!et al)\. ", paragraph, maxsplit=1)[0].rstrip(".")


def _opening(docstring: str) -> str:
    """Its first sentence, without the last full stop."""
    return _sentence(" ".join(docstring.partition("\n\n")[0].split()))


def _first_sentence(module: str) -> str:
    """Of a module's docstring, read without running the module."""
    spec = importlib.util.find_spec(module)
    if spec is None or spec.origin is None:
        return ""
    text = ast.get_docstring(ast.parse(Path(spec.origin).read_text(encoding="utf-8"))) or ""
    return _opening(text)


def _trial(trial: Trial) -> tuple[str, ...]:
    conditions = ", ".join(f"{key.rsplit('.', 1)[-1]} {_value(value)}" for key, value in trial.conditions.items())
    return str(trial.index), str(trial.repeat), str(trial.seed), trial.formation, conditions


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:g}" if isinstance(value, float) else str(value)


def _table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> list[str]:
    widths = [max(len(row[column]) for row in (head, *rows)) for column in range(len(head))]
    return [
        "  ".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)).rstrip() for row in (head, *rows)
    ]
