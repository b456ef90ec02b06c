"""Drawings of parameter-space maps, as Fine 2015 draws them (+ and dots) and as a surface with its uncertainty."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from generation.maps.surfaces import surface
from generation.maps.trees import ParameterMap
from trials.reports.figures import STYLE, Canvas, absent, grid

PLACES = 96
"""Of a surface, along each of its axes."""
MOST_SHOWN = 2
"""Axes of a drawing: of a map with more, the first ones."""


def marks(panels: Sequence[tuple[str, ParameterMap | None]], columns: int = 2) -> Canvas:
    """Maps over their first two parameters: + successful, dots the others (Fine 2015, figures 7.10 to 7.13, 8.1)."""
    canvas, axes = grid(len(panels), min(columns, len(panels)), width=9.6, height=3.2)
    for axis, (title, map_) in zip(axes, panels, strict=True):
        axis.set_title(title, loc="left")
        if map_ is None:
            absent(axis)
            continue
        x, y = _columns(map_)
        success = map_.successful
        other = map_.possible & ~success
        axis.plot(x[other], y[other], ".", color="#666666", ms=2.0, mew=0.0)
        axis.plot(x[success], y[success], "+", color="#0072b2", ms=3.0, mew=0.5)
        _scaled(axis, map_)
    return canvas


def surfaces(panels: Sequence[tuple[str, ParameterMap | None]]) -> Canvas:
    """A row a map of two parameters: the probability of success, and the width of its 95 % interval."""
    import matplotlib as mpl

    canvas, axes = grid(2 * len(panels), 2, width=9.6, height=3.2)
    with mpl.rc_context(STYLE):
        for row, (title, map_) in enumerate(panels):
            left, right = axes[2 * row : 2 * row + 2]
            left.set_title(f"{title}: probability of success", loc="left")
            right.set_title("width of its 95 % interval", loc="left")
            if map_ is None or len(map_.box.axes) != MOST_SHOWN:
                absent(left)
                absent(right)
                continue
            steps = [axis.low + (np.arange(PLACES) + 0.5) / PLACES * (axis.high - axis.low) for axis in map_.box.axes]
            places = np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1).reshape(-1, 2)
            found = surface(map_, places)
            for axis, values, colours in (
                (left, found.probability, "RdBu"),
                (right, found.high - found.low, "Greys"),
            ):
                drawn = axis.pcolormesh(*steps, values.reshape(PLACES, PLACES).T, cmap=colours, vmin=0, vmax=1)
                drawn.set_rasterized(True)
                canvas.colorbar(drawn, ax=axis)
                _scaled(axis, map_)
    return canvas


def flips(tables: Mapping[str, NDArray[Any]], map_: ParameterMap) -> Canvas:
    """The workspace alone, and two environments that hardly differ and whose outcomes do (figure 7.7).

    Ways are shaded by time, from light to dark, one start in all three.
    """
    from matplotlib.collections import LineCollection

    canvas, axes = grid(3, 3, width=9.6, height=2.4, share=True)
    ways, walls = tables["flip_ways"].astype(np.float64), tables["flip_walls"]
    titles = ["workspace alone"]
    for number in tables["flip_numbers"]:
        values = ", ".join(
            f"{axis.name} {value:.4g}" for axis, value in zip(map_.box.axes, map_.points[number], strict=True)
        )
        titles.append(f"{values}\n{map_.judged.successes[number]} of {map_.judged.trials[number]} simulations succeed")
    for axis, title, way, wall in zip(axes, titles, ways, walls, strict=True):
        axis.set_title(title, loc="left")
        axis.set_aspect("equal")
        pieces = np.stack([way[:-1], way[1:]], axis=2).reshape(-1, 2, 2)
        shades = np.repeat(np.linspace(0.85, 0.0, len(way) - 1), way.shape[1])
        lines = LineCollection(list(pieces), colors=[(s, s, s) for s in shades], lw=0.5)
        lines.set_rasterized(True)
        axis.add_collection(lines)
        known = wall[np.isfinite(wall).all(axis=1)]
        axis.add_collection(LineCollection(list(known.reshape(-1, 2, 2)), colors="#d55e00", lw=1.0))
        axis.autoscale_view()
    return canvas


def deviations(panels: Sequence[tuple[str, ParameterMap]]) -> Canvas:
    """Two rows a map: the deviations along x of all configurations on one line (figure 7.14), and how many of each."""
    canvas, axes = grid(2 * len(panels), 1, width=9.6, height=1.6, share=False)
    every = [map_.judged.x_deviation[map_.possible] for _, map_ in panels]
    widest = 1.05 * max(float(values.max(initial=0.1)) for values in every)
    for (title, _), values, line, counts in zip(panels, every, axes[::2], axes[1::2], strict=True):
        line.set_title(title, loc="left")
        line.plot(values, np.ones(len(values)), "|", color="#0072b2", ms=12, mew=0.4, alpha=0.5)
        line.set_yticks([])
        counts.hist(values, bins=40, range=(0.0, widest), color="#0072b2")
        counts.set_ylabel("configurations")
        for axis in (line, counts):
            axis.set_xlim(0.0, widest)
    axes[-1].set_xlabel("standard deviation along x at the end (m)")
    return canvas


def _columns(map_: ParameterMap) -> tuple[Any, Any]:
    points = map_.points
    return points[:, 0], points[:, 1] if points.shape[1] > 1 else np.zeros(len(points))


def _scaled(axis: Any, map_: ParameterMap) -> None:
    names = [f"{each.name} ({each.unit})" if each.unit else each.name for each in map_.box.axes]
    axis.set_xlim(map_.box.axes[0].low, map_.box.axes[0].high)
    axis.set_xlabel(names[0])
    if len(names) > 1:
        axis.set_ylim(map_.box.axes[1].low, map_.box.axes[1].high)
        axis.set_ylabel(names[1])
