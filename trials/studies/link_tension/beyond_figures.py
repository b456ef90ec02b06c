"""The figures of the link tension index on other laws and group sizes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from trials.evidence.runs import Run, arms
from trials.evidence.summary import naming
from trials.reports import figures as draw
from trials.reports.figures import Figure
from trials.studies.link_tension.curves import Line, over_time, reliabilities
from trials.studies.link_tension.estimates import Finished
from trials.studies.link_tension.pictures import flock
from trials.types import Trial

LAW, COUNT, FACTOR = "herd.law", "herd.count", "formation.factor"
PICTURED = 100
"""Members of the flocks that are drawn."""
SHOWN_HORIZONS = (0.25, 1.0, 4.0)


def figures(run: Run, folder: Path) -> list[Figure]:
    """Precision, recall and calibration by law and size, for each factor of the speeds; of each arm of a sweep."""
    found, made, words = Finished(run), list[Figure](), naming(trial.conditions for trial in run.trials)
    for number, (arm, trials) in enumerate(arms(run, (LAW, COUNT, FACTOR))):
        suffix, told = (f"-{number + 1}", f" {words(arm)}.") if arm else ("", "")
        if not _levels(trials, FACTOR):  # another formation has none
            continue
        for factor in _levels(trials, FACTOR):
            made += _of_factor(found, folder, trials, {**arm, FACTOR: factor}, f"-{factor:g}{suffix}", told)
        laws, sizes = _levels(trials, LAW), _levels(trials, COUNT)
        size, factor = PICTURED if PICTURED in sizes else sizes[0], _levels(trials, FACTOR)[-1]
        rows = [(law, {**arm, FACTOR: factor, LAW: law, COUNT: size}) for law in laws]
        caption = f"{FLOCKS} {size} members, {_speeds(factor)}.{told}"
        made.append(draw.save(flock(run, rows), folder, f"flocks{suffix}", "Flocks", caption, dots=True))
    return made


def _of_factor(
    found: Finished, folder: Path, trials: Sequence[Trial], shared: Mapping[str, Any], suffix: str, told: str
) -> list[Figure]:
    """Of all trials with the same starting speeds."""
    laws, sizes = _levels(trials, LAW), _levels(trials, COUNT)
    middle = sizes[len(sizes) // 2]

    def cell(law: str, size: int) -> dict[str, Any]:
        return {**shared, LAW: law, COUNT: size}

    by_size = {law: [Line(f"{size} members", cell(law, size)) for size in sizes] for law in laws}
    later = {law: [Line(f"{size} members", cell(law, size), start=1) for size in sizes] for law in laws}
    by_reading = {
        law: [
            Line("printed", cell(law, middle)),
            Line("reduced mass over stiffness", cell(law, middle), reading="reduced"),
        ]
        for law in laws
    }
    by_time = {law: [Line(f"t + {h:g}", cell(law, middle), horizon=h) for h in SHOWN_HORIZONS] for law in laws}
    some, speeds = f" {middle} members.", f" At the start {_speeds(float(shared[FACTOR]))}."
    told = f"{speeds}{told}"
    title = f", {_speeds(float(shared[FACTOR]))}"
    drawn = (
        ("size", "Precision and recall by law and group size", over_time(found, by_size), TIME),
        ("later", "The same of the index taken at t = 1", over_time(found, later), TIME),
        ("reading", "Precision and recall by mass over stiffness", over_time(found, by_reading), TIME + some + READING),
        ("calibration-size", "Calibration by law and group size", reliabilities(found, by_size), BINS),
        ("calibration-time", "Calibration over time", reliabilities(found, by_time), BINS + some),
        (
            "calibration-reading",
            "Calibration by mass over stiffness",
            reliabilities(found, by_reading),
            BINS + some + READING,
        ),
    )
    return [
        draw.save(canvas, folder, f"{name}{suffix}", f"{words}{title}", caption + told)
        for name, words, canvas, caption in drawn
    ]


def _levels(trials: Sequence[Trial], key: str) -> list[Any]:
    """The values of a condition in order of the trials, without those of which it is none."""
    return list(dict.fromkeys(trial.conditions[key] for trial in trials if key in trial.conditions))


def _speeds(factor: float) -> str:
    return "speeds below the law's own" if factor == 1.0 else f"speeds below {factor:g} times the law's own"


TIME = (
    "Links that were ever longer than the law's range within so many units of time, against the sign of the index; 95 "
    "% intervals over the seeds. Dotted: share of links that broke, the precision of an index that foretells at random."
)
BINS = (
    "Share of links that were ever longer than the range within one unit of time, or the time told, by bin of the "
    "index in rest lengths at t = 0; 95 % intervals over the seeds. Dashed: the index foretells breaks right of it. "
    "Bins of fewer than 10 links are left out."
)
READING = " Couzin's and OpenSteer's laws have no stiffness and so no second curve."
FLOCKS = (
    "The first seed at t = 0, 1 and 2 units of time, simulated again for the picture. Red: links that the index as "
    "printed foretells to break; blue: links that it foretells to hold."
)
