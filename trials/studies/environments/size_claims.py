"""Corralling by group size held against Fine 2015, section 5.3: only a group of sufficient size is corralled."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np

from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of
from trials.evidence.outcomes import Outcome, more
from trials.evidence.runs import Cells, Run
from trials.evidence.statistics import slopes
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import Figure, Place
from trials.reports.ways import curve_of, curves

KEYS = ("herd.count",)
COUNTS = (1, 2, 4, 7, 10, 25, 50)
MARGIN = 0.05
"""The least change of the rate over a tenfold size that counts; a choice."""


def claims(run: Run) -> list[Entry]:
    """One entry for each arm of the run."""
    return answers(run, KEYS, _questions)


def _questions(cells: Cells) -> list[Question]:
    judge = all_must_hold(
        f"slope of the uplift over the logarithm of the size above {MARGIN:g} a tenfold size", partial(_rises, cells)
    )
    return [claim_of(__package__, "fine2015", "size_claims", 1, "corralling by group size", judge)]


def _rises(cells: Cells) -> list[Outcome]:
    counts = cells.levels(KEYS[0])
    found = []
    for measure, decides in (("uplift", True), ("valid_rate", False)):
        table = np.stack([cells.array(measure, count) for count in counts], axis=1)
        rises = slopes(np.log10(counts), table[np.isfinite(table).all(axis=1)])
        found.append(more(f"slope of {measure} a tenfold size", rises, MARGIN, decides=decides))
    return found


def figures(run: Run, folder: Path) -> list[Figure]:
    """The rate and its control over the number of members, for each arm of the run."""
    return by_arm(run, folder, KEYS, _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    lines = [
        curve_of(run, measure, KEYS[0], label, {})
        for measure, label in (("valid_rate", "with the construct"), ("control_rate", "empty world"))
    ]
    canvas = curves({"share that is corralled": lines}, "members", logarithmic=True, bounds=(-0.02, 1.02))
    caption = "Mean over the repeats with its 95 % interval; the same environments and starts for all."
    return [draw.save(canvas, place, "size", "Corralling by group size", caption)]
