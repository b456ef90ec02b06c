"""The figures of `cattle-stages`: each stage's fitness beside the empty world, and the ways of both classes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from trials.evidence.runs import Run
from trials.evidence.statistics import mean_interval
from trials.reports import figures as draw
from trials.reports.arms import by_arm, panels
from trials.reports.figures import Figure, Place
from trials.reports.ways import ways
from trials.studies.environments.cattle_claims import KEYS, STAGES, WALLS

SERIES = (("stage_", "with the construct", "#0072b2", -0.1), ("control_stage_", "empty world", "#999999", 0.1))


def figures(run: Run, folder: Path) -> list[Figure]:
    """Both figures, for each arm of the run."""
    return by_arm(run, folder, KEYS, _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    kinds = list(dict.fromkeys(str(trial.conditions[KEYS[0]]) for trial in run.trials))
    canvas, axes = draw.grid(len(kinds), len(kinds), width=4.4 * len(kinds), height=3.2)
    done = [row for row in run.rows() if row.status == "done"]
    for axis, kind in zip(axes, kinds, strict=True):
        axis.set_title(WALLS.get(kind, kind), loc="left")
        for prefix, label, colour, shift in SERIES:
            for k in range(len(STAGES)):
                values = [row.measures[f"{prefix}{k + 1}"] for row in done if row.conditions[KEYS[0]] == kind]
                if not np.isfinite(values).any():
                    continue
                mean, low, high = mean_interval(np.array(values))
                shown = label if k == 0 else None
                axis.errorbar([k + shift], [mean], [[mean - low], [high - mean]], fmt="o", color=colour, ms=4,
                              label=shown)  # fmt: skip
        axis.set_xticks(range(len(STAGES)), STAGES)
        axis.set_ylim(-0.02, 1.02)
    axes[0].legend(frameon=False)
    caption = "Mean fitness in each stage with its 95 % interval over the repeats; the same starts in both worlds."
    found = [draw.save(canvas, place, "stages", "The stages of cattle", caption)]
    wanted = [(WALLS[kind], {KEYS[0]: kind}) for kind in WALLS]
    caption = "Blue: where they start; green: where they end; the first environment that sorts, or else that passed."
    return [*found, draw.save(ways(panels(run, wanted), 2), place, "ways", "Ways", caption, dots=True)]
