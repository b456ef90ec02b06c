"""The result of a sensitivity analysis as text: for each claim a ranked table, the share of the space, the flip."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from trials.design import DEFAULT_SEED
from trials.evidence.claims import VERDICTS, Entry
from trials.invoked import command, spelled
from trials.sensitivity.analysis import Share
from trials.sensitivity.choices import Choice, settings
from trials.sensitivity.explore import LEAST_BASE, MATTERS, Explored, Findings, Flip
from trials.sensitivity.model import Model
from trials.types import Value

SINGLE = (
    "a single repeat cannot tell the effect of a choice from noise, and decides no verdict: all numbers are those of "
    "one seed; expected --repeats 3 or more"
)
"""Said of an analysis with one repeat: the intervals of its indices are over points, not over seeds."""
HEAD = ("choice", "value", "range", "mu*", "first", "total")


class Context(NamedTuple):
    """What was analysed, for its text."""

    model: Model
    entries: Sequence[Entry]
    """At the reference, of each claim of the model."""
    repeats: int | None
    """As asked for; None: the experiment's own."""
    trials_each: int
    """Of a point."""
    budget: int
    """Trials."""
    without: Sequence[str]
    """Choices without a range."""
    refused: Sequence[str]
    """Why points were not run."""
    notes: Sequence[str]


def told(context: Context, explored: Explored) -> str:
    """All of it in lines for a terminal."""
    model = context.model
    lines = [
        f"{model.experiment}: {_several(len(model.varied), 'choice')} varied, {_several(explored.points, 'point')} of "
        f"{_several(context.trials_each, 'trial')} ({_several(model.repeats, 'repeat')}, the same starts and noise at "
        f"every point), seed {model.seed}",
        f"screening of {explored.trajectories} trajectories (mu*); {_second(context, explored)}",
    ]
    if context.without:
        lines.append(f"not varied, as they have no range: {', '.join(context.without)}")
    if context.refused:
        lines.append(f"{len(context.refused)} points do not fit together and were not run: {context.refused[0]}")
    lines += [f"note: {note}" for note in (*([SINGLE] if model.repeats == 1 else []), *context.notes)]
    for claim, entry, findings in zip(model.claims, context.entries, explored.findings, strict=True):
        lines += ["", *_claim(context, explored, claim, entry, findings)]
    lines += ["", f"The same table on any machine: --budget {context.budget}"]
    return "\n".join(lines)


def _several(number: int, what: str) -> str:
    return f"{number} {what}{'s' * (number != 1)}"


def _second(context: Context, explored: Explored) -> str:
    """What became of the variance-based analysis."""
    if not explored.base and not explored.fixed_for_budget:
        return "no variance-based analysis, as nothing varies"
    if not explored.base:
        least = 3 * LEAST_BASE * context.trials_each
        return f"no variance-based analysis: that of a single choice takes {least} trials more"
    lacking = [context.model.varied[k].key for k in explored.fixed_for_budget]
    beside = f"; the budget has no room for {', '.join(lacking)}" if lacking else ""
    return (
        f"variance-based analysis of the {len(explored.active)} choices with mu* of at least {MATTERS:g} of the "
        f"largest (first and total index), base sample {explored.base}{beside}"
    )


def _claim(context: Context, explored: Explored, claim: int, entry: Entry, found: Findings) -> list[str]:
    verdict = VERDICTS[found.reference.agrees]
    lines = [
        f"claim {claim}: {entry.claim}",
        f"at the experiment's own values {found.reference.slack:+.3g} margins ({verdict})",
        "",
        *_table([HEAD, *_ranked(context.model.varied, explored, found)]),
        "",
        f"the estimate holds in {_share(found.holds)} of the space; the verdict is: "
        + ", ".join(
            f"{VERDICTS[agrees]} in {_share(share)}"
            for agrees, share in zip((True, False, None), found.verdicts, strict=True)
        )
        + f" ({found.holds.n} points)",
    ]
    if found.empty:
        lines.append(f"at {found.empty} points the claim has no quantity; they are left out")
    return [*lines, *_flip(context, found.flip)]


def _ranked(varied: Sequence[Choice], explored: Explored, found: Findings) -> list[tuple[str, ...]]:
    """The choices with the largest total index first, then those with the largest mu*."""
    total = dict(zip(explored.active, found.indices.total, strict=True)) if found.indices is not None else {}
    strength = found.effects.mu_star if found.effects is not None else np.zeros(len(varied))
    order = sorted(range(len(varied)), key=lambda k: (-total.get(k, -math.inf), -float(strength[k]), k))
    rows = []
    for k in order:
        choice, cells = varied[k], ["-", "-", "-"]
        if found.effects is not None:
            cells[0] = f"{found.effects.mu_star[k]:.3g} ± {found.effects.mu_star_reach[k]:.2g}"
        if found.indices is not None and k in explored.active:
            j = explored.active.index(k)
            cells[1] = _interval(float(found.indices.first[j]), float(found.indices.first_reach[j]))
            cells[2] = _interval(float(found.indices.total[j]), float(found.indices.total_reach[j]))
        rows.append((choice.key, f"{_shown(choice.value)} {choice.unit}".strip(), _range(choice), *cells))
    return rows


def _flip(context: Context, flip: Flip | None) -> list[str]:
    if flip is None:
        return ["no point that was run changes the sign of the estimate"]
    model = context.model
    given = settings(model.varied, flip.place)
    own = {choice.key: choice.value for choice in model.varied}
    commands = [
        command("run", experiment, *_words(model, model.repeats, {**settled, **given}))
        for experiment, settled in model.supplements
    ]
    commands.append(command("run", model.experiment, *_words(model, context.repeats, given)))
    changes = ", ".join(f"{key} {_shown(own[key])} to {_shown(value)}" for key, value in given.items())
    return [
        f"nearest flip, {flip.distance:.2g} ranges away, {flip.output.slack:+.2g} margins "
        f"({VERDICTS[flip.output.agrees]}): {changes}",
        *(f"  {each}" for each in commands),
    ]


def _words(model: Model, repeats: int | None, given: Mapping[str, Value]) -> list[str]:
    """What makes the trials of a point, as words of `herd run`."""
    words = ["--repeats", str(repeats)] if repeats is not None else []
    words += ["--seed", str(model.seed)] if model.seed != DEFAULT_SEED else []
    return words + [word for key, value in given.items() for word in ("--set", f"{key}={spelled(value)}")]


def _share(share: Share) -> str:
    if not share.n:
        return "-"
    return f"{100.0 * share.measured:.0f} % [{100.0 * share.low:.0f}, {100.0 * share.high:.0f}]"


def _interval(middle: float, reach: float) -> str:
    return f"{middle:.2f} [{middle - reach:.2f}, {middle + reach:.2f}]"


def _range(choice: Choice) -> str:
    if choice.names:
        return ", ".join(_shown(name) for name in choice.names)
    return f"{choice.low:g} to {choice.high:g}"


def _shown(value: Value) -> str:
    return f"{value:g}" if isinstance(value, float) else spelled(value)


def _table(rows: Sequence[tuple[str, ...]]) -> list[str]:
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return ["  ".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
