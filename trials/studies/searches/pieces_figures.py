"""The figures of decompositions: pieces in the colour of their cluster, and what each makes the herd do."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from trials.evidence.runs import Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import SERIES_COLOURS, Figure, Place
from trials.simulations.searches import fields
from trials.studies.searches.pieces_claims import REGIONS
from trials.types import Trial


def figures(run: Run, folder: Path) -> list[Figure]:
    """The first trial of each kind of decomposition, for each arm of the run."""
    return by_arm(run, folder, (REGIONS,), _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    done = {row.index for row in run.rows() if row.status == "done"}
    first: dict[str, tuple[Trial, Any]] = {}
    for trial in run.trials:
        regions = fields.of_pieces(trial).regions
        if trial.index in done and regions not in first:
            first[regions] = trial, run.series(trial.index).tables
    if not first:
        return []
    canvas, axes = draw.grid(2 * len(first), 2, width=9.0, height=3.6)
    for k, (regions, (_, tables)) in enumerate(first.items()):
        _pieces(axes[2 * k], tables, "regions" if regions else "window")
        _effects(axes[2 * k + 1], tables)
    caption = (
        "Left: the construct (grey) and its pieces in the colours of their clusters, the medoid of each thick. Right: "
        "how far each piece alone moves the place where the herd's centre ends, from where it ends without a construct."
    )
    return [draw.save(canvas, place, "pieces", "Primitives of a known construct", caption)]


def _pieces(axis: Any, tables: Any, title: str) -> None:
    axis.set_title(title, loc="left")
    for x0, y0, x1, y1 in tables["construct"]:
        axis.plot([x0, x1], [y0, y1], color="#bbbbbb", lw=4.0, zorder=1)
    owners = tables["piece_of_wall"]
    for number, (x0, y0, x1, y1) in zip(owners, tables["piece_walls"], strict=True):
        thick = number in tables["medoids"]
        axis.plot([x0, x1], [y0, y1], color=_colour(tables, number), lw=2.4 if thick else 0.9, zorder=2)
    axis.set_aspect("equal")
    axis.set_xlabel("x (m)")


def _effects(axis: Any, tables: Any) -> None:
    forward, left = tables["effects"][:, 0], tables["effects"][:, 1]
    for number in range(len(forward)):
        filled = "full" if tables["active"][number] else "none"
        axis.plot(-left[number], forward[number], "o", color=_colour(tables, number), fillstyle=filled, ms=5)
    axis.axhline(0.0, color="#bbbbbb", lw=0.6)
    axis.axvline(0.0, color="#bbbbbb", lw=0.6)
    axis.set_xlabel("to the right (m)")
    axis.set_ylabel("forward (m)")
    axis.set_title("filled: differs from the empty workspace", loc="left")


def _colour(tables: Any, number: int) -> str:
    return SERIES_COLOURS[int(tables["labels"][number]) % len(SERIES_COLOURS)]
