"""Many environments in one picture, at one scale: a contact sheet."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from typing import Any

import numpy as np

from flocking.types import Floats
from generation.environment import START, Environment
from generation.primitives import Point, segments

MOST = 100
"""Environments that are drawn: the first ones. A choice."""
PITCH = 1.12
"""From tile to tile, as a multiple of the largest environment. A choice."""
TILE_IN, NARROWEST_IN = 1.3, 5.0
"""Of a tile at the least, and of the picture, inches. A choice."""


def write(environments: Sequence[Environment], path: str | os.PathLike[str], title: str) -> None:
    """Writes a PNG with the first `MOST` environments, row by row, numbered from 1.

    Workspaces are grey and constructs black; goals are green, starts blue arrows and other points red crosses. Anchors
    are left out. All have one scale, that of the largest, of which the bar shows a part.
    """
    from matplotlib.collections import LineCollection
    from matplotlib.figure import Figure

    shown = environments[:MOST]
    pieces = [_pieces(environment) for environment in shown]
    boxes = np.array([_box(*each) for each in pieces]).reshape(-1, 4)
    side = float(max((boxes[:, 2:] - boxes[:, :2]).max(initial=0.0), 1e-3)) * PITCH
    columns = min(10, max(1, math.ceil(math.sqrt(len(shown)))))
    rows = max(1, math.ceil(len(shown) / columns))
    tile = max(TILE_IN, NARROWEST_IN / columns)
    figure = Figure(figsize=(tile * columns, tile * rows + 0.4))
    axes = figure.add_axes((0.0, 0.0, 1.0, tile * rows / (tile * rows + 0.4)))
    axes.set_axis_off()
    lines: dict[str, list[Floats]] = {"0.6": [], "black": [], "tab:green": []}
    places: dict[str, list[tuple[float, float]]] = {"tab:blue": [], "tab:red": []}
    headings: list[float] = []
    for number, (environment, each, box) in enumerate(zip(shown, pieces, boxes, strict=True)):
        row, column = divmod(number, columns)
        shift = np.array([(column + 0.5) * side, -(row + 0.5) * side]) - (box[:2] + box[2:]) / 2
        for colour, part in zip(lines, each, strict=True):
            lines[colour].append(part + np.tile(shift, 2))
        for name, mark in environment.markers.items():
            if isinstance(mark, Point) and "anchor-" not in name:
                places["tab:blue" if name == START else "tab:red"].append((mark.x_m + shift[0], mark.y_m + shift[1]))
                headings += [mark.heading_rad] if name == START else []
        axes.text(column * side + 0.03 * side, -row * side - 0.03 * side, str(number + 1), fontsize=5, va="top")
    for colour, found in lines.items():
        joined = np.concatenate([np.empty((0, 4)), *found]).reshape(-1, 2, 2)
        axes.add_collection(LineCollection(list(joined), colors=colour, linewidths=0.7))
    _marks(axes, places, headings)
    bar = 10.0 ** math.floor(math.log10(side / 2))
    low = -(rows + 0.02) * side
    axes.plot([0.05 * side, 0.05 * side + bar], [low, low], "k-", linewidth=1.5)
    axes.text(0.1 * side + bar, low, f"{bar:g} m", fontsize=6, va="center")
    axes.set(xlim=(0.0, columns * side), ylim=(-(rows + 0.05) * side, 0.02 * side), aspect="equal")
    figure.suptitle(title, fontsize=8)
    figure.savefig(path, dpi=150, format="png", pil_kwargs={"compress_level": 3})


def _marks(axes: Any, places: dict[str, list[tuple[float, float]]], headings: list[float]) -> None:
    if places["tab:blue"]:
        x, y = np.array(places["tab:blue"]).T
        arrows = {"angles": "xy", "scale": 12.0, "scale_units": "inches", "width": 0.001, "color": "tab:blue"}
        axes.quiver(x, y, np.cos(headings), np.sin(headings), **arrows)
    if places["tab:red"]:
        axes.plot(*np.array(places["tab:red"]).T, "+", color="tab:red", markersize=4)


def _pieces(environment: Environment) -> tuple[Floats, Floats, Floats]:
    """(K, 4) the straight pieces of the workspace, of the construct, and of goals."""
    workspace, goal = environment.workspace, environment.markers.get("goal")
    built = environment.construct_walls()
    stands = np.concatenate([np.empty((0, 4)), *map(segments, workspace)])
    return stands, built, np.empty((0, 4)) if goal is None or isinstance(goal, Point) else segments(goal)


def _box(*pieces: Floats) -> tuple[float, float, float, float]:
    """The box x0, y0, x1, y1 around all pieces; at the origin where there are none."""
    places = np.concatenate(pieces).reshape(-1, 2)
    if len(places) == 0:
        return 0.0, 0.0, 0.0, 0.0
    (x0, y0), (x1, y1) = places.min(axis=0), places.max(axis=0)
    return float(x0), float(y0), float(x1), float(y1)
