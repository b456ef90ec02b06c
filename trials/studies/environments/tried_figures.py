"""The figure of single environments: figure 7.6 of Fine 2015 in one panel a cell."""

from __future__ import annotations

from pathlib import Path

from trials.evidence.runs import Run
from trials.reports import figures as draw
from trials.reports.arms import by_arm, panels
from trials.reports.figures import Figure, Place
from trials.reports.ways import ways
from trials.studies.environments.claims import BEHAVIOURS, NAMES
from trials.studies.environments.design import LAWS
from trials.studies.environments.tried import BEHAVIOURS as TRIED
from trials.studies.environments.tried import KEYS


def figures(run: Run, folder: Path) -> list[Figure]:
    """The ways of the first trial of each behaviour and law, for each arm of the run."""
    return by_arm(run, folder, KEYS, _figures)


def _figures(run: Run, place: Place) -> list[Figure]:
    wanted = [
        (f"{BEHAVIOURS[behaviour]}, {NAMES[law]}", dict(zip(KEYS, (behaviour, law), strict=True)))
        for behaviour in TRIED
        for law in LAWS
    ]
    caption = (
        "Blue: where the herd starts; green: where it ends; the first trial of each, as in figure 7.6 of Fine 2015."
    )
    return [draw.save(ways(panels(run, wanted), 3), place, "ways", "Ways", caption, dots=True)]
