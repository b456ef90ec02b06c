"""The transition of Vicsek et al. 1995 held against a run, and its curve.

The publication draws curves without numbers. That the order falls from near 1 to near 0 is read as: above 0.95 at noise
0.1 and below 0.3 at noise 5 with 400 members, the bounds that this project sets itself; the finite-size trend as: at
noise 4 and above, each larger herd has less order than the next smaller one.
"""

from __future__ import annotations

from functools import partial
from itertools import pairwise
from pathlib import Path

from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of
from trials.evidence.outcomes import Outcome, above, more
from trials.evidence.runs import Cells, Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import Figure, Place
from trials.reports.ways import curve_of, curves

COUNT, NOISE = "herd.count", "herd.law.noise_rad"
KEYS = (COUNT, NOISE)
ORDERED, DISORDERED, MARGIN = 0.95, 0.3, 0.02
"""Choices; a difference in order counts from a margin on."""
MEMBERS, QUIET, LOUD, LARGE_NOISE = 400, 0.1, 5.0, 4.0


def claims(run: Run) -> list[Entry]:
    """Two entries for each arm of the run."""
    return answers(run, KEYS, _questions)


def _questions(cells: Cells) -> list[Question]:
    falls = f"N {MEMBERS}: order above {ORDERED} at noise {QUIET:g} and below {DISORDERED} at noise {LOUD:g}"
    sizes = f"paired differences above {MARGIN:g}, at every noise of at least {LARGE_NOISE:g} and from size to size"
    judges = (all_must_hold(falls, partial(_falls, cells)), all_must_hold(sizes, partial(_sizes, cells)))
    return [
        claim_of(__package__, "vicsek1995", "figure_2", number, "order", judge)
        for number, judge in enumerate(judges, start=1)
    ]


def _falls(cells: Cells) -> list[Outcome]:
    quiet, loud = (cells.array("polarization", MEMBERS, noise) for noise in (QUIET, LOUD))
    return [
        above(f"order at noise {QUIET:g}, N {MEMBERS}", quiet, ORDERED, MARGIN),
        above(f"1 less order at noise {LOUD:g}, N {MEMBERS}", 1.0 - loud, 1.0 - DISORDERED, MARGIN),
    ]


def _sizes(cells: Cells) -> list[Outcome]:
    return [
        more(
            f"order, N {small} less N {large}, noise {noise:g}",
            cells.difference("polarization", (small, noise), (large, noise)),
            MARGIN,
        )
        for noise in cells.levels(NOISE)
        if noise >= LARGE_NOISE
        for small, large in pairwise(cells.levels(COUNT))
    ]


def figures(run: Run, folder: Path) -> list[Figure]:
    """Order against noise, a line for each size; none of a law without that noise."""
    return by_arm(run, folder, KEYS, _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    if not any(NOISE in trial.conditions for trial in run.trials):
        return []
    sizes = sorted({trial.conditions[COUNT] for trial in run.trials if COUNT in trial.conditions})
    lines = [curve_of(run, "polarization", NOISE, f"N {size}", {COUNT: size}) for size in sizes]
    canvas = curves({"order": lines}, "noise (rad)", bounds=(0.0, 1.02))
    caption = "Mean over the repeats with its 95 % interval; density 4. As figure 2a of Vicsek et al. 1995, but that "
    caption += "herds of thousands at little noise have not found together yet."
    return [draw.save(canvas, place, "order", "Order against noise", caption)]
