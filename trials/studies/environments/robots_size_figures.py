"""The figures of `corral-group-size-robots`: rates beside the empty world, and figure 1.2 of Fine 2015 redrawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from generation.validation.uplift import rate
from trials.evidence.runs import FinishedTrial, Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import Figure, Place
from trials.reports.ways import ways
from trials.studies.environments.robots_size_claims import COUNTS, ITERATION, KEYS, MEASURE, told

WORLDS = {True: "with the construct", False: "empty world"}
COLOURS = {True: "#0072b2", False: "#999999"}


def figures(run: Run, folder: Path) -> list[Figure]:
    """Both figures, for each arm of the run."""
    return by_arm(run, folder, KEYS, _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    return [_rates(run, place), _ways(run, place)]


def _rates(run: Run, place: Place) -> Figure:
    speeds = _speeds(run)
    canvas, axes = draw.grid(len(speeds), len(speeds), width=4.4 * len(speeds), height=3.2)
    done = [row for row in run.rows() if row.status == "done"]
    for axis, iteration_s in zip(axes, speeds, strict=True):
        axis.set_title(told(iteration_s), loc="left")
        for construct, label in WORLDS.items():
            for k, count in enumerate(COUNTS):
                wanted = dict(zip(KEYS, (count, construct, iteration_s), strict=True))
                own = [row.measures[MEASURE] for row in done if wanted.items() <= row.conditions.items()]
                found = rate(np.array(own) == 1.0)
                reach = [[found.rate - found.low], [found.high - found.rate]]
                at = k - 0.08 if construct else k + 0.08
                shown = label if k == 0 else None
                axis.errorbar([at], [found.rate], reach, fmt="o", color=COLOURS[construct], ms=4, label=shown)
        axis.set_xticks(range(len(COUNTS)), [_creates(count) for count in COUNTS])
        axis.set_xlim(-0.5, len(COUNTS) - 0.5)
        axis.set_ylim(-0.02, 1.02)
    axes[0].legend(frameon=False)
    caption = "Share of the environments in which the herd is corralled, with Wilson's 95 % intervals; the same starts."
    return draw.save(canvas, place, "sizes", "Corralling of one Create and of four", caption)


def _ways(run: Run, place: Place) -> Figure:
    """In the first environment in which four are corralled and one is not, or else in the first."""
    done = {(row.repeat, *map(row.conditions.get, KEYS)): row for row in run.rows() if row.status == "done"}
    speeds = _speeds(run)[::-1]
    shown = next(
        (
            (repeat, speed)
            for speed in speeds
            for repeat in sorted({row.repeat for row in done.values()})
            if [_elicited(done.get((repeat, count, True, speed))) for count in COUNTS] == [0.0, 1.0]
        ),
        (1, speeds[0]),
    )
    numbers = {tuple(map(trial.conditions.get, KEYS)): trial for trial in run.trials if trial.repeat == shown[0]}
    panels = []
    for count in COUNTS:
        for construct, label in WORLDS.items():
            trial = numbers.get((count, construct, shown[1]))
            known = trial is not None and (shown[0], count, construct, shown[1]) in done
            result = run.series(trial.index) if trial is not None and known else None
            panels.append((f"{_creates(count)}, {label}", result))
    caption = (
        f"Blue: where they start; green: where they end; environment {shown[0]}, {told(shown[1])}, as in figure 1.2 of "
        "Fine 2015: the first in which four are corralled and one is not, where there is one."
    )
    return draw.save(ways(panels, 2), place, "ways", "Ways", caption, dots=True)


def _speeds(run: Run) -> list[float]:
    return list(dict.fromkeys(float(trial.conditions[ITERATION]) for trial in run.trials))


def _elicited(row: FinishedTrial | None) -> float:
    return row.measures[MEASURE] if row is not None else float("nan")


def _creates(count: int) -> str:
    return f"{count} Create{'s' * (count > 1)}"
