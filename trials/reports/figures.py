"""The drawings of a report, each a function from saved results to a Matplotlib figure. No display is needed.

Matplotlib is imported where it is used: it takes long.
"""

from __future__ import annotations

import io
import itertools
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from trials.batch.store import write_whole
from trials.evidence.claims import Entry
from trials.evidence.summary import Cell, mean, naming
from trials.types import Measure, TrialResult

Canvas = Any
"""A matplotlib.figure.Figure."""

ROBOT_COLOURS = ("#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#17becf")
SERIES_COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#999999", "#000000")
"""Okabe and Ito's, which most readers can tell apart."""
LEGEND_LINES = 12
"""Lines of a figure that a legend can tell apart."""
VERDICT_COLOURS = {True: "#0b7a34", False: "#b3261e", None: "#777777"}
STYLE = {
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "svg.fonttype": "none",
}


NO_METADATA = dict.fromkeys(("Date", "Creator", "Format", "Type"))
"""Of an SVG: no time of day, and no addresses of vocabularies."""


class Figure(NamedTuple):
    """A figure on disk."""

    name: str
    title: str
    caption: str
    path: Path
    """An .svg, or a .png where there are very many dots."""


class Place(NamedTuple):
    """Where the figures of one arm of a run go, and what they are called."""

    folder: Path
    """Of the run."""
    suffix: str = ""
    """Behind the names of the files."""
    words: str = ""
    """The arm, in the titles."""


def save(canvas: Canvas, place: Path | Place, name: str, title: str, caption: str, dots: bool = False) -> Figure:
    """Writes a drawing whole, or not at all, into the figures of a run's folder; equal drawings are equal bytes.

    Raises `StorageError` where it cannot be written.
    """
    import matplotlib as mpl

    place = place if isinstance(place, Place) else Place(place)
    name, title = f"{name}{place.suffix}", f"{title}: {place.words}" if place.words else title
    path = place.folder / "figures" / f"{name}.{'png' if dots else 'svg'}"
    drawn = io.BytesIO()
    with mpl.rc_context({**STYLE, "svg.hashsalt": name}):  # ids differ from figure to figure on one page
        kind = path.suffix.removeprefix(".")
        canvas.savefig(drawn, format=kind, dpi=140, metadata=None if dots else NO_METADATA)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, drawn.getvalue())
    return Figure(name, title, caption, path)


def trajectories(panels: Sequence[tuple[str, TrialResult | None]], columns: int = 3) -> Canvas:
    """The ways of all robots, seen from above; a dot where each ends."""
    ways = [result.poses_w[..., :2].reshape(-1, 2) for _, result in panels if result is not None]
    everywhere = np.concatenate([*ways, np.zeros((1, 2))])
    low, high = np.nanmin(everywhere, axis=0) - 0.5, np.nanmax(everywhere, axis=0) + 0.5
    width = 9.6 / columns
    height = float(np.clip(width * (high - low)[1] / (high - low)[0], 0.6, 1.5 * width)) + 0.2
    canvas, axes = grid(len(panels), columns, width=9.6, height=height, share=True)
    for axis, (title, result) in zip(axes, panels, strict=True):
        axis.set_title(title, loc="left")
        axis.set_xlim(low[0], high[0])
        axis.set_ylim(low[1], high[1])
        axis.set_aspect("equal", adjustable="box")
        if result is None:
            absent(axis)
            continue
        walls(axis, result)
        for robot, colour in zip(range(len(result.robot_names)), itertools.cycle(ROBOT_COLOURS), strict=False):
            way = result.poses_w[::5, robot]
            axis.plot(way[:, 0], way[:, 1], color=colour, lw=0.7)
            axis.plot(*result.poses_w[-1, robot, :2], "o", color=colour, ms=3)
    for axis in axes[-columns:]:
        axis.set_xlabel("x (m)")
    return canvas


def formations(rows: Sequence[tuple[str, Sequence[tuple[str, TrialResult | None, float]]]]) -> Canvas:
    """Formations at single moments: rows of (title, panels), each panel (title, trial, share of its
    duration).

    Robots as discs of their true size, with a stroke along their heading, about the herd's centre.
    """
    from matplotlib.collections import EllipseCollection, LineCollection

    columns = max(len(panels) for _, panels in rows)
    canvas, axes = grid(len(rows) * columns, columns, width=9.6, height=1.7)
    for line, (title, panels) in enumerate(rows):
        for column in range(columns):
            axis = axes[line * columns + column]
            axis.set_aspect("equal", adjustable="box")
            axis.set_xticks([])
            axis.set_yticks([])
            if column >= len(panels):
                axis.set_axis_off()
                continue
            caption, result, share = panels[column]
            axis.set_title(caption if line == 0 else "", loc="left")
            if column == 0:
                axis.set_ylabel(title)
            if result is None:
                absent(axis)
                continue
            poses = result.poses_w[round(share * (len(result.times) - 1))]
            centre = poses[:, :2].mean(axis=0)
            noses = poses[:, :2] + result.radii[:, None] * np.stack([np.cos(poses[:, 2]), np.sin(poses[:, 2])], 1)
            colours = [ROBOT_COLOURS[k % len(ROBOT_COLOURS)] for k in range(len(poses))]
            sizes = 2.0 * result.radii
            axis.add_collection(
                EllipseCollection(
                    sizes,
                    sizes,
                    np.zeros(len(poses)),
                    units="xy",
                    offsets=poses[:, :2],
                    transOffset=axis.transData,
                    facecolors=colours,
                    alpha=0.6,
                )
            )
            axis.add_collection(LineCollection(list(np.stack([poses[:, :2], noses], axis=1)), colors="black", lw=0.8))
            reach = max(1.2, 1.1 * float(np.abs(poses[:, :2] - centre).max()) + float(result.radii.max()))
            walls(axis, result)
            axis.set_xlim(centre[0] - reach, centre[0] + reach)
            axis.set_ylim(centre[1] - 0.8 * reach, centre[1] + 0.8 * reach)
            axis.text(0.98, 0.02, f"{2 * reach:.1f} m wide", transform=axis.transAxes, ha="right", fontsize=6)
    return canvas


def forest(entries: Sequence[Entry]) -> Canvas:
    """Every tested outcome of the claims with its interval, in units of its margin; open dots have no say."""
    from matplotlib.figure import Figure as Blank

    lines = [(entry, outcome) for entry in entries for outcome in entry.outcomes]
    canvas = Blank(figsize=(9.6, 0.8 + 0.17 * max(1, len(lines))), layout="constrained")
    axis = canvas.add_subplot()
    axis.axvspan(-1, 1, color="#eeeeee", zorder=0)
    axis.axvline(0, color="#999999", lw=0.6)
    labels, edge = [], 6.0
    for at, (entry, outcome) in enumerate(lines):
        middle, low, high = outcome.in_margins()
        colour = VERDICT_COLOURS[outcome.decision.agrees]
        if np.isfinite([low, high]).all():
            axis.plot(np.clip([low, high], -edge, edge), [at, at], color=colour, lw=1.2)
        if np.isfinite(middle):
            mark = "o" if abs(middle) < edge else "<" if middle < 0 else ">"
            face = colour if outcome.decides else "white"
            axis.plot(np.clip(middle, -edge, edge), at, mark, color=colour, markerfacecolor=face, ms=3.5)
        labels.append(f"{entry.quantity.split(':')[0].removeprefix('claim ')}  {outcome.label}")
        if at and lines[at - 1][0] is not entry:
            axis.axhline(at - 0.5, color="#cccccc", lw=0.4)
    axis.set_yticks(range(len(lines)), labels, fontsize=6)
    axis.set_ylim(len(lines) - 0.5, -0.5)
    axis.set_xlim(-edge - 0.3, edge + 0.3)
    axis.set_xlabel("measured, less its threshold, in units of the margin (clipped)")
    return canvas


def measures_by_cell(cells: Sequence[Cell], measures: Sequence[str], about: Mapping[str, Measure]) -> Canvas:
    """Means with their 95 % intervals over the numeric condition with most values; a line for each of the rest.

    A cell that lacks this condition is drawn as a level, dashed. Where there is no such condition, or there are more
    lines than a legend tells apart, each cell has a row of its own.
    """
    name = naming(cell.conditions for cell in cells)
    axis_key, lines, levels = _lines(cells, name)
    if axis_key is None or len(lines) + len(levels) > LEGEND_LINES:
        return _rows_by_cell(cells, measures, about, name)
    canvas, axes = grid(len(measures), min(4, len(measures)), width=9.6, height=2.0)
    for axis, measure in zip(axes, measures, strict=True):
        axis.set_title(_headed(measure, about), loc="left")
        for rank, (label, points) in enumerate(lines.items()):
            colour = SERIES_COLOURS[rank % len(SERIES_COLOURS)]
            x = np.array([at for at, _ in points])
            means = [mean(cell, measure) for _, cell in points]
            middle = np.array([m.measured for m in means])
            ends = np.array([[m.low, m.high] for m in means])
            nudged = x + 0.01 * rank * (np.ptp(x) or 1.0)
            axis.plot(nudged, middle, "-o", color=colour, ms=2.5, lw=0.8, label=label)
            axis.vlines(nudged, ends[:, 0], ends[:, 1], color=colour, lw=0.8)
        for rank, (label, cell) in enumerate(levels.items(), start=len(lines)):
            colour, at = SERIES_COLOURS[rank % len(SERIES_COLOURS)], mean(cell, measure)
            axis.axhline(at.measured, ls="--", color=colour, lw=0.8, label=label)
            if np.isfinite([at.low, at.high]).all():
                axis.axhspan(at.low, at.high, color=colour, alpha=0.12, lw=0.0)
        if measure == "smoothness" and any((c.measures.get(measure, np.zeros(1)) > 0).any() for c in cells):
            axis.set_yscale("log")
        axis.set_xlabel(axis_key.rsplit(".", 1)[-1])
    if len(lines) + len(levels) > 1:
        handles, labels = axes[0].get_legend_handles_labels()
        canvas.legend(handles, labels, loc="outside upper center", ncols=min(4, len(labels)), frameon=False)
    return canvas


def _rows_by_cell(
    cells: Sequence[Cell],
    measures: Sequence[str],
    about: Mapping[str, Measure],
    name: Callable[[Mapping[str, Any]], str],
) -> Canvas:
    """A row a cell, a column a measure: means with their 95 % intervals."""
    import matplotlib as mpl
    from matplotlib.figure import Figure as Blank

    with mpl.rc_context(STYLE):
        canvas = Blank(figsize=(9.6, 0.7 + 0.16 * max(2, len(cells))), layout="constrained")
        axes = canvas.subplots(1, len(measures), squeeze=False, sharey=True).ravel().tolist()
    rows = np.arange(len(cells))
    for axis, measure in zip(axes, measures, strict=True):
        axis.set_title(_headed(measure, about), loc="left", fontsize=6)
        means = [mean(cell, measure) for cell in cells]
        axis.plot([m.measured for m in means], rows, "o", color=SERIES_COLOURS[0], ms=2.5)
        axis.hlines(rows, [m.low for m in means], [m.high for m in means], color=SERIES_COLOURS[0], lw=1.0)
        axis.grid(axis="y", color="#eeeeee", lw=0.4)
        axis.tick_params(labelsize=6)
    axes[0].set_yticks(rows, [name(cell.conditions) for cell in cells], fontsize=6)
    axes[0].set_ylim(len(cells) - 0.5, -0.5)
    return canvas


def _headed(measure: str, about: Mapping[str, Measure]) -> str:
    unit = about[measure].unit if measure in about else ""
    return f"{measure} ({unit})" if unit else measure


def _lines(
    cells: Sequence[Cell], name: Callable[[Mapping[str, Any]], str]
) -> tuple[str | None, dict[str, list[tuple[float, Cell]]], dict[str, Cell]]:
    """The numeric condition for the x axis, if one has several values; for each combination of the others its points
    along it; and the cells that have no such condition."""
    values: dict[str, set[float]] = {}
    for cell in cells:
        for key, value in cell.conditions.items():
            if isinstance(value, int | float) and not isinstance(value, bool):
                values.setdefault(key, set()).add(float(value))
    several = {key: len(found) for key, found in values.items() if len(found) > 1}
    longest: str | None = max(several, key=lambda k: several[k], default=None)
    lines: dict[str, list[tuple[float, Cell]]] = {}
    levels: dict[str, Cell] = {}
    for cell in cells:
        others = {key: value for key, value in cell.conditions.items() if key != longest}
        if longest is not None and longest in cell.conditions:
            lines.setdefault(name(others), []).append((float(cell.conditions[longest]), cell))
        else:
            levels[name(others)] = cell
    return longest, {label: sorted(points, key=lambda point: point[0]) for label, points in lines.items()}, levels


def grid(count: int, columns: int, width: float, height: float, share: bool = False) -> tuple[Canvas, list[Any]]:
    """A figure with `count` axes in rows of `columns`; width of all and height of a row in inches."""
    import matplotlib as mpl
    from matplotlib.figure import Figure as Blank

    with mpl.rc_context(STYLE):
        rows = -(-count // columns)
        canvas = Blank(figsize=(width, height * rows + 0.4), layout="constrained")
        axes = canvas.subplots(rows, columns, squeeze=False, sharex=share, sharey=share).ravel().tolist()
    for axis in axes[count:]:
        axis.set_axis_off()
    return canvas, axes[:count]


def walls(axis: Any, result: TrialResult) -> None:
    """Draws the walls; the limits of the axes are the caller's."""
    from matplotlib.collections import LineCollection

    lines = LineCollection(list(result.walls_w.reshape(-1, 2, 2)), colors="#555555", lw=0.8)
    axis.add_collection(lines, autolim=False)


def absent(axis: Any) -> None:
    """Says that a panel has no trial."""
    axis.text(0.5, 0.5, "no such trial", transform=axis.transAxes, ha="center", va="center", color="#999999")
