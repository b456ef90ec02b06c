"""A derivation, drawn step by step as in figure 6.4 of Fine 2015."""

from __future__ import annotations

import math
import os

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from generation.grammar.derivations import Derivation
from generation.grammar.rules import Grammar
from generation.grammar.shapes import Shape

COLUMNS = 5
MOST_PANELS = 40
"""Steps that are drawn; of a longer derivation the first ones and the last. A choice."""


def draw(derivation: Derivation, path: str | os.PathLike[str]) -> None:
    """Writes a PNG with a panel for each step: terminals thick, non-terminals thin and dashed, labels by their names.

    All panels have one scale. The title is the rule that was applied.
    """
    numbers = list(range(len(derivation.steps)))
    if len(numbers) > MOST_PANELS:
        numbers = [*numbers[: MOST_PANELS - 1], numbers[-1]]
    columns = min(COLUMNS, len(numbers))
    rows = math.ceil(len(numbers) / columns)
    figure = Figure(figsize=(2.4 * columns, 2.6 * rows), layout="constrained")
    low, high = _bounds(derivation)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for panel in panels:
        panel.set_axis_off()
    for number, panel in zip(numbers, panels, strict=False):
        step = derivation.steps[number]
        panel.set_title(f"{number}: {step.rule}", fontsize=8)
        panel.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        _draw(panel, derivation.grammar, step.shape)
    figure.supxlabel(f"{derivation.grammar.name}, ended: {derivation.ended}", fontsize=8)
    figure.savefig(path, dpi=150, format="png")


def _draw(panel: Axes, grammar: Grammar, shape: Shape) -> None:
    built = shape.kinds < len(grammar.terminals)
    for (x0, y0, x1, y1), terminal in zip(shape.lines.tolist(), built.tolist(), strict=True):
        if terminal:
            panel.plot([x0, x1], [y0, y1], "k-", linewidth=2.0)
        else:
            panel.plot([x0, x1], [y0, y1], "--", color="tab:red", linewidth=0.8)
    names = (*grammar.markers, *grammar.labels)
    for label, (x, y, heading) in zip(shape.labels.tolist(), shape.places.tolist(), strict=True):
        is_marker = label < len(grammar.markers)
        colour = "tab:blue" if is_marker else "tab:red"
        panel.plot([x], [y], "+" if is_marker else ".", color=colour, markersize=8 if is_marker else 4)
        tip = "" if math.isnan(heading) else f" {math.degrees(heading) % 360.0:.0f}°"
        panel.annotate(names[label] + tip, (x, y), (2, 2), textcoords="offset points", fontsize=5, color=colour)


def _bounds(derivation: Derivation) -> tuple[np.ndarray, np.ndarray]:
    """The lowest and the highest x and y of all steps, with a margin."""
    ends = [np.concatenate([s.shape.lines.reshape(-1, 2), s.shape.places[:, :2]]) for s in derivation.steps]
    places = np.concatenate([*ends, np.zeros((1, 2))]) if not any(map(len, ends)) else np.concatenate(ends)
    low, high = places.min(axis=0), places.max(axis=0)
    margin = 0.05 * max(float((high - low).max()), 1e-3)
    return low - margin, high + margin
