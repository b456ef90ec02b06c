"""The figures of the link tension experiment: tables 1 and 2, all settings, figures 4 and 5, the index over time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from trials.evidence.claims import published
from trials.evidence.runs import Run, arms
from trials.evidence.statistics import mean_interval
from trials.evidence.summary import naming
from trials.reports import figures as draw
from trials.reports.arms import by_arm, planned
from trials.reports.figures import Canvas, Figure, Place
from trials.simulations.kinematic.lattice_starts import BOTH, NAMES, POSITION, VELOCITY
from trials.simulations.kinematic.links import HORIZONS
from trials.studies.link_tension.claims import ALPHA, KEYS, PERIODS, STRENGTH, TABLES
from trials.studies.link_tension.curves import Line, over_time, reliabilities
from trials.studies.link_tension.estimates import Finished, foretold, ratio
from trials.studies.link_tension.pictures import flock

SETTING = {"herd.law.range_m": ALPHA, "formation.strength": STRENGTH}
SIMULATIONS = published(__package__, "akama2014", "simulations")
COUNTS = ("broken_broken", "broken_predicted_intact", "intact_predicted_broken", "intact_intact")


def figures(run: Run, folder: Path) -> list[Figure]:
    """All of them for each arm, and of a sweep one that compares its arms."""
    compared = []
    if len(arms(run, KEYS)) > 1:
        title = "The choices that the publication leaves"
        compared.append(draw.save(sweep(run, Finished(run)), folder, "sweep", title, SWEEP_CAPTION))
    return [*compared, *by_arm(run, folder, KEYS, _figures)]


def _figures(run: Run, place: Place) -> list[Figure]:
    """Those of one arm; of another law, or of other starts, there are none."""
    found = Finished(run)
    arm = {key: value for key, value in run.trials[0].conditions.items() if key not in KEYS}
    usual = {formation: {**arm, "formation": formation, **SETTING} for formation in NAMES}
    usual = {formation: cell for formation, cell in usual.items() if planned(run, cell)}
    if not usual:
        return []
    panels = {f"{formation}, alpha {ALPHA:g}, strength {STRENGTH:g}": cell for formation, cell in usual.items()}
    ways = (("apart", "printed"), ("ever", "printed"), ("ever", "reduced"))
    judged = {
        title: [Line(f"{kind}, {reading}", cell, kind, reading) for kind, reading in ways]
        for title, cell in panels.items()
    }
    later = {
        title: [Line(f"t + {h:g}", cell, "ever", "printed", h) for h in (HORIZONS[0], 1.0, HORIZONS[-1])]
        for title, cell in panels.items()
    }
    tabled, flocks = tables(found, arm), flock(run, list(usual.items()))
    made = [
        draw.save(tabled, place, "tables", "Tables 1 and 2", TABLES_CAPTION),
        draw.save(flocks, place, "flocks", "Figures 4 and 5", FLOCKS_CAPTION, dots=True),
    ]
    drawn = (
        ("settings", "All settings", settings(found, arm), SETTINGS_CAPTION),
        ("over-time", "Precision and recall over time", over_time(found, judged), TIME_CAPTION),
        ("calibration", "Calibration", reliabilities(found, later), CALIBRATION_CAPTION),
    )
    return [*made, *(draw.save(canvas, place, name, title, caption) for name, title, canvas, caption in drawn)]


TABLES_CAPTION = (
    "Mean counts of links over the seeds with their 95 % intervals, and the published counts of one trial; alpha 1.6, "
    "beta or gamma 3. Published rows are what happened, columns what the index had foretold. The row both-variations "
    "has velocities below 3 beside the shifts below 3: with none, equation 8 is positive only of links shorter than "
    "2 d - r = 0.4 m. A lattice of ten rows of ten has 261 links, the publication's 262."
)
SWEEP_CAPTION = (
    "Mean counts of links (95 % intervals) in each arm; dashed: as published. Nothing was chosen by these counts: k_p "
    "= k_v = 1 and the step of 0.01 s are the law's own."
)
FLOCKS_CAPTION = (
    "The first seed at t = 0, 1 and 2 s, simulated again for the picture; alpha 1.6, beta or gamma 3. Red: links that "
    "the index foretells to break; blue: links that it foretells to hold. As figures 4 and 5 of Akama and Naruse 2014."
)
SETTINGS_CAPTION = (
    "Share of links that held, of those that the index foretold to hold and of those that it foretold to break, from t "
    "= 0 to 1 s and from 1 to 2 s; crosses: as published, in the panels of both readings of table 2. Ratios of sums "
    "over the seeds with 95 % intervals."
)
TIME_CAPTION = (
    "Precision and recall of the index taken at t = 0, by how long after it is looked: apart, links longer than the "
    "range at that moment; ever, at any step until then. Printed: mass over stiffness is 1 s2; reduced: the reduced "
    "mass of two free members over k_p, exact for an undamped pair. Dotted: share of links that broke, the precision "
    "of an index that foretells at random."
)
CALIBRATION_CAPTION = (
    "Share of links that were ever longer than the range within so many seconds, by bin of the index at t = 0 in rest "
    "lengths. An index that foretold rightly would be 0 left of the dashed line and 1 right of it. Bins of fewer than "
    "10 links are left out."
)


def tables(found: Finished, arm: dict[str, Any]) -> Canvas:
    """The contingency tables of both periods for each start, ours beside the published counts."""
    starts = [(VELOCITY, "table_1"), (POSITION, "table_2"), (BOTH, "table_2")]
    canvas, axes = draw.grid(6, 2, width=9.6, height=1.35)
    for axis, (formation, table, period) in zip(axes, [(f, t, p) for f, t in starts for p in PERIODS], strict=True):
        axis.set_axis_off()
        start = PERIODS[period]
        letter = "ab"[start]
        axis.set_title(
            f"{formation}, t = {start} to {start + 1}; published: table {table[-1]} ({letter})", loc="left", fontsize=8
        )
        made = [one.outcomes() for one in found.counts({**arm, "formation": formation, **SETTING}, start, 1.0)]
        told = published(__package__, "akama2014", table)[period]
        texts = [_cell([getattr(one, name) for one in made], told[name]) for name in COUNTS]
        grid = axis.table(
            cellText=[texts[:2], texts[2:]],
            rowLabels=["broken", "intact"],
            colLabels=["foretold broken", "foretold intact"],
            cellLoc="center",
            bbox=[0.1, 0.0, 0.88, 0.95],
        )
        grid.auto_set_font_size(False)
        grid.set_fontsize(7)
    return canvas


def sweep(run: Run, found: Finished) -> Canvas:
    """Each table's four counts of the first period and the foretold breaks of the second, by arm."""
    chosen, words = [arm for arm, _ in arms(run, KEYS)], naming(trial.conditions for trial in run.trials)
    shown = (("broken_broken", 0), ("intact_predicted_broken", 0), ("broken_broken", 1), ("intact_predicted_broken", 1))
    canvas, axes = draw.grid(4 * len(NAMES), 4, width=9.6, height=0.7 + 0.16 * len(chosen))
    spots = [(formation, name, start) for formation in NAMES for name, start in shown]
    for axis, (formation, name, start) in zip(axes, spots, strict=True):
        axis.set_title(f"{formation}\n{name.replace('_', ' ')}, t = {start} to {start + 1}", loc="left", fontsize=6)
        table = next((table for table, told in TABLES.items() if told == formation), "table_2")
        axis.axvline(
            published(__package__, "akama2014", table)[f"t{start}_to_t{start + 1}"][name],
            ls="--",
            lw=0.7,
            color="black",
        )
        for at, arm in enumerate(chosen):
            made = [one.outcomes() for one in found.counts({**arm, "formation": formation, **SETTING}, start, 1.0)]
            mean, low, high = mean_interval(np.array([getattr(one, name) for one in made], dtype=float))
            axis.plot(mean, at, "o", color=draw.SERIES_COLOURS[0], ms=2.5)
            axis.hlines(at, low, high, color=draw.SERIES_COLOURS[0], lw=1.0)
        labels = [words(arm) for arm in chosen] if (name, start) == shown[0] else [""] * len(chosen)
        axis.set_yticks(range(len(chosen)), labels, fontsize=5)
        axis.set_ylim(len(chosen) - 0.5, -0.5)
        axis.tick_params(axis="x", labelsize=6)
    return canvas


def settings(found: Finished, arm: dict[str, Any]) -> Canvas:
    """How right the index is in all 27 cells."""
    canvas, axes = draw.grid(12, 4, width=9.6, height=1.9)
    columns = [(start, intact) for start in PERIODS.values() for intact in (True, False)]
    spots = [(formation, start, intact) for formation in NAMES for start, intact in columns]
    for axis, (formation, start, intact) in zip(axes, spots, strict=True):
        what = "hold" if intact else "break"
        axis.set_title(
            f"{formation}, t = {start} to {start + 1}\nheld of those foretold to {what}", loc="left", fontsize=6
        )
        for rank, alpha in enumerate(SIMULATIONS["alpha"]):
            xs, shares = SIMULATIONS["beta"], []
            for strength in xs:
                cell = {**arm, "formation": formation, "herd.law.range_m": alpha, "formation.strength": strength}
                made = [one.outcomes() for one in found.counts(cell, start, 1.0)]
                part = [one.intact_intact if intact else one.intact_predicted_broken for one in made]
                whole = [sum(one) - foretold(one) if intact else foretold(one) for one in made]
                shares.append(ratio(part, whole))
            colour = draw.SERIES_COLOURS[rank]
            nudged = np.array(xs) + 0.08 * (rank - 1)
            axis.plot(
                nudged, [s.measured for s in shares], "-o", color=colour, ms=2.5, lw=0.8, label=f"alpha {alpha:g}"
            )
            axis.vlines(nudged, [s.low for s in shares], [s.high for s in shares], color=colour, lw=0.8)
        table = "table_1" if formation == VELOCITY else "table_2"
        told = published(__package__, "akama2014", table)[f"t{start}_to_t{start + 1}"]
        held, broke = COUNTS[3:0:-2] if intact else COUNTS[2::-2]
        if told[held] + told[broke]:
            axis.plot(STRENGTH, told[held] / (told[held] + told[broke]), "kx", ms=4)
        axis.set_ylim(-0.05, 1.05)
        axis.set_xticks(SIMULATIONS["beta"], [f"{x:g}" for x in SIMULATIONS["beta"]])
        axis.tick_params(labelsize=6)
    handles, labels = axes[0].get_legend_handles_labels()
    canvas.legend(handles, labels, loc="outside upper center", ncols=3, frameon=False)
    return canvas


def _cell(values: Sequence[int], told: int) -> str:
    mean, low, high = mean_interval(np.array(values, dtype=float))
    interval = f" [{low:.1f}, {high:.1f}]" if np.isfinite(low) else ""
    return f"{mean:.1f}{interval}\npublished {told}" if values else f"-\npublished {told}"
