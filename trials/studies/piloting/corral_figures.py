"""Figure 8.2 of Fine 2015 redrawn: a herd amid a construct, and amid robots that stand along it."""

from __future__ import annotations

from pathlib import Path

from trials.evidence.runs import Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import Figure, Place
from trials.studies.piloting.corral_claims import KEYS, MEASURE
from trials.studies.piloting.drawn import robots_and_ways


def figures(run: Run, folder: Path) -> list[Figure]:
    """One figure, for each arm of the run."""
    return by_arm(run, folder, KEYS, lambda arm, place: [_ways(arm, place)])


def _ways(run: Run, place: Place) -> Figure:
    done = [row for row in run.rows() if row.status == "done"]
    planned = list(dict.fromkeys(tuple(map(trial.conditions.get, KEYS)) for trial in run.trials))
    panels = []
    for cell in planned:
        own = [row for row in done if tuple(map(row.conditions.get, KEYS)) == cell]
        best = sorted(own, key=lambda row: (-row.measures[MEASURE], row.index))
        result = run.series(best[0].index) if best else None
        if result is not None:
            panels.append((f"{cell[0]} ({cell[1]})" if cell[0] == "pilots" else str(cell[0]), result))
    canvas, axes = draw.grid(max(1, len(panels)), max(1, len(panels)), width=2.6 * max(1, len(panels)), height=2.8)
    for axis, (label, result) in zip(axes, panels, strict=False):
        robots_and_ways(axis, result, float(result.times[-1]))
        axis.set_title(label, loc="left")
    caption = (
        "Green: the herd and its ways; red: robots that stand along the construct. Of each the first trial in which "
        "the herd is corralled, where there is one; as in figure 8.2 of Fine 2015."
    )
    return draw.save(canvas, place, "corral", "A construct, and robots in its place", caption, dots=True)
