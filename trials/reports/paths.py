"""The figure of a run until decided: each claim at each look."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

import numpy as np

from trials.evidence.claims import Entry
from trials.reports.figures import VERDICT_COLOURS, Canvas, grid

COLUMNS = 4
TITLE = 34
"""Characters of a line of a title."""


def paths(entries: Sequence[Entry]) -> Canvas:
    """For each claim that was looked at: the number on which it hangs and its interval over the repeats."""
    some = [entry for entry in entries if entry.looks]
    ticks = sorted({look.n for entry in some for look in entry.looks})
    last = ticks[-1]
    canvas, axes = grid(len(some), min(COLUMNS, len(some)), width=9.6, height=1.9)
    for axis, entry in zip(axes, some, strict=True):
        lines = textwrap.wrap(entry.quantity, TITLE, max_lines=3, placeholder=" …")
        axis.set_title("\n".join(lines), loc="left", fontsize=6)
        repeats = np.array([look.n for look in entry.looks])
        axis.plot(repeats, [look.measured for look in entry.looks], color="#999999", lw=0.8)
        for look in entry.looks:
            colour = VERDICT_COLOURS[look.agrees]
            if np.isfinite([look.low, look.high]).all():
                axis.plot([look.n, look.n], [look.low, look.high], color=colour, lw=1.2)
            axis.plot(look.n, look.measured, "o", color=colour, ms=3)
        axis.tick_params(labelsize=6)
        axis.set_xlabel("repeats", fontsize=6)
        axis.set_xlim(0, 1.05 * last)
        axis.set_xticks(ticks)
    return canvas
