"""Couzin et al. 2005, figure 1, held against a run: accuracy against the share of informed members, by group size.

Accuracy is the cosine between the way of the group's centre over the last half and the preferred direction: 1 = as the
informed want, 0 on average without them. The share is that which whole members make: of ten members, 2 % are none.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from flocking.types import Floats
from trials.evidence.claims import Entry, Question, all_must_hold, answers, claim_of
from trials.evidence.outcomes import Outcome, more
from trials.evidence.runs import Cells, Run, UndecidedError, arms
from trials.evidence.statistics import slopes
from trials.evidence.summary import naming
from trials.reports import figures as draw
from trials.reports.figures import Figure
from trials.reports.ways import Curve, curve_of, curves

COUNT, SHARE, SPEED = "herd.count", "herd.informed_share", "herd.law.speed_m_s"
KEYS = (COUNT, SHARE)
MEASURE = "goal_alignment"
MARGIN = 0.02
"""The least difference of accuracy that counts; a choice."""
FEW = 0.05
"""Share up to which the sizes are compared: with more, all groups find their way."""


def claims(run: Run) -> list[Entry]:
    """Two entries for each arm of the run."""
    return answers(run, KEYS, _questions)


def _questions(cells: Cells) -> list[Question]:
    rises = f"for every size: slope of the accuracy over all shares with somebody informed, above {MARGIN:g}"
    sizes = f"slope of the accuracy over the logarithm of the size above {MARGIN:g}, for the shares up to {FEW:g}"
    judges = (all_must_hold(rises, partial(_rises, cells)), all_must_hold(sizes, partial(_sizes, cells)))
    return [
        claim_of(__package__, "couzin2005", "figure_1", number, "accuracy", judge)
        for number, judge in enumerate(judges, start=1)
    ]


def _informed(count: int, share: float) -> int:
    return round(count * share)


def _rises(cells: Cells) -> list[Outcome]:
    found = []
    for count in cells.levels(COUNT):
        shares = [share for share in cells.levels(SHARE) if _informed(count, share)]
        if len(shares) < 2:
            raise UndecidedError(f"the run has fewer than two shares of informed members for {count} members")
        steps = slopes(np.array(shares), _table(cells, [(count, share) for share in shares]))
        found.append(more(f"N {count}: slope over the share", steps, MARGIN))
        change = cells.difference(MEASURE, (count, shares[-1]), (count, shares[0]))
        found.append(more(f"N {count}: share {shares[-1]:g} less {shares[0]:g}", change, MARGIN, decides=False))
    return found


def _table(cells: Cells, wanted: Sequence[tuple[int, float]]) -> Floats:
    """(n, K) accuracies of the repeats that have one in each of the cells."""
    columns = [cells.values(MEASURE, *cell) for cell in wanted]
    table = np.array([[column[repeat] for column in columns] for repeat in sorted(columns[0])])
    whole: Floats = table[np.isfinite(table).all(axis=1)]
    return whole


def _sizes(cells: Cells) -> list[Outcome]:
    found = []
    for share in cells.levels(SHARE):
        counts = [count for count in cells.levels(COUNT) if _informed(count, share)]
        if not 0.0 < share <= FEW or len(counts) < 2:
            continue
        steps = slopes(np.log10(counts), _table(cells, [(count, share) for count in counts]))
        found.append(more(f"slope a tenfold size, share {share:g}", steps, MARGIN))
    if not found:
        raise UndecidedError(f"the run has no shares up to {FEW:g} with two sizes")
    return found


def figures(run: Run, folder: Path) -> list[Figure]:
    """Accuracy against the true share of informed members, a line for each size."""
    panels, words = {}, naming(trial.conditions for trial in run.trials)
    for arm, trials in arms(run, KEYS):
        others = {key: value for key, value in arm.items() if key != SPEED}
        speed = f"at {arm[SPEED]:g} m/s" if SPEED in arm else ""
        name = ", ".join(filter(None, [f"accuracy {speed}".strip(), words(others) if others else ""]))
        panels[name] = [
            _curve(run, count, arm)
            for count in sorted({int(trial.conditions[COUNT]) for trial in trials if COUNT in trial.conditions})
        ]
    canvas = curves(panels, "share of informed members", bounds=(-1.02, 1.02))
    caption = (
        "Mean over the repeats with its 95 % interval, at the shares that whole members make. As figure 1 of "
        "Couzin et al. 2005; the speed is a choice."
    )
    return [draw.save(canvas, folder, "accuracy", "Accuracy against the share of informed members", caption)]


def _curve(run: Run, count: int, arm: Mapping[str, Any]) -> Curve:
    """Accuracy of groups of one size where somebody is informed: of ten members, 2 and 5 % are nobody."""
    curve = curve_of(run, MEASURE, SHARE, f"N {count}", {COUNT: count, **arm})
    some = {x: values for x, values in zip(curve.x, curve.values, strict=True) if _informed(count, x)}
    return Curve(curve.label, [_informed(count, x) / count for x in some], list(some.values()))
