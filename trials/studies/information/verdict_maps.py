"""Heat maps of verdicts: a row a law, a column a condition, in each cell the verdict's colour and a few numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from trials.reports.figures import STYLE, Canvas

COLOURS = {True: "#9ad3ab", False: "#eaa29c", None: "#d9d9d9"}
ABSENT = "#ffffff"


class Square(NamedTuple):
    """One cell of the map."""

    agrees: bool | None
    text: str


def verdict_map(rows: Mapping[str, Sequence[Square | None]], columns: Sequence[str], key: str) -> Canvas:
    """Green: the claim holds; red: it does not; grey: undecided; white: there is no such cell."""
    import matplotlib as mpl
    from matplotlib.figure import Figure as Blank
    from matplotlib.patches import Rectangle

    with mpl.rc_context(STYLE):
        canvas = Blank(figsize=(2.2 + 0.62 * len(columns), 1.9 + 0.19 * max(1, len(rows))), layout="constrained")
        axis: Any = canvas.add_subplot()
    for line, squares in enumerate(rows.values()):
        for place, square in enumerate(squares):
            colour = ABSENT if square is None else COLOURS[square.agrees]
            axis.add_patch(Rectangle((place - 0.5, line - 0.5), 1.0, 1.0, facecolor=colour, edgecolor="white", lw=1.0))
            if square is not None:
                axis.text(place, line, square.text, ha="center", va="center", fontsize=5.5)
    axis.set_xlim(-0.5, len(columns) - 0.5)
    axis.set_ylim(len(rows) - 0.5, -0.5)
    axis.set_xticks(range(len(columns)), columns, rotation=60, ha="left", fontsize=6.5)
    axis.xaxis.tick_top()
    axis.set_yticks(range(len(rows)), list(rows), fontsize=6.5)
    axis.tick_params(length=0)
    axis.set_xlabel(key, fontsize=7)
    for side in axis.spines.values():
        side.set_visible(False)
    return canvas
