"""The figure of `piloting-ablations`: the share that arrives as one thing at a time differs."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from trials.evidence.runs import Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm
from trials.reports.figures import Figure, Place
from trials.studies.piloting.ablation_claims import KEYS
from trials.studies.piloting.design import MEASURE, WALLS
from trials.studies.piloting.drawn import mean
from trials.studies.piloting.figures import COLOURS, LABELS

TITLES = {
    "piloting.robots_a_wall": "robots a wall (twice as many pilots)",
    "pilots.speed_m_s": "speed of the pilots, m/s",
    "herd.count": "members of the herd",
    "herd.law": "law",
    "herd.pipeline": "detection",
}


def figures(run: Run, folder: Path) -> list[Figure]:
    """One panel for each thing that differs, for each arm of the run."""
    return by_arm(run, folder, KEYS, lambda arm, place: [_panels(arm, place)])


def _panels(run: Run, place: Place) -> Figure:
    done = [row for row in run.rows() if row.status == "done"]
    usual = {key: _most_common([trial.conditions.get(key) for trial in run.trials]) for key in TITLES}
    canvas, axes = draw.grid(len(TITLES), 3, width=9.0, height=5.0)
    for axis, (key, title) in zip(axes, TITLES.items(), strict=False):
        values = [each for each in dict.fromkeys(t.conditions.get(key) for t in run.trials) if each is not None]
        values = sorted(values) if not isinstance(values[0], str) else values
        for side, (guides, colour) in enumerate(COLOURS.items()):
            for x, value in enumerate(values):
                wanted = {**usual, key: value, KEYS[0]: guides}
                if guides == WALLS:
                    del wanted["pilots.speed_m_s"]
                own = np.array([row.measures[MEASURE] for row in done if wanted.items() <= row.conditions.items()])
                mean(axis, x + 0.1 * (2 * side - 1), own, colour)
            axis.plot([], [], "o", color=colour, label=LABELS[guides])
        axis.set_title(title, loc="left")
        axis.set_xticks(range(len(values)), [str(value) for value in values])
        axis.set_ylim(-0.05, 1.1)
    axes[0].legend(frameon=False)
    caption = (
        "Mean share of the robots that arrive, with 95 % intervals; all else as in the others, with six pilots where "
        "nothing else is said."
    )
    return draw.save(canvas, place, "ablations", "One thing at a time", caption)


def _most_common(values: list[object]) -> object:
    return max(set(values), key=values.count)
